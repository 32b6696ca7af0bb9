//! How things look, asked of whoever can see them.

use std::cell::RefCell;
use std::collections::BTreeMap;

use jrdb_types::EntityId;

/// Somebody who can look at a thing: a model of perception, a recorded exchange.
///
/// A search asks only about candidates that the other conditions leave open, and once about each
/// thing and phrase.
pub trait Looks {
    /// Probability, in `[0, 1]`, that the words describe the thing: `a striped shirt`, `smiling`.
    /// `None` if it cannot tell.
    fn probability(&self, id: &EntityId, words: &str) -> Option<f64>;

    /// Who it is, in a word or two, for the trace.
    fn source(&self) -> String;
}

/// Nobody who could look: every phrase is unknown of everything.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Blind;

impl Looks for Blind {
    fn probability(&self, _: &EntityId, _: &str) -> Option<f64> {
        None
    }

    fn source(&self) -> String {
        "nobody".into()
    }
}

/// What was asked before, by thing and words.
#[derive(Debug, Default)]
pub(crate) struct Seen(pub(crate) RefCell<BTreeMap<(usize, String), Option<f64>>>);
