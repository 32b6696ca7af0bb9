//! English words that the lexicon does not know, so that none is taken for a misspelling.

use std::collections::BTreeSet;
use std::sync::LazyLock;

/// The words of `english.txt`.
static WORDS: LazyLock<BTreeSet<&'static str>> = LazyLock::new(|| {
    let lines = include_str!("english.txt").lines().filter(|line| !line.starts_with('#'));
    lines.flat_map(str::split_whitespace).collect()
});

/// Endings of the forms of a word, and what stands in their place in the word itself.
const FORMS: [(&str, &str); 15] = [
    ("s", ""),
    ("es", ""),
    ("ed", ""),
    ("ed", "e"),
    ("ing", ""),
    ("ing", "e"),
    ("er", ""),
    ("er", "e"),
    ("est", ""),
    ("ly", ""),
    ("ies", "y"),
    ("ied", "y"),
    ("y", ""),
    ("ness", ""),
    ("ful", ""),
];

/// Whether a word in lower case, or the word that it is a form of, is a common English word.
pub(crate) fn is_english(word: &str) -> bool {
    word.is_ascii() && is_form(word)
}

fn is_form(word: &str) -> bool {
    let stem = |(ending, end): &(&str, &str)| {
        let stem = word.strip_suffix(ending).filter(|stem| stem.len() > 2)?;
        let doubled = stem.as_bytes().windows(2).last().is_some_and(|two| two[0] == two[1]);
        let single = if doubled { &stem[..stem.len() - 1] } else { stem };
        Some(WORDS.contains(format!("{stem}{end}").as_str()) || WORDS.contains(single))
    };
    WORDS.contains(word) || FORMS.iter().filter_map(stem).any(|found| found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_their_forms_are_english_and_misspellings_are_not() {
        for word in ["racket", "horse", "horses", "stopped", "making", "carried", "windy"] {
            assert!(is_english(word), "{word}");
        }
        for word in ["behnd", "lfet", "femlae", "peple", "gril"] {
            assert!(!is_english(word), "{word}");
        }
    }
}
