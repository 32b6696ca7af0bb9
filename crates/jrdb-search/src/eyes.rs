//! The truth of what is asked of whoever can see.

use jrdb_types::answer::Finding;

use crate::searcher::Searcher;
use crate::value::{Truth, Value};

/// From this probability on a description holds.
const HOLDS_MIN: f64 = 0.5;

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

    /// What was said of a thing, if somebody was asked.
    pub(crate) fn said(&self, number: usize, words: &str) -> Option<Finding> {
        let seen = self.seen.0.borrow();
        let probability = (*seen.get(&(number, words.to_owned()))?)?;
        Some(Finding::Looks { probability, source: self.eyes.source() })
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
