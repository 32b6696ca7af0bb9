//! The table of words and phrases: fast look-up of words and of the longest phrase.

use super::entry::Entry;
use super::piece::{Key, LETTERS_MAX, Piece, special};
use super::role::Role;

/// A step in the tree of phrases.
#[derive(Debug, Clone, Copy, Default)]
struct Step {
    from: u16,
    word: u16,
    /// 0 if the slot is free: no step leads to a first word.
    to: u16,
}

/// Slots of the tables of words and of steps: a power of two well above the number of either.
const SLOTS: usize = 16384;

/// The first number of the nodes behind a second or later word of a phrase.
const FURTHER: u16 = 1 << 15;

/// A node in the tree of phrases.
#[derive(Debug, Clone, Copy, Default)]
struct Node {
    /// The entry of the phrase that ends here, [`special::UNKNOWN`] where none does.
    entry: u16,
    /// The [`bit`]s of the words that lead on from here. Most words lead nowhere.
    next: u64,
}

/// The bit of a word in a set; other words may share it.
fn bit(word: u16) -> u64 {
    1 << (u32::from(word) % u64::BITS)
}

/// The phrases and their meanings.
pub(crate) struct Lexicon {
    entries: Vec<Entry>,
    words: Vec<&'static str>,
    keys: Vec<Key>,
    /// Word numbers by their keys, [`special::UNKNOWN`] if free.
    slots: Box<[u16; SLOTS]>,
    /// The first nodes of the phrases, by the number of the first word.
    first: Vec<Node>,
    /// The other nodes; their numbers begin at [`FURTHER`].
    further: Vec<Node>,
    /// Steps between nodes by node and word.
    steps: Box<[Step; SLOTS]>,
}

/// 2^64 over the golden ratio: the top bits of a product with it depend on all bits of the other
/// factor.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// The first slot to look for a number.
fn hash(number: u64) -> usize {
    (number.wrapping_mul(GOLDEN) >> (u64::BITS - SLOTS.ilog2())) as usize
}

/// The slot after another.
fn behind(slot: usize) -> usize {
    (slot + 1) % SLOTS
}

impl Lexicon {
    pub(super) fn new() -> Self {
        let count = special::COUNT as usize;
        let mut entries: Vec<Entry> = (0..count).map(|_| Entry::default()).collect();
        let kinds = [Role::Unknown, Role::Number, Role::Comma, Role::Slash, Role::Dash];
        for (entry, kind) in entries.iter_mut().zip(kinds) {
            entry.roles.insert(kind);
        }
        let (words, keys) = (vec![""; count], vec![Key::default(); count]);
        let (slots, steps) =
            (Box::new([special::UNKNOWN; SLOTS]), Box::new([Step::default(); SLOTS]));
        let first = (0..special::COUNT).map(|entry| Node { entry, next: 0 }).collect();
        Self { entries, words, keys, slots, first, further: Vec::new(), steps }
    }

    pub(crate) fn entry(&'static self, number: u16) -> &'static Entry {
        &self.entries[usize::from(number)]
    }

    /// The number of a word, [`special::UNKNOWN`] if it is in no phrase.
    pub(crate) fn word(&self, word: &str) -> u16 {
        self.number(Key::of(word.as_bytes(), word.len()))
    }

    /// The number of the word with a key, [`special::UNKNOWN`] if it is in no phrase.
    #[inline]
    pub(crate) fn number(&self, key: Key) -> u16 {
        self.slots[self.slot(key)]
    }

    /// The slot of a word, or the free one for it.
    fn slot(&self, key: Key) -> usize {
        let mut slot = hash(key.folded());
        loop {
            let number = self.slots[slot];
            if number == special::UNKNOWN || self.keys[usize::from(number)] == key {
                return slot;
            }
            slot = behind(slot);
        }
    }

    /// The slot of a step, or the free one for it.
    fn step(&self, from: u16, word: u16) -> usize {
        let mut slot = hash(u64::from(from) << u16::BITS | u64::from(word));
        loop {
            let step = self.steps[slot];
            if step.to == 0 || (step.from, step.word) == (from, word) {
                return slot;
            }
            slot = behind(slot);
        }
    }

    /// Whether two words mean the same thing: "woman" and "women".
    pub(crate) fn is_same(&self, first: &str, second: &str) -> bool {
        let entry =
            |word: &str| &self.entries[usize::from(self.first[usize::from(self.word(word))].entry)];
        let (first, second) = (entry(first), entry(second));
        let both = [first, second]
            .map(|e| (e.roles.of_meaning(), &e.category, &e.implies, &e.object, &e.people));
        both[0] == both[1] && first.category.is_some()
    }

    /// Every word of every phrase, for suggestions.
    pub(crate) fn words(&self) -> &[&'static str] {
        &self.words[usize::from(special::COUNT)..]
    }

    /// The longest phrase that begins with a word and continues with the pieces behind it: its
    /// entry, and the number of these pieces that belong to it.
    #[inline]
    pub(crate) fn longest(&self, first: u16, behind: &[Piece]) -> (u16, usize) {
        let mut at = first;
        let mut node = &self.first[usize::from(first)];
        let mut found = (node.entry, 0);
        for (index, piece) in behind.iter().enumerate() {
            if node.next & bit(piece.word) == 0 {
                break;
            }
            at = self.steps[self.step(at, piece.word)].to;
            if at == 0 {
                break;
            }
            node = &self.further[usize::from(at - FURTHER)];
            if node.entry != special::UNKNOWN {
                found = (node.entry, index + 1);
            }
        }
        found
    }

    /// The number of a word, which is added if it is new; none if it is too long.
    pub(super) fn intern(&mut self, word: &'static str) -> Option<u16> {
        if !(1..=LETTERS_MAX).contains(&word.len()) {
            return None;
        }
        let key = Key::of(word.as_bytes(), word.len());
        let slot = self.slot(key);
        if self.slots[slot] == special::UNKNOWN {
            let number = u16::try_from(self.words.len()).expect("the file has fewer words");
            self.slots[slot] = number;
            self.words.push(word);
            self.keys.push(key);
            self.first.push(Node::default());
        }
        Some(self.slots[slot])
    }

    /// The entry of a phrase, which is added if it is new.
    pub(super) fn phrase(&mut self, words: &[u16]) -> &mut Entry {
        let mut at = words[0];
        for word in &words[1..] {
            self.node(at).next |= bit(*word);
            let slot = self.step(at, *word);
            if self.steps[slot].to == 0 {
                let further =
                    u16::try_from(self.further.len()).expect("the file has fewer phrases");
                self.further.push(Node::default());
                self.steps[slot] = Step { from: at, word: *word, to: FURTHER + further };
            }
            at = self.steps[slot].to;
        }
        let count = u16::try_from(self.entries.len()).expect("the file has fewer phrases");
        let node = self.node(at);
        if node.entry == special::UNKNOWN {
            node.entry = count;
            self.entries.push(Entry::default());
        }
        let entry = self.node(at).entry;
        &mut self.entries[usize::from(entry)]
    }

    fn node(&mut self, at: u16) -> &mut Node {
        match at.checked_sub(FURTHER) {
            Some(further) => &mut self.further[usize::from(further)],
            None => &mut self.first[usize::from(at)],
        }
    }
}
