//! The words that the parser knows, read from `lexicon.txt`.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use jrdb_types::query::Category;
use jrdb_types::vocab::{Elevation, Sector};
use jrdb_types::{Action, Age, Condition, DistanceWord, Gender, Race, Task};

/// What one phrase means, in one respect.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Sense {
    Task(Task),
    Noun(Category),
    /// Something said of a thing before or instead of its noun.
    Attribute(Condition),
    Action(Action),
    Distance(DistanceWord),
    Sector(Sector),
    Elevation(Elevation),
    /// A label of something done together.
    Interaction(String),
    Word(Word),
}

/// Words of the grammar.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Word {
    Who,
    Is,
    Has,
    Located,
    Of,
    Prep,
    With,
    The,
    Relative,
    Distance,
    Robot,
    His,
    And,
    Filler,
}

/// Phrases, lower-case words with one blank between them, and their senses.
pub(crate) struct Lexicon {
    phrases: BTreeMap<String, Vec<Sense>>,
    /// Words in the longest phrase.
    pub(crate) longest: usize,
}

/// The lexicon of the crate.
pub(crate) static LEXICON: LazyLock<Lexicon> =
    LazyLock::new(|| Lexicon::read(include_str!("lexicon.txt")));

impl Lexicon {
    /// Reads the crate's own file; its lines are checked by a test.
    fn read(text: &'static str) -> Self {
        let mut phrases: BTreeMap<String, Vec<Sense>> = BTreeMap::new();
        let mut longest = 0;
        let lines = text.lines().map(str::trim).filter(|l| !l.is_empty() && !l.starts_with('#'));
        for (meanings, words) in lines.filter_map(|line| line.split_once(": ")) {
            let senses: Vec<Sense> = read_senses(meanings);
            for phrase in words.split(',') {
                let words: Vec<&str> = phrase.split_whitespace().collect();
                longest = longest.max(words.len());
                phrases.entry(words.join(" ")).or_default().extend(senses.clone());
            }
        }
        Self { phrases, longest }
    }

    /// The senses of a phrase; empty when it is unknown.
    pub(crate) fn senses(&'static self, phrase: &str) -> &'static [Sense] {
        self.phrases.get(phrase).map_or(&[], Vec::as_slice)
    }

    /// Every single word, for suggestions.
    pub(crate) fn words(&'static self) -> impl Iterator<Item = &'static str> {
        self.phrases.keys().map(String::as_str).filter(|phrase| !phrase.contains(' '))
    }
}

/// `kind=value` pairs; a value may hold blanks, a kind may not.
fn read_senses(meanings: &'static str) -> Vec<Sense> {
    let mut senses = Vec::new();
    let mut rest = meanings;
    while let Some((kind, tail)) = rest.split_once('=') {
        let next = tail.find('=').and_then(|at| tail[..at].rfind(' '));
        let (value, after) = next.map_or((tail, ""), |at| (&tail[..at], &tail[at + 1..]));
        senses.extend(read_sense(kind, value));
        rest = after;
    }
    senses
}

fn read_sense(kind: &str, value: &str) -> Option<Sense> {
    match kind {
        "task" if value == "count" => Some(Sense::Task(Task::Count)),
        "task" => Some(Sense::Task(Task::Find)),
        "noun" if value == "object" => Some(Sense::Noun(Category::Object)),
        "noun" if value == "person" => Some(Sense::Noun(Category::Person)),
        "noun" => Some(Sense::Noun(Category::Class(value.into()))),
        "age" => Some(Sense::Attribute(Condition::Age(Age::from_word(value)?))),
        "gender" => Some(Sense::Attribute(Condition::Gender(Gender::from_word(value)?))),
        "race" => Some(Sense::Attribute(Condition::Race(Race::from_word(value)?))),
        "action" => Some(Sense::Action(Action::from_word(value)?)),
        "distance" => Some(Sense::Distance(DistanceWord::from_word(value)?)),
        "sector" => Some(Sense::Sector(Sector::from_word(value)?)),
        "elevation" => Some(Sense::Elevation(Elevation::from_word(value)?)),
        "interaction" => Some(Sense::Interaction(value.into())),
        "word" => read_word(value).map(Sense::Word),
        _ => None,
    }
}

fn read_word(value: &str) -> Option<Word> {
    Some(match value {
        "who" => Word::Who,
        "is" => Word::Is,
        "has" => Word::Has,
        "located" => Word::Located,
        "of" => Word::Of,
        "prep" => Word::Prep,
        "with" => Word::With,
        "the" => Word::The,
        "relative" => Word::Relative,
        "distance" => Word::Distance,
        "robot" => Word::Robot,
        "his" => Word::His,
        "and" => Word::And,
        "filler" => Word::Filler,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_of_the_file_is_read_whole() {
        let text = include_str!("lexicon.txt");
        for line in text.lines().filter(|l| !l.trim().is_empty() && !l.starts_with('#')) {
            let (meanings, phrases) = line.split_once(": ").unwrap_or_else(|| panic!("{line}"));
            assert_eq!(read_senses(meanings).len(), meanings.matches('=').count(), "{line}");
            for phrase in phrases.split(',') {
                assert!(!LEXICON.senses(phrase.trim()).is_empty(), "{phrase} of {line}");
                assert_eq!(phrase, phrase.to_lowercase());
            }
        }
    }

    #[test]
    fn a_phrase_may_mean_several_things() {
        let girl = LEXICON.senses("girl");
        assert_eq!(girl.len(), 3);
        assert!(girl.contains(&Sense::Attribute(Condition::Gender(Gender::Female))));
    }
}
