//! The words that the parser knows: `lexicon.txt`, with fast look-up of words and of the longest phrase.

mod read;
mod role;

use std::sync::LazyLock;

use jrdb_types::query::{Category, Order, Property, RelationKind};
use jrdb_types::vocab::{Elevation, Sector};
use jrdb_types::{Condition, DistanceWord};

pub(crate) use read::{Limit, Measured};
pub(crate) use role::{Role, Roles};

use crate::words::Piece;

/// What a word or phrase means: in one or several of these respects.
#[derive(Debug, Default)]
pub(crate) struct Entry {
    pub(crate) roles: Roles,
    /// What kind of thing it names.
    pub(crate) category: Option<Category>,
    /// What it says of the thing it names or stands with.
    pub(crate) says: Vec<Condition>,
    /// What holds between the subject and the thing behind it.
    pub(crate) relation: Option<RelationKind>,
    /// What holds besides, with the same thing.
    pub(crate) relation_too: Option<RelationKind>,
    /// Label when it is done with people.
    pub(crate) people: Option<String>,
    /// Label when it is done with an object.
    pub(crate) object: Option<String>,
    pub(crate) distance: Option<DistanceWord>,
    pub(crate) sector: Option<Sector>,
    pub(crate) elevation: Option<Elevation>,
    pub(crate) number: Option<f64>,
    pub(crate) limit: Option<Limit>,
    /// Metres of the unit.
    pub(crate) unit: Option<f64>,
    pub(crate) order: Option<(Measured, Order)>,
    pub(crate) asks: Option<Property>,
    pub(crate) lacks: Option<String>,
}

impl Entry {
    /// All that holds between the subject and the thing behind it.
    pub(crate) fn kinds(&self) -> Vec<RelationKind> {
        self.relation.iter().chain(&self.relation_too).cloned().collect()
    }
}

/// A step in the tree of phrases.
#[derive(Debug, Clone, Copy, Default)]
struct Step {
    from: u16,
    word: u16,
    /// 0 where the slot is free: nothing leads to the node of the unknown words.
    to: u16,
}

/// Numbers of the words that are no words of the file; entries of the same numbers stand for them.
pub(crate) mod special {
    /// A word of no phrase.
    pub(crate) const UNKNOWN: u16 = 0;
    /// Digits.
    pub(crate) const NUMBER: u16 = 1;
    /// A comma or semicolon.
    pub(crate) const COMMA: u16 = 2;
    /// A slash or backslash.
    pub(crate) const SLASH: u16 = 3;
    /// A dash between numbers.
    pub(crate) const DASH: u16 = 4;
    /// Behind the last word.
    pub(crate) const END: u16 = 5;
    /// How many they are.
    pub(crate) const COUNT: u16 = 6;
}

/// Slots of the tables of words and of steps; a power of two well over the number of either.
const SLOTS: usize = 8192;

/// Phrases and what they mean.
pub(crate) struct Lexicon {
    entries: Vec<Entry>,
    words: Vec<&'static str>,
    /// The [`key`] of each word.
    keys: Vec<u128>,
    /// Word numbers by their keys, [`special::UNKNOWN`] where free.
    slots: Vec<u16>,
    /// The node of the phrases that begin with a word, by its number.
    first: Vec<u16>,
    /// Steps between nodes by node and word.
    steps: Vec<Step>,
    /// The entry of the phrase that ends at a node, [`special::UNKNOWN`] where none does.
    ends: Vec<u16>,
}

/// The lexicon of the crate.
pub(crate) static LEXICON: LazyLock<Lexicon> =
    LazyLock::new(|| read::read(include_str!("lexicon.txt")).expect("the tests read this file"));

/// Letters of the longest word that can be known.
const LETTERS_MAX: usize = 16;

/// The letters of the word of so many bytes that a text begins with, without regard to case, as one number; none for an
/// empty word and for one that is too long to be known.
#[inline]
fn key(text: &[u8], length: usize) -> Option<u128> {
    let unused = LETTERS_MAX.checked_sub(length)?;
    let mut letters = text.first_chunk().copied().unwrap_or_else(|| {
        let mut letters = [0; LETTERS_MAX];
        letters[..text.len()].copy_from_slice(text);
        letters
    });
    letters.make_ascii_lowercase();
    // What stands behind the word is shifted out.
    u128::from_le_bytes(letters).checked_shl(unused as u32 * u8::BITS)
}

/// 2^64 over the golden ratio: the top bits of a product with it depend on all bits of the other factor.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// The slot of a key: the first that will do, from its hash on.
fn slot_of(key: u64, will_do: impl Fn(usize) -> bool) -> usize {
    let hash = key.wrapping_mul(GOLDEN) >> (u64::BITS - SLOTS.ilog2());
    let mut slot = hash as usize;
    while !will_do(slot) {
        slot = (slot + 1) % SLOTS;
    }
    slot
}

impl Lexicon {
    fn new() -> Self {
        let count = special::COUNT as usize;
        let mut entries: Vec<Entry> = (0..count).map(|_| Entry::default()).collect();
        let kinds = [Role::Unknown, Role::Number, Role::Comma, Role::Slash, Role::Dash];
        for (entry, kind) in entries.iter_mut().zip(kinds) {
            entry.roles.insert(kind);
        }
        let (words, keys) = (vec![""; count], vec![0; count]);
        let (slots, steps) = (vec![special::UNKNOWN; SLOTS], vec![Step::default(); SLOTS]);
        let first: Vec<u16> = (0..special::COUNT).collect();
        Self { entries, words, keys, slots, ends: first.clone(), first, steps }
    }

