//! Noun groups: "the two oldest women", "a young, White and male person".

use jrdb_types::query::{Category, Place, Quantity};
use jrdb_types::{Attribute, Condition, Direction, Pattern};

use crate::lexicon::{Role, Roles};
use crate::parser::Parser;
use crate::pattern::{all_of, join_alternative, join_exclusive};
use crate::phrase::NounGroup;

/// Words without meaning before a noun.
const ARTICLES: Roles = Roles::of(&[Role::The, Role::A, Role::Filler]);

/// Words before the adjectives.
const DETERMINERS: Roles = Roles::of(&[
    Role::The,
    Role::A,
    Role::Filler,
    Role::All,
    Role::Number,
    Role::My,
    Role::His,
    Role::Limit,
    Role::Several,
    Role::No,
    Role::Between,
]);

/// What may stand between a word and the noun it belongs to.
pub(crate) const BEFORE_NOUN: Roles = Roles::of(&[
    Role::Implies,
    Role::Superlative,
    Role::Ordinal,
    Role::Number,
    Role::Far,
    Role::Sector,
    Role::Unsupported,
    Role::Unknown,
    Role::Non,
    Role::Last,
]);

/// What can begin a noun group.
pub(crate) const NOUN_START: Roles = Roles::of(&[
    Role::The,
    Role::A,
    Role::All,
    Role::No,
    Role::One,
    Role::My,
    Role::His,
    Role::Noun,
    Role::Implies,
    Role::Superlative,
    Role::Ordinal,
    Role::Number,
    Role::Limit,
    Role::Several,
    Role::Far,
    Role::Sector,
    Role::Unsupported,
    Role::Unknown,
    Role::Group,
    Role::Filler,
    Role::Between,
    Role::Non,
    Role::Last,
]);

/// What may stand between adjectives.
const JOINTS: Roles = Roles::of(&[Role::Comma, Role::And, Role::Or]);

/// Words that may stand between a word and its noun.
const LOOK_MAX: usize = 8;

