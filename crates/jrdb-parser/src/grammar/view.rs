//! "From the woman's point of view": whose left and right are meant.

use crate::lexicon::{Role, Roles};
use crate::parser::Parser;

impl Parser<'_> {
    /// "from the woman's point of view," before a question: she is who "her left" belongs to.
    pub(crate) fn view(&mut self) {
        if !self.is(Role::To) {
            return;
        }
        let checkpoint = self.checkpoint();
        self.bump();
        let owner = self.view_owner();
        match owner {
            Some(owner) => {
                self.has_pronouns = true;
                self.set_antecedent(&owner);
                self.skip_while(Roles::of(&[Role::Comma, Role::Filler]));
            }
            None => self.rewind(checkpoint),
        }
    }

    /// "from that woman's perspective" behind a place, which is read from there anyway.
    pub(crate) fn trailing_view(&mut self) -> bool {
        if !self.is(Role::To) || !self.word(self.state.at).eq_ignore_ascii_case("from") {
            return false;
        }
        let checkpoint = self.checkpoint();
        self.bump();
        if self.is(Role::View) {
            self.bump();
            return true;
        }
        let found = self.view_owner().is_some();
        if !found {
            self.rewind(checkpoint);
        }
        found
    }

    fn view_owner(&mut self) -> Option<jrdb_types::Pattern> {
        if !(self.state.at..self.state.tokens.len()).any(|at| self.is_at(at, Role::View)) {
            return None;
        }
        let group = self.noun_group()?;
        let owner = self.with_modifiers(group.pattern, group.count);
        self.eat(Role::View).then_some(owner)
    }
}
