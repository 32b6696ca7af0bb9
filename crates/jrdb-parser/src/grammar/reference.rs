//! Words that stand for what was named before, and numbers of things: "the other", "them", "#4".

use jrdb_types::query::Share;
use jrdb_types::{Condition, Pattern};

use crate::lexicon::{Role, Roles};
use crate::parser::Parser;
use crate::phrase::NounGroup;

impl Parser<'_> {
    /// "other": none of those spoken of before.
    pub(crate) fn other(&mut self, group: &mut NounGroup) -> bool {
        if !self.is_noun_ahead(self.state.at + 1) {
            return false;
        }
        if self.discourse.is_none() {
            self.report_unused();
            return true;
        }
        self.bump();
        self.not_those(&mut group.pattern);
        true
    }

    /// Excludes what was spoken of before.
    pub(crate) fn not_those(&mut self, pattern: &mut Pattern) {
        let Some(those) = self.discourse.clone() else { return };
        pattern.category = those.category.clone();
        let is = Condition::Is(Box::new((*those).clone()));
        pattern.conditions.push(Condition::Not(Box::new(is)));
    }

    /// "them" of "all of them", "one of them": of those spoken of before, or of all people.
    pub(crate) fn of_them(&mut self, group: &mut NounGroup) -> bool {
        const BEFORE: Roles =
            Roles::of(&[Role::A, Role::All, Role::Most, Role::Half, Role::NoneOf, Role::Of]);
        let at = self.state.at;
        let is_of = at > group.start && self.roles_at(at - 1).has_any(BEFORE);
        let is_them = self.word(at).eq_ignore_ascii_case("them");
        if !is_of && group.count.is_none() && group.quantity.is_none() || !is_them {
            return false;
        }
        self.bump();
        let those = self.discourse.clone().or_else(|| self.state.antecedent.clone());
        group.pattern = those.map(|those| (*those).clone()).unwrap_or_default();
        true
    }

    /// "the two on the bench": so many people, or of those spoken of before.
    pub(crate) fn counted_pronoun(&mut self, group: &mut NounGroup) -> bool {
        const FOLLOWS: Roles = Roles::of(&[
            Role::At,
            Role::Who,
            Role::With,
            Role::Is,
            Role::Action,
            Role::Relation,
            Role::Near,
            Role::Interaction,
            Role::Without,
            Role::Sector,
            Role::Of,
        ]);
        let at = self.state.at;
        let is_definite = at > 0 && self.is_at(at - 1, Role::The);
        if !is_definite || !self.is(Role::Number) || !self.roles_at(at + 1).has_any(FOLLOWS) {
            return false;
        }
        let Some(count) = self.whole() else { return false };
        if self.is(Role::Of) && self.is_at(self.state.at + 1, Role::Him) {
            self.bump();
            self.eat_pronoun();
        }
        group.count = Some((count, at));
        group.share = Some(Share::All);
        let earlier = self.discourse.clone().or_else(|| self.state.antecedent.clone());
        if let Some(those) = earlier {
            group.pattern = (*those).clone();
        }
        true
    }

    /// What was spoken of in the sentences before, for "the one".
    pub(crate) fn resume_discourse(&mut self, group: &mut NounGroup) -> bool {
        let Some(those) = self.discourse.clone() else { return false };
        let earlier = std::mem::take(&mut group.pattern.conditions);
        group.pattern = (*those).clone();
        group.pattern.conditions.extend(earlier);
        true
    }

    /// "#4", "number four": a person by number.
    pub(crate) fn marked_id(&mut self, pattern: &mut Pattern) -> bool {
        let next = self.state.at + 1;
        if !self.is(Role::IdMark) || !self.is_at(next, Role::Number) {
            return false;
        }
        let start = self.state.at;
        self.bump();
        let Some(number) = self.whole() else {
            self.state.at = start;
            return false;
        };
        pattern.conditions.push(Condition::Id(number));
        true
    }

    /// "4" of "person 4", "#4" of "person #4".
    pub(crate) fn numbered(&mut self, pattern: &mut Pattern) {
        const MEASURES: Roles = Roles::of(&[
            Role::Unit,
            Role::Degrees,
            Role::Clock,
            Role::Suffix,
            Role::Noun,
            Role::To,
        ]);
        if self.marked_id(pattern) {
            return;
        }
        let next = self.state.at + 1;
        let is_singular = !self.is_at(self.state.at.wrapping_sub(1), Role::Plural);
        let is_plain = self.is(Role::Number)
            && is_singular
            && !self.roles_at(next).has_any(MEASURES)
            && !self.is_noun_ahead(next)
            && !self.is_at(next, Role::Dash);
        let start = self.state.at;
        match is_plain.then(|| self.whole()).flatten() {
            Some(number) => pattern.conditions.push(Condition::Id(number)),
            None => self.state.at = start,
        }
    }
}
