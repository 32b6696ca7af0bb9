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

/// A node of the tree of phrases.
#[derive(Debug, Default)]
struct Node {
    entry: Option<u16>,
    /// Next words and the nodes they lead to, sorted.
    next: Vec<(u16, u16)>,
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

/// Slots of the word table; a power of two well over the number of words.
const SLOTS: usize = 8192;

/// Phrases and what they mean.
pub(crate) struct Lexicon {
    entries: Vec<Entry>,
    words: Vec<&'static str>,
    /// Word numbers by hash, [`special::UNKNOWN`] where free.
    slots: Vec<u16>,
    /// The node of the phrases that begin with a word, by its number.
    first: Vec<u16>,
    nodes: Vec<Node>,
}

/// The lexicon of the crate.
pub(crate) static LEXICON: LazyLock<Lexicon> =
    LazyLock::new(|| read::read(include_str!("lexicon.txt")).expect("the tests read this file"));

/// Mixes the letters of a word without regard to case (FNV-1a over the letters with bit 5 set).
fn hash(word: &[u8]) -> usize {
    let mut hash = 0x811c_9dc5_u32;
    for byte in word {
        hash = (hash ^ u32::from(byte | 0x20)).wrapping_mul(0x0100_0193);
    }
    (hash ^ hash >> 15) as usize & (SLOTS - 1)
}

impl Lexicon {
    fn new() -> Self {
        let count = special::COUNT as usize;
        let mut entries: Vec<Entry> = (0..count).map(|_| Entry::default()).collect();
        let kinds = [Role::Unknown, Role::Number, Role::Comma, Role::Slash, Role::Dash];
        for (entry, kind) in entries.iter_mut().zip(kinds) {
            entry.roles.insert(kind);
        }
        let nodes = (0..count).map(|_| Node::default()).collect();
        let (words, first) = (vec![""; count], (0..special::COUNT).collect());
        Self { entries, words, slots: vec![special::UNKNOWN; SLOTS], first, nodes }
    }

    pub(crate) fn entry(&'static self, number: u16) -> &'static Entry {
        &self.entries[usize::from(number)]
    }

    /// The number of a word, [`special::UNKNOWN`] when it is in no phrase.
    pub(crate) fn word(&self, word: &str) -> u16 {
        let mut slot = hash(word.as_bytes());
        loop {
            let number = self.slots[slot];
            let known = self.words[usize::from(number)];
            if number == special::UNKNOWN || known.eq_ignore_ascii_case(word) {
                return number;
            }
            slot = (slot + 1) & (SLOTS - 1);
        }
    }

    /// Whether two words mean the same thing: "woman" and "women".
    pub(crate) fn is_same(&self, first: &str, second: &str) -> bool {
        let entry = |word: &str| {
            let node = &self.nodes[usize::from(self.first[usize::from(self.word(word))])];
            node.entry.map(|entry| &self.entries[usize::from(entry)])
        };
        let (Some(first), Some(second)) = (entry(first), entry(second)) else { return false };
        let both = [first, second].map(|e| (e.roles, &e.category, &e.says, &e.object, &e.people));
        both[0] == both[1] && first.category.is_some()
    }

    /// Every word of every phrase, for suggestions.
    pub(crate) fn words(&self) -> &[&'static str] {
        &self.words[usize::from(special::COUNT)..]
    }

    /// The longest phrase that the pieces begin with: its entry, and how many pieces it has.
    pub(crate) fn longest(&self, pieces: &[Piece]) -> (u16, usize) {
        let mut node = &self.nodes[usize::from(self.first[usize::from(pieces[0].word)])];
        let mut found = (node.entry.unwrap_or(special::UNKNOWN), 1);
        if pieces[0].word < special::COUNT {
            found.0 = pieces[0].word;
        }
        for (at, piece) in pieces.iter().enumerate().skip(1) {
            let Ok(next) = node.next.binary_search_by_key(&piece.word, |(word, _)| *word) else {
                break;
            };
            node = &self.nodes[usize::from(node.next[next].1)];
            if let Some(entry) = node.entry {
                found = (entry, at + 1);
            }
        }
        found
    }

    fn intern(&mut self, word: &'static str) -> u16 {
        let known = self.word(word);
        if known != special::UNKNOWN {
            return known;
        }
        let number = u16::try_from(self.words.len()).expect("the file has fewer words");
        let mut slot = hash(word.as_bytes());
        while self.slots[slot] != special::UNKNOWN {
            slot = (slot + 1) & (SLOTS - 1);
        }
        self.slots[slot] = number;
        self.words.push(word);
        self.first.push(self.node());
        self.nodes.push(Node::default());
        number
    }

    fn node(&self) -> u16 {
        u16::try_from(self.nodes.len()).expect("the file has fewer phrases")
    }

    /// The entry of a phrase, made where there is none.
    fn phrase(&mut self, words: &[u16]) -> &mut Entry {
        let mut at = usize::from(self.first[usize::from(words[0])]);
        for word in &words[1..] {
            let fresh = self.node();
            let next = &mut self.nodes[at].next;
            at = match next.binary_search_by_key(word, |(word, _)| *word) {
                Ok(found) => usize::from(next[found].1),
                Err(place) => {
                    next.insert(place, (*word, fresh));
                    self.nodes.push(Node::default());
                    usize::from(fresh)
                }
            };
        }
        let fresh = u16::try_from(self.entries.len()).expect("the file has fewer phrases");
        let number = *self.nodes[at].entry.get_or_insert(fresh);
        if number == fresh {
            self.entries.push(Entry::default());
        }
        &mut self.entries[usize::from(number)]
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
}
