//! Adjectives before a noun: "young, White and male", "second", "far".

use jrdb_types::query::{Category, Place};
use jrdb_types::{Attribute, Condition, Direction};

use crate::grammar::appearance::VISIBLE;
use crate::grammar::noun::LOOK_MAX;
use crate::lexicon::{Role, Roles};
use crate::parser::Parser;
use crate::pattern::{all_of, join_alternative, join_exclusive};
use crate::phrase::NounGroup;

/// What may stand between adjectives.
const JOINTS: Roles = Roles::of(&[Role::Comma, Role::And, Role::Or]);

/// What may begin a description before a noun.
const LOOKING: Roles = VISIBLE.and(Roles::of(&[Role::Wholly, Role::Implies]));

impl Parser<'_> {
    pub(crate) fn adjectives(&mut self, group: &mut NounGroup) -> bool {
        let (mut is_described, mut is_or) = (false, None);
        loop {
            let separator = self.state.at;
            if is_described {
                is_or = self.adjective_joint();
            }
            let length = group.pattern.conditions.len();
            if !self.adjective(group) {
                self.state.at = separator;
                return is_described;
            }
            if let Some(is_or) = is_or.take().filter(|_| length > 0) {
                let conditions = &mut group.pattern.conditions;
                match is_or {
                    true => join_alternative(conditions, length),
                    false => join_exclusive(conditions, length),
                }
            }
            is_described = true;
        }
    }

    /// Consumes "," and "and" between adjectives; true for "or".
    pub(crate) fn adjective_joint(&mut self) -> Option<bool> {
        let mut is_or = None;
        while self.roles().has_any(JOINTS) {
            is_or = Some(self.is(Role::Or) || is_or == Some(true));
            self.bump();
        }
        is_or?;
        let implies_plainly = |at: usize| {
            let is_before_noun =
                || self.is_noun_ahead(at + 1) || self.is_joint_of_adjectives(at + 1);
            self.is_at(at, Role::Implies) && (!self.is_at(at, Role::Action) || is_before_noun())
        };
        let fits =
            implies_plainly(self.state.at) || self.is(Role::Group) || self.is_noun_as_adjective();
        // Otherwise no adjective follows the joint, and the caller steps back.
        is_or.filter(|_| fits)
    }

    /// "child" of "child, White and male person".
    pub(crate) fn is_noun_as_adjective(&self) -> bool {
        let entry = self.entry();
        let is_age =
            |c: &Condition| matches!(c, Condition::Attribute(v) if v.attribute() == Attribute::Age);
        if entry.implies.is_empty() || entry.roles.has(Role::Plural) {
            return false;
        }
        if entry.category != Some(Category::Person) || !entry.implies.iter().all(is_age) {
            return false;
        }
        let next = self.next_not_in(self.state.at + 1, JOINTS);
        let roles = self.roles_at(next);
        let is_person = self.entry_at(next).category == Some(Category::Person);
        let is_plain =
            roles.has(Role::Implies) && !roles.has(Role::Action) && !roles.has(Role::Noun);
        if next > self.state.at + 1 {
            return is_plain && self.is_list_to_person(next);
        }
        let leads_on = is_plain || roles.has(Role::Unsupported);
        is_person || leads_on && (self.is_noun_ahead(next) || self.is_gender_ahead(next))
    }

    /// Whether the adjectives at a place have "male" or "female" among them, which may stand for a
    /// noun: "adolescent White male".
    fn is_gender_ahead(&self, from: usize) -> bool {
        let is_gender = |c: &Condition| matches!(c, Condition::Attribute(v) if v.attribute() == Attribute::Gender);
        let end = self.next_not_in(from, Roles::of(&[Role::Implies])).min(from + LOOK_MAX);
        (from..end).any(|at| self.entry_at(at).implies.iter().any(is_gender))
    }

    /// Whether adjectives and joints lead to a noun.
    pub(crate) fn is_list_to_person(&self, from: usize) -> bool {
        let list = Roles::of(&[Role::Comma, Role::And, Role::Or, Role::Implies]);
        let end = self.next_not_in(from, list).min(from + LOOK_MAX);
        (from..=end).any(|at| self.entry_at(at).category == Some(Category::Person))
    }

    pub(crate) fn adjective(&mut self, group: &mut NounGroup) -> bool {
        let (roles, at) = (self.roles(), self.state.at);
        if roles.has_any(LOOKING) && self.looking(group) {
            return true;
        }
        if roles.has(Role::Other) && self.other(group) {
            return true;
        }
        if roles.has(Role::Noun) && !self.is_noun_as_adjective() {
            return false;
        }
        let is_race = roles.has(Role::Color) && roles.has(Role::Implies);
        if roles.has(Role::Noun)
            || roles.has(Role::Implies) && self.is_adjective_here() && (!is_race || self.is_race())
        {
            group.pattern.conditions.extend(self.implied(at));
            self.bump();
            return true;
        }
        if roles.has(Role::Interaction) && self.doing_adjective(group) {
            return true;
        }
        if roles.has(Role::Comparative) && self.older(group) {
            return true;
        }
        let is_compared = roles.has(Role::Comparative)
            && (self.is_at(at + 1, Role::Of) || self.is_noun_ahead(at + 1));
        if roles.has(Role::Superlative) || is_compared {
            return self.chosen(group);
        }
        if roles.has(Role::Group) && !self.is_end() {
            return self.group(&mut group.pattern);
        }
        self.count_or_rank(group)
            || self.is_noun_ahead(at + 1)
                && (self.negated_adjective(group)
                    || self.place_adjective(group)
                    || self.unknown_adjective())
    }

    /// "second", "2nd", "last"; "two".
    pub(crate) fn count_or_rank(&mut self, group: &mut NounGroup) -> bool {
        let at = self.state.at;
        if let Some((rank, length)) = self.ordinal() {
            group.rank = Some((rank, at));
            group.is_last = self.is(Role::Last);
            self.state.at += length;
            return true;
        }
        let count = if self.is(Role::Number) && self.is_count() { self.whole() } else { None };
        group.count = count.map(|count| (count, at)).or(group.count);
        count.is_some()
    }

    /// "non-seated".
    pub(crate) fn negated_adjective(&mut self, group: &mut NounGroup) -> bool {
        let adjective = self.state.at + 1;
        let found = self.is(Role::Non) && self.is_at(adjective, Role::Implies);
        if found {
            let implied = all_of(self.entry_at(adjective).implies.clone());
            group.pattern.conditions.push(Condition::Not(Box::new(implied)));
            self.state.at += 2;
        }
        found
    }

    /// "far" and "left" of "far people", "the left woman".
    pub(crate) fn place_adjective(&mut self, group: &mut NounGroup) -> bool {
        let distance = self.entry().distance.map(Place::Distance);
        let Some(place) = distance.or_else(|| self.side_place()) else { return false };
        group.pattern.conditions.push(Condition::FromRobot(place));
        self.bump();
        true
    }

    pub(crate) fn unknown_adjective(&mut self) -> bool {
        let found = self.roles().has_any(Roles::of(&[Role::Unsupported, Role::Unknown]));
        if found {
            self.report_unused();
        }
        found
    }

    /// "or walking people" behind "standing".
    pub(crate) fn is_joint_of_adjectives(&self, at: usize) -> bool {
        let next = self.next_not_in(at, JOINTS);
        next > at
            && self.is_at(next, Role::Implies)
            && !self.is_at(next, Role::Noun)
            && self.is_list_to_person(next)
    }

    pub(crate) fn side_place(&self) -> Option<Place> {
        let sector = self.entry().sector.filter(|_| !self.is(Role::Of))?;
        Some(Place::Direction(Direction::level(sector)))
    }

    /// Whether the adjective at hand describes this noun: an action does so only before the noun.
    pub(crate) fn is_adjective_here(&self) -> bool {
        !self.is(Role::Action)
            || self.is_noun_ahead(self.state.at + 1)
            || self.is_joint_of_adjectives(self.state.at + 1)
    }

    /// A rank and its number of words: "second", "2nd".
    pub(crate) fn ordinal(&self) -> Option<(u32, usize)> {
        if self.is(Role::Ordinal) {
            return self.entry().number.map(|rank| (rank as u32, 1));
        }
        if !(self.is(Role::Number) && self.is_at(self.state.at + 1, Role::Suffix)) {
            return None;
        }
        self.word(self.state.at).parse().ok().filter(|rank| *rank > 0).map(|rank| (rank, 2))
    }

    pub(crate) fn chosen(&mut self, group: &mut NounGroup) -> bool {
        let rank = group.rank.take().map_or(1, |(rank, _)| rank);
        let count = group.count.take().map_or(1, |(count, _)| count);
        let start = self.state.at;
        match self.superlative(rank, count) {
            Some(pick) => self.put_pick(&mut group.pattern, pick, start),
            None => false,
        }
    }
}
