//! Adjectives that say what kind of person is meant: race, plain ages, what is worn or done.

use jrdb_types::query::{Category, Order};
use jrdb_types::{Age, Attribute, Condition};

use crate::grammar::noun::{BEFORE_NOUN, LOOK_MAX};
use crate::lexicon::{Measured, Role, Roles};
use crate::parser::Parser;
use crate::phrase::NounGroup;

impl Parser<'_> {
    /// Whether the colour at hand is a race: directly before a person, or before what else is said
    /// of one.
    pub(crate) fn is_race(&self) -> bool {
        const LIST: Roles = Roles::of(&[
            Role::Implies,
            Role::Comma,
            Role::And,
            Role::Or,
            Role::Group,
            Role::Filler,
            Role::Superlative,
            Role::Slash,
        ]);
        let mut next = self.state.at + 1;
        while self.roles_at(next).has_any(LIST) && !self.is_at(next, Role::Noun) {
            if next > self.state.at + LOOK_MAX {
                return false;
            }
            next += 1;
        }
        let is_one = self.is_at(next, Role::One) && !self.is_at(next, Role::The);
        let is_gender = |c: &Condition| matches!(c, Condition::Attribute(v) if v.attribute() == Attribute::Gender);
        if (self.state.at + 1..next).any(|at| self.entry_at(at).implies.iter().any(is_gender)) {
            return true;
        }
        let is_person = self.entry_at(next).category == Some(Category::Person);
        is_person || is_one || self.is_at(next - 1, Role::Group)
    }

    /// Words that say how the thing looks that is named behind them: "red shirt kid", "black car".
    pub(crate) fn looking(&mut self, group: &mut NounGroup) -> bool {
        let checkpoint = self.checkpoint();
        if self.is_race_at_hand() {
            return false;
        }
        let before = group.pattern.conditions.len();
        let is_colored = self.roles().has_any(Roles::of(&[Role::Color, Role::Shade, Role::Wholly]));
        if is_colored && self.clothes(&mut group.pattern) && self.is_person_noun_ahead() {
            return true;
        }
        group.pattern.conditions.truncate(before);
        self.rewind(checkpoint);
        self.visible_adjective(&mut group.pattern)
    }

    pub(crate) fn is_race_at_hand(&self) -> bool {
        self.is(Role::Color) && self.is(Role::Implies) && self.is_race()
    }

    pub(crate) fn is_person_noun_ahead(&self) -> bool {
        let noun = (self.state.at..self.state.at + LOOK_MAX)
            .find(|at| !self.roles_at(*at).has_any(BEFORE_NOUN) || self.is_at(*at, Role::Noun));
        noun.is_some_and(|at| self.entry_at(at).category == Some(Category::Person))
    }

    /// "waving" of "a waving person".
    pub(crate) fn doing_adjective(&mut self, group: &mut NounGroup) -> bool {
        let at = self.state.at;
        let Some(label) = self.entry().people.as_deref().filter(|_| !self.is(Role::Action)) else {
            return false;
        };
        let next = self.next_not_in(at + 1, Roles::of(&[Role::Implies]));
        if !self.is_person_at(at + 1) && !self.is_person_at(next) {
            return false;
        }
        self.bump();
        self.bare_interaction(&mut group.pattern, label, at);
        true
    }

    pub(crate) fn is_person_at(&self, at: usize) -> bool {
        self.entry_at(at).category == Some(Category::Person)
    }

    /// "older" of "an older man" and "the older men": an age, and not the oldest.
    pub(crate) fn older(&mut self, group: &mut NounGroup) -> bool {
        let Some((Measured::Age, order)) = self.entry().order else { return false };
        let next = self.state.at + 1;
        let noun = (next..next + LOOK_MAX)
            .find(|at| self.is_at(*at, Role::Noun) || !self.roles_at(*at).has_any(BEFORE_NOUN));
        let is_noun = noun.is_some_and(|at| self.is_at(at, Role::Noun));
        let is_plural = noun.is_some_and(|at| self.is_at(at, Role::Plural));
        let is_definite = (group.start..self.state.at).any(|at| self.is_at(at, Role::The));
        if !is_noun || is_definite && !is_plural {
            return false;
        }
        self.bump();
        let age = match order {
            Order::Most => Condition::has(Age::Elderly),
            Order::Least => Condition::has(Age::Young),
        };
        group.pattern.conditions.push(age);
        true
    }
}
