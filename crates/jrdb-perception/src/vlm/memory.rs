//! Answers that were given before: the same picture and question need not be weighed again.

use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::{Mutex, PoisonError};

use jrdb_types::Image;

/// Answers are kept until there are so many; then all are forgotten.
const MOST: usize = 1 << 14;

/// A question about a picture.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Key {
    size_px: [usize; 2],
    /// A hash of the pixels: pictures of different frames may have the same place.
    pixels: u64,
    pub(super) question: String,
}

impl Key {
    /// The keys of questions about a picture.
    pub(super) fn all(picture: &Image, questions: &[String]) -> Vec<Self> {
        let mut hasher = DefaultHasher::new();
        picture.rgb.hash(&mut hasher);
        let (size_px, pixels) = ([picture.width, picture.height], hasher.finish());
        let key = |question: &String| Self { size_px, pixels, question: question.clone() };
        questions.iter().map(key).collect()
    }
}

/// Probabilities by question.
#[derive(Debug, Default)]
pub(super) struct Memory(Mutex<BTreeMap<Key, f64>>);

impl Memory {
    pub(super) fn get(&self, key: &Key) -> Option<f64> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get(key).copied()
    }

    pub(super) fn put(&self, entries: impl IntoIterator<Item = (Key, f64)>) {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if known.len() >= MOST {
            known.clear();
        }
        known.extend(entries);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_are_kept_by_picture_and_question() {
        let questions = ["hat?".to_owned(), "tie?".to_owned()];
        let keys = |shade: u8| Key::all(&Image::filled(4, 2, [shade; 3]), &questions);
        let memory = Memory::default();
        memory.put([(keys(3)[0].clone(), 0.25)]);
        assert_eq!(memory.get(&keys(3)[0]), Some(0.25));
        assert_eq!((memory.get(&keys(3)[1]), memory.get(&keys(4)[0])), (None, None));
    }
}
