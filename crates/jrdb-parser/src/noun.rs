//! Noun phrases: "the two oldest women", "a young, White and male person".

use jrdb_types::query::{Category, Place, Quantity};
use jrdb_types::{Attribute, Condition, Direction, Pattern};

use crate::joined::join;
use crate::lexicon::{Role, Roles};
use crate::parser::Parser;

/// A noun phrase.
#[derive(Debug, Default)]
pub(crate) struct Thing {
    pub(crate) pattern: Pattern,
    /// "at least two", "no".
    pub(crate) quantity: Option<Quantity>,
    /// "two", with the place of the word.
    pub(crate) count: Option<(u32, usize)>,
    /// "second", with the place of the word.
    pub(crate) rank: Option<(u32, usize)>,
    /// "last": the rank is from the other end.
    pub(crate) is_last: bool,
    /// "all", "everyone".
    pub(crate) is_all: bool,
    /// The place of its first word.
    pub(crate) start: usize,
    /// "those" and nothing else.
    pub(crate) is_pronoun: bool,
}

impl Thing {
    /// How many there must be, where it is not the words of a choice.
    pub(crate) fn how_many(&self) -> Quantity {
        let count = self.count.filter(|(count, _)| *count > 1);
        let counted = count.map(|(count, _)| Quantity::at_least(count));
        self.quantity.or(counted).unwrap_or_default()
    }
}

/// Words before a noun that say nothing of the thing.
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
    Role::Says,
    Role::Superlative,
    Role::Ordinal,
    Role::Number,
    Role::Far,
    Role::Sector,
    Role::Lacks,
    Role::Unknown,
    Role::Non,
    Role::Last,
]);

/// What can begin a noun phrase.
pub(crate) const NOUN_START: Roles = Roles::of(&[
    Role::The,
    Role::A,
    Role::All,
    Role::No,
    Role::One,
    Role::My,
    Role::His,
    Role::Noun,
    Role::Says,
    Role::Superlative,
    Role::Ordinal,
    Role::Number,
    Role::Limit,
    Role::Several,
    Role::Far,
    Role::Sector,
    Role::Lacks,
    Role::Unknown,
    Role::Group,
    Role::Filler,
    Role::Between,
    Role::Non,
    Role::Last,
]);

/// What may stand between adjectives.
const JOINTS: Roles = Roles::of(&[Role::Comma, Role::And, Role::Or]);

/// Words between a word and its noun at most.
const LOOK_MAX: usize = 8;

