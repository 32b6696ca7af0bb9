//! Words that were not understood, as conditions of the query: none is dropped.

use jrdb_types::query::Phrase;
use jrdb_types::{Condition, Span};

/// Words that join two parts of one phrase: "stripes on the shirt".
const JOINTS: [&str; 18] = [
    "'s", "’s", "a", "an", "at", "for", "from", "her", "his", "in", "its", "of", "on", "the",
    "their", "to", "with", "your",
];

/// A condition for the words of a span.
pub(crate) fn phrase(text: &str, span: Span) -> Condition {
    let words = text.get(span.start..span.end).unwrap_or_default().into();
    Condition::Phrase(Phrase { words, span: Some(span) })
}

/// A condition for every run of words that were not used; joints between them belong to the run.
pub(crate) fn phrases(
    text: &str,
    mut unused: Vec<Span>,
    looks: impl Fn(&Span) -> bool,
) -> Vec<Condition> {
    unused.sort();
    let mut runs: Vec<Span> = Vec::new();
    for span in unused {
        match runs.last_mut() {
            Some(last) if is_joined(text.get(last.end..span.start)) => last.end = span.end,
            _ => runs.push(span),
        }
    }
    let condition = |span: Span| match (looks(&span), phrase(text, span)) {
        (true, Condition::Phrase(words)) => Condition::Looks(words),
        (_, phrase) => phrase,
    };
    runs.into_iter().map(condition).collect()
}

/// Whether nothing but joints is between two words; overlapping words are one.
fn is_joined(between: Option<&str>) -> bool {
    let is_joint = |word: &str| JOINTS.contains(&word.to_lowercase().as_str());
    between.is_none_or(|between| between.split_whitespace().all(is_joint))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str, unused: &[&str]) -> Vec<String> {
        let span = |word: &&str| {
            let start = text.find(word).unwrap();
            Span { start, end: start + word.len() }
        };
        let found = phrases(text, unused.iter().map(span).collect(), |_| false);
        let words = |condition| match condition {
            Condition::Phrase(phrase) => phrase.words,
            _ => String::new(),
        };
        found.into_iter().map(words).collect()
    }

    #[test]
    fn neighbours_and_what_joints_join_are_one_phrase() {
        let text = "the happy tall man with stripes on his shirts near a nurse";
        let unused = ["shirts", "happy", "stripes", "nurse"];
        assert_eq!(words(text, &unused), ["happy", "stripes on his shirts", "nurse"]);
    }
}