    pub(crate) fn entry(&'static self, number: u16) -> &'static Entry {
        &self.entries[usize::from(number)]
    }

    /// The number of a word, [`special::UNKNOWN`] when it is in no phrase.
    pub(crate) fn word(&self, word: &str) -> u16 {
        self.first_word(word.as_bytes(), word.len())
    }

    /// The number of the word of so many bytes that a text begins with, [`special::UNKNOWN`] when it is in no phrase.
    #[inline]
    pub(crate) fn first_word(&self, text: &[u8], length: usize) -> u16 {
        key(text, length).map_or(special::UNKNOWN, |key| self.slots[self.slot(key)])
    }

    /// The slot of a word, or the free one where it would be.
    fn slot(&self, key: u128) -> usize {
        slot_of(key as u64 ^ (key >> u64::BITS) as u64, |slot| {
            let number = self.slots[slot];
            number == special::UNKNOWN || self.keys[usize::from(number)] == key
        })
    }

    /// The slot of a step, or the free one where it would be.
    fn step(&self, from: u16, word: u16) -> usize {
        slot_of(u64::from(from) << u16::BITS | u64::from(word), |slot| {
            let step = self.steps[slot];
            step.to == 0 || (step.from, step.word) == (from, word)
        })
    }

    /// Whether two words mean the same thing: "woman" and "women".
    pub(crate) fn is_same(&self, first: &str, second: &str) -> bool {
        let entry = |word: &str| {
            let node = self.first[usize::from(self.word(word))];
            &self.entries[usize::from(self.ends[usize::from(node)])]
        };
        let (first, second) = (entry(first), entry(second));
        let both = [first, second]
            .map(|e| (e.roles.of_meaning(), &e.category, &e.says, &e.object, &e.people));
        both[0] == both[1] && first.category.is_some()
    }

    /// Every word of every phrase, for suggestions.
    pub(crate) fn words(&self) -> &[&'static str] {
        &self.words[usize::from(special::COUNT)..]
    }

    /// The longest phrase that the pieces begin with: its entry, and how many pieces it has.
    #[inline]
    pub(crate) fn longest(&self, pieces: &[Piece]) -> (u16, usize) {
        let mut node = self.first[usize::from(pieces[0].word)];
        let mut found = (self.ends[usize::from(node)], 1);
        for (at, piece) in pieces.iter().enumerate().skip(1) {
            node = self.steps[self.step(node, piece.word)].to;
            if node == 0 {
                break;
            }
            let entry = self.ends[usize::from(node)];
            if entry != special::UNKNOWN {
                found = (entry, at + 1);
            }
        }
        found
    }

    /// The number of a word, made where there is none; none when it is too long.
    fn intern(&mut self, word: &'static str) -> Option<u16> {
        let key = key(word.as_bytes(), word.len())?;
        let slot = self.slot(key);
        if self.slots[slot] == special::UNKNOWN {
            let number = u16::try_from(self.words.len()).expect("the file has fewer words");
            self.slots[slot] = number;
            self.words.push(word);
            self.keys.push(key);
            let node = self.node();
            self.first.push(node);
        }
        Some(self.slots[slot])
    }

    /// A new node, where no phrase ends yet.
    fn node(&mut self) -> u16 {
        self.ends.push(special::UNKNOWN);
        u16::try_from(self.ends.len() - 1).expect("the file has fewer phrases")
    }

    /// The entry of a phrase, made where there is none.
    fn phrase(&mut self, words: &[u16]) -> &mut Entry {
        let mut node = self.first[usize::from(words[0])];
        for word in &words[1..] {
            let slot = self.step(node, *word);
            if self.steps[slot].to == 0 {
                self.steps[slot] = Step { from: node, word: *word, to: self.node() };
            }
            node = self.steps[slot].to;
        }
        let end = &mut self.ends[usize::from(node)];
        if *end == special::UNKNOWN {
            *end = u16::try_from(self.entries.len()).expect("the file has fewer phrases");
            self.entries.push(Entry::default());
        }
        &mut self.entries[usize::from(*end)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(phrase: &str) -> &'static Entry {
        let pieces = crate::words::pieces(phrase, &mut Vec::new());
        let (entry, length) = LEXICON.longest(&pieces);
        assert_eq!(length, pieces.len(), "{phrase}");
        LEXICON.entry(entry)
    }

    #[test]
    fn a_phrase_may_mean_several_things() {
        assert_eq!(entry("girl").says.len(), 2);
        assert!(entry("her").roles.has(Role::His) && entry("her").roles.has(Role::Him));
    }

    #[test]
    fn the_longest_phrase_wins_whatever_its_case_and_joints() {
        assert!(entry("In  Front-of").roles.has(Role::Of));
        assert_eq!(
            entry("Bicycle/Scooter").category,
            Some(Category::Class("bicycle/scooter".into()))
        );
        assert_eq!(entry("picture_frame").category, Some(Category::Class("picture_frames".into())));
    }

    #[test]
    fn a_word_is_told_from_what_stands_behind_it() {
        let man = LEXICON.word("man");
        assert_ne!(man, special::UNKNOWN);
        for text in ["MAN", "man, who", "Man at the door with a bag"] {
            assert_eq!(LEXICON.first_word(text.as_bytes(), 3), man, "{text}");
        }
        assert_ne!(LEXICON.word("CounterClockwise"), special::UNKNOWN);
        for word in ["", "manners", "counterclockwises"] {
            assert_eq!(LEXICON.word(word), special::UNKNOWN, "{word}");
        }
    }
}