impl Parser<'_> {
    /// A noun group: determiners, adjectives and noun, without clauses behind the noun.
    pub(crate) fn noun_group(&mut self) -> Option<NounGroup> {
        let mut group = NounGroup::default();
        self.read_noun_group(&mut group).then_some(group)
    }

    /// Reads a noun group into an empty one. If there is none, returns false, and the value must
    /// not be used.
    pub(crate) fn read_noun_group(&mut self, group: &mut NounGroup) -> bool {
        if !self.roles().has_any(NOUN_START) {
            return false;
        }
        let checkpoint = self.checkpoint();
        group.start = self.state.at;
        self.determiners(group);
        let is_described = self.adjectives(group);
        if self.noun(group) || is_described {
            self.after_noun(group);
            self.owned(group);
            return true;
        }
        self.rewind(checkpoint);
        false
    }

    fn determiners(&mut self, group: &mut NounGroup) {
        while self.roles().has_any(DETERMINERS) {
            if group.quantity.is_none() {
                group.quantity = self.quantity();
            }
            let roles = self.roles();
            let is_noun = roles.has(Role::Noun) || self.is_pronoun();
            if roles.has(Role::All) && !is_noun {
                group.is_all = true;
            } else if roles.has(Role::Number) && self.is_count() {
                let at = self.state.at;
                group.count = self.whole().map(|count| (count, at));
                let of_the = self.is(Role::Of) && self.is_at(self.state.at + 1, Role::The);
                self.state.at += if of_the { 2 } else { 0 };
                if group.count.is_none() {
                    return;
                }
                continue;
            } else if roles.has_any(Roles::of(&[Role::My, Role::His])) {
                if !self.is_noun_ahead(self.state.at + 1) {
                    return;
                }
            } else if !roles.has_any(ARTICLES) || is_noun || self.is_quantity_of_articles() {
                return;
            }
            self.bump();
        }
    }

    /// "those" without a noun.
    fn is_pronoun(&self) -> bool {
        self.is(Role::One) && !self.is_noun_ahead(self.state.at + 1)
    }

    /// "some" of "some 3 people" limits a number.
    fn is_quantity_of_articles(&self) -> bool {
        self.is(Role::Limit) && self.is_at(self.state.at + 1, Role::Number)
    }

    /// Whether the number at hand counts a noun that follows, and is neither "one" alone nor a
    /// length.
    fn is_count(&self) -> bool {
        let next = self.next_not_in(self.state.at, Roles::of(&[Role::Number]));
        let of_the = self.is_at(next, Role::Of) && self.is_at(next + 1, Role::The);
        let has_measure = self.is_at(next, Role::Unit) || self.is_at(next, Role::Clock);
        let is_suffixed = self.is_at(next, Role::Suffix);
        let is_choice = self.is_at(next, Role::Superlative);
        !has_measure && !is_suffixed && (of_the || is_choice || self.is_noun_ahead(next))
    }

    /// Whether a noun comes before anything that cannot stand before one.
    pub(crate) fn is_noun_ahead(&self, from: usize) -> bool {
        for at in from..from + LOOK_MAX {
            let roles = self.roles_at(at);
            if roles.has_any(Roles::of(&[Role::Noun, Role::One])) {
                return true;
            }
            if !roles.has_any(BEFORE_NOUN) {
                return false;
            }
        }
        false
    }

    fn adjectives(&mut self, group: &mut NounGroup) -> bool {
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
    fn adjective_joint(&mut self) -> Option<bool> {
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
    fn is_noun_as_adjective(&self) -> bool {
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
        is_person || (is_plain || roles.has(Role::Unsupported)) && self.is_noun_ahead(next)
    }

    /// Whether adjectives and joints lead to a noun.
    fn is_list_to_person(&self, from: usize) -> bool {
        let list = Roles::of(&[Role::Comma, Role::And, Role::Or, Role::Implies]);
        let end = self.next_not_in(from, list).min(from + LOOK_MAX);
        (from..=end).any(|at| self.entry_at(at).category == Some(Category::Person))
    }

    fn adjective(&mut self, group: &mut NounGroup) -> bool {
        let (roles, at) = (self.roles(), self.state.at);
        if roles.has(Role::Noun) && !self.is_noun_as_adjective() {
            return false;
        }
        if roles.has(Role::Noun) || roles.has(Role::Implies) && self.is_adjective_here() {
            if !self.color_of_object() {
                group.pattern.conditions.extend(self.entry().implies.iter().cloned());
                self.bump();
            }
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
    fn count_or_rank(&mut self, group: &mut NounGroup) -> bool {
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
    fn negated_adjective(&mut self, group: &mut NounGroup) -> bool {
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
    fn place_adjective(&mut self, group: &mut NounGroup) -> bool {
        let distance = self.entry().distance.map(Place::Distance);
        let Some(place) = distance.or_else(|| self.side_place()) else { return false };
        group.pattern.conditions.push(Condition::FromRobot(place));
        self.bump();
        true
    }

    fn unknown_adjective(&mut self) -> bool {
        let found = self.roles().has_any(Roles::of(&[Role::Unsupported, Role::Unknown]));
        if found {
            self.report_unused();
        }
        found
    }

    /// "or walking people" behind "standing".
    fn is_joint_of_adjectives(&self, at: usize) -> bool {
        let next = self.next_not_in(at, JOINTS);
        next > at
            && self.is_at(next, Role::Implies)
            && !self.is_at(next, Role::Noun)
            && self.is_list_to_person(next)
    }

    fn side_place(&self) -> Option<Place> {
        let sector = self.entry().sector.filter(|_| !self.is(Role::Of))?;
        Some(Place::Direction(Direction::level(sector)))
    }

    /// Whether the adjective at hand describes this noun: an action does so only before the noun.
    fn is_adjective_here(&self) -> bool {
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

    fn chosen(&mut self, group: &mut NounGroup) -> bool {
        let rank = group.rank.take().map_or(1, |(rank, _)| rank);
        let count = group.count.take().map_or(1, |(count, _)| count);
        let start = self.state.at;
        match self.superlative(rank, count) {
            Some(pick) => self.put_pick(&mut group.pattern, pick, start),
            None => false,
        }
    }

    /// "part of a group of three persons".
    pub(crate) fn group(&mut self, pattern: &mut Pattern) -> bool {
        let checkpoint = self.checkpoint();
        self.bump();
        self.skip_while(ARTICLES);
        let size = self.quantity().or_else(|| self.whole().map(Quantity::exactly));
        let Some(size) = size else {
            self.rewind(checkpoint);
            return false;
        };
        self.state.at += usize::from(self.entry().category == Some(Category::Person));
        pattern.conditions.push(Condition::GroupSize(size));
        true
    }

    pub(crate) fn noun(&mut self, group: &mut NounGroup) -> bool {
        let entry = self.entry();
        if !entry.roles.has_any(Roles::of(&[Role::Noun, Role::One])) {
            return false;
        }
        self.bump();
        if let Some(category) = &entry.category {
            group.pattern.category = category.clone();
            group.pattern.conditions.extend(entry.implies.iter().cloned());
            self.state.last_noun = Some(entry);
            group.noun = Some(entry);
        } else {
            group.is_pronoun = true;
            group.noun = self.noun_of_one();
            if let Some(noun) = group.noun {
                group.pattern.category = noun.category.clone().unwrap_or_default();
                group.pattern.conditions.extend(noun.implies.iter().cloned());
            }
        }
        group.is_all |= entry.roles.has(Role::All);
        if entry.roles.has(Role::No) {
            group.quantity = Some(Quantity::NONE);
        }
        true
    }
}
