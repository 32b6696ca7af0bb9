//! How things look, asked of whoever can see them.

use std::cell::RefCell;
use std::collections::BTreeMap;

use jrdb_types::EntityId;

use crate::searcher::Searcher;
use crate::value::{Truth, Value};

/// Somebody who can look at a thing: a model of perception, a recorded exchange.
///
/// A search asks only about candidates that the other conditions leave open, and once about each
/// thing and phrase.
pub trait Looks {
    /// Probability, in `[0, 1]`, that the words describe the thing: `a striped shirt`, `smiling`.
    /// `None` if it cannot tell.
    fn probability(&self, id: &EntityId, words: &str) -> Option<f64>;
}

/// Nobody who could look: every phrase is unknown of everything.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Blind;

impl Looks for Blind {
    fn probability(&self, _: &EntityId, _: &str) -> Option<f64> {
        None
    }
}

/// From this probability on a description holds.
const HOLDS_MIN: f64 = 0.5;

/// What was asked before, by thing and words.
#[derive(Debug, Default)]
pub(crate) struct Seen(RefCell<BTreeMap<(usize, String), Option<f64>>>);

impl Searcher<'_, '_> {
    /// Whether words describe a thing.
    pub(crate) fn looks(&self, number: usize, words: &str) -> Value {
        match self.looked_at(number, words) {
            Some(probability) => {
                let value = Value::new(Truth::of(probability >= HOLDS_MIN), probability);
                Value { uncertain: probability > 0.0 && probability < 1.0, ..value }
            }
            None => Value::NOT_UNDERSTOOD,
        }
    }

    fn looked_at(&self, number: usize, words: &str) -> Option<f64> {
        let key = (number, words.to_owned());
        if let Some(known) = self.seen.0.borrow().get(&key) {
            return *known;
        }
        let id = self.index.id(number)?;
        let found = self.eyes.probability(id, words).map(|p| p.clamp(0.0, 1.0));
        self.seen.0.borrow_mut().insert(key, found);
        found
    }
}