impl Parser<'_> {
    /// Reads a noun phrase without what is said behind the noun.
    pub(crate) fn thing(&mut self) -> Option<Thing> {
        let mut thing = Thing::default();
        self.read_thing(&mut thing).then_some(thing)
    }

    /// Reads a noun phrase into a new thing; false, and the thing is of no use, when there is none.
    pub(crate) fn read_thing(&mut self, thing: &mut Thing) -> bool {
        if !self.roles().has_any(NOUN_START) {
            return false;
        }
        let mark = self.mark();
        thing.start = self.at;
        self.determiners(thing);
        let is_described = self.adjectives(thing);
        if self.noun(thing) || is_described {
            self.behind_noun(thing);
            self.owned(thing);
            return true;
        }
        self.reset(mark);
        false
    }

    fn determiners(&mut self, thing: &mut Thing) {
        while self.roles().has_any(DETERMINERS) {
            if thing.quantity.is_none() {
                thing.quantity = self.quantity();
            }
            let roles = self.roles();
            let is_noun = roles.has(Role::Noun) || self.is_pronoun();
            if roles.has(Role::All) && !is_noun {
                thing.is_all = true;
            } else if roles.has(Role::Number) && self.is_count() {
                let at = self.at;
                thing.count = self.whole().map(|count| (count, at));
                let of_the = self.is(Role::Of) && self.is_at(self.at + 1, Role::The);
                self.at += if of_the { 2 } else { 0 };
                if thing.count.is_none() {
                    return;
                }
                continue;
            } else if roles.has_any(Roles::of(&[Role::My, Role::His])) {
                if !self.is_noun_ahead(self.at + 1) {
                    return;
                }
            } else if !roles.has_any(ARTICLES) || is_noun || self.is_quantity_of_articles() {
                return;
            }
            self.at += 1;
        }
    }

    /// "those" without a noun.
    fn is_pronoun(&self) -> bool {
        self.is(Role::One) && !self.is_noun_ahead(self.at + 1)
    }

    /// "some" of "some 3 people" limits a number.
    fn is_quantity_of_articles(&self) -> bool {
        self.is(Role::Limit) && self.is_at(self.at + 1, Role::Number)
    }

    /// Whether the number at hand counts a noun that follows, and is neither "one" alone nor a length.
    fn is_count(&self) -> bool {
        let next = self.after(self.at, Roles::of(&[Role::Number]));
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

    fn adjectives(&mut self, thing: &mut Thing) -> bool {
        let (mut is_described, mut is_or) = (false, None);
        loop {
            let separator = self.at;
            if is_described {
                is_or = self.adjective_joint();
            }
            let length = thing.pattern.conditions.len();
            if !self.adjective(thing) {
                self.at = separator;
                return is_described;
            }
            if let Some(is_or) = is_or.take().filter(|_| length > 0) {
                join(&mut thing.pattern.conditions, length, is_or);
            }
            is_described = true;
        }
    }

    /// Steps over "," and "and" between adjectives; true for "or".
    fn adjective_joint(&mut self) -> Option<bool> {
        let mut is_or = None;
        while self.roles().has_any(JOINTS) {
            is_or = Some(self.is(Role::Or) || is_or == Some(true));
            self.at += 1;
        }
        is_or?;
        let says_plainly = |at: usize| {
            let is_before_noun =
                || self.is_noun_ahead(at + 1) || self.is_joint_of_adjectives(at + 1);
            self.is_at(at, Role::Says) && (!self.is_at(at, Role::Action) || is_before_noun())
        };
        let fits = says_plainly(self.at) || self.is(Role::Group) || self.is_noun_as_adjective();
        // Whatever else follows the joint is no adjective: the caller steps back.
        is_or.filter(|_| fits)
    }

    /// "child" of "child, White and male person".
    fn is_noun_as_adjective(&self) -> bool {
        let entry = self.entry();
        let is_age =
            |c: &Condition| matches!(c, Condition::Attribute(v) if v.attribute() == Attribute::Age);
        if entry.says.is_empty() || entry.roles.has(Role::Plural) {
            return false;
        }
        if entry.category != Some(Category::Person) || !entry.says.iter().all(is_age) {
            return false;
        }
        let next = self.after(self.at + 1, JOINTS);
        let roles = self.roles_at(next);
        let is_person = self.entry_at(next).category == Some(Category::Person);
        let is_plain = roles.has(Role::Says) && !roles.has(Role::Action) && !roles.has(Role::Noun);
        if next > self.at + 1 {
            return is_plain && self.is_list_to_person(next);
        }
        is_person || (is_plain || roles.has(Role::Lacks)) && self.is_noun_ahead(next)
    }

    /// Whether adjectives and joints lead to a noun.
    fn is_list_to_person(&self, from: usize) -> bool {
        let list = Roles::of(&[Role::Comma, Role::And, Role::Or, Role::Says]);
        let end = self.after(from, list).min(from + LOOK_MAX);
        (from..=end).any(|at| self.entry_at(at).category == Some(Category::Person))
    }

    fn adjective(&mut self, thing: &mut Thing) -> bool {
        let (entry, roles, at) = (self.entry(), self.roles(), self.at);
        if roles.has(Role::Noun) && !self.is_noun_as_adjective() {
            return false;
        }
        let conditions = &mut thing.pattern.conditions;
        if roles.has(Role::Noun) || roles.has(Role::Says) && self.is_adjective_here() {
            if !self.color_of_thing() {
                conditions.extend(entry.says.iter().cloned());
                self.at += 1;
            }
            return true;
        }
        let is_compared = roles.has(Role::Comparative)
            && (self.is_at(at + 1, Role::Of) || self.is_noun_ahead(at + 1));
        if roles.has(Role::Superlative) || is_compared {
            return self.chosen(thing);
        }
        if roles.has(Role::Non) && self.is_at(at + 1, Role::Says) && self.is_noun_ahead(at + 1) {
            let said = crate::joined::all_of(self.entry_at(at + 1).says.clone());
            conditions.push(Condition::Not(Box::new(said)));
            self.at += 2;
            return true;
        }
        if let Some((rank, length)) = self.ordinal() {
            thing.rank = Some((rank, at));
            thing.is_last = roles.has(Role::Last);
            self.at += length;
            return true;
        }
        if roles.has(Role::Group) && !self.is_end() {
            return self.group(&mut thing.pattern);
        }
        if roles.has(Role::Number) && self.is_count() {
            thing.count = self.whole().map(|count| (count, at));
            return thing.count.is_some();
        }
        if !self.is_noun_ahead(at + 1) {
            return false;
        }
        if let Some(place) = entry.distance.map(Place::Distance).or_else(|| self.side_place()) {
            conditions.push(Condition::FromRobot(place));
            self.at += 1;
            return true;
        }
        if roles.has_any(Roles::of(&[Role::Lacks, Role::Unknown])) {
            self.report_unused();
            return true;
        }
        false
    }

    /// "or walking people" behind "standing".
    fn is_joint_of_adjectives(&self, at: usize) -> bool {
        let next = self.after(at, JOINTS);
        next > at
            && self.is_at(next, Role::Says)
            && !self.is_at(next, Role::Noun)
            && self.is_list_to_person(next)
    }

    fn side_place(&self) -> Option<Place> {
        let sector = self.entry().sector.filter(|_| !self.is(Role::Of))?;
        Some(Place::Direction(Direction::level(sector)))
    }

    /// Adjectives stand before or without a noun; what a body does, only before it.
    fn is_adjective_here(&self) -> bool {
        !self.is(Role::Action)
            || self.is_noun_ahead(self.at + 1)
            || self.is_joint_of_adjectives(self.at + 1)
    }

    /// A rank and how many words tell it: "second", "2nd".
    pub(crate) fn ordinal(&self) -> Option<(u32, usize)> {
        if self.is(Role::Ordinal) {
            return self.entry().number.map(|rank| (rank as u32, 1));
        }
        if !(self.is(Role::Number) && self.is_at(self.at + 1, Role::Suffix)) {
            return None;
        }
        self.word(self.at).parse().ok().filter(|rank| *rank > 0).map(|rank| (rank, 2))
    }

    fn chosen(&mut self, thing: &mut Thing) -> bool {
        let rank = thing.rank.take().map_or(1, |(rank, _)| rank);
        let count = thing.count.take().map_or(1, |(count, _)| count);
        let start = self.at;
        match self.superlative(rank, count) {
            Some(pick) => self.put_pick(&mut thing.pattern, pick, start),
            None => false,
        }
    }

    /// "part of a group of three persons".
    pub(crate) fn group(&mut self, pattern: &mut Pattern) -> bool {
        let mark = self.mark();
        self.at += 1;
        self.skip(ARTICLES);
        let size = self.quantity().or_else(|| self.whole().map(Quantity::exactly));
        let Some(size) = size else {
            self.reset(mark);
            return false;
        };
        self.at += usize::from(self.entry().category == Some(Category::Person));
        pattern.conditions.push(Condition::GroupSize(size));
        true
    }

    pub(crate) fn noun(&mut self, thing: &mut Thing) -> bool {
        let entry = self.entry();
        if !entry.roles.has_any(Roles::of(&[Role::Noun, Role::One])) {
            return false;
        }
        self.at += 1;
        if let Some(category) = &entry.category {
            thing.pattern.category = category.clone();
            thing.pattern.conditions.extend(entry.says.iter().cloned());
            self.last_noun = Some(entry);
        } else {
            thing.is_pronoun = true;
            if let Some(noun) = self.last_noun {
                thing.pattern.category = noun.category.clone().unwrap_or_default();
                thing.pattern.conditions.extend(noun.says.iter().cloned());
            }
        }
        thing.is_all |= entry.roles.has(Role::All);
        if entry.roles.has(Role::No) {
            thing.quantity = Some(Quantity::NONE);
        }
        true
    }
}
