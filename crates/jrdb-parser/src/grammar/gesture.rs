//! Gestures: what somebody points at.

use crate::lexicon::{Role, Roles};
use crate::parser::Parser;

impl Parser<'_> {
    /// Behind "pointing to the left" or "pointing at the door": a gesture, which says neither where
    /// somebody is nor what somebody does with others.
    pub(crate) fn end_of_gesture(&self, verb: usize) -> Option<usize> {
        const TO: Roles = Roles::of(&[Role::To, Role::At, Role::Towards]);
        const ARTICLES: Roles = Roles::of(&[Role::The, Role::His, Role::A]);
        if !self.word(verb).starts_with("point") {
            return None;
        }
        let named = self.next_not_in(verb + 1, TO);
        let side = self.next_not_in(named, ARTICLES);
        let is_side = self.is_at(side, Role::Sector);
        let is_of_thing = self.is_at(side + 1, Role::Of) || self.is_at(side + 1, Role::Noun);
        if is_side && !is_of_thing {
            return Some(side + 1);
        }
        let is_at_thing = named > verb + 1 && !(is_side && self.is_at(side + 1, Role::Of));
        let end = is_at_thing.then(|| self.named_object_end(named))?;
        (end > named).then_some(end)
    }
}
