//! Noun groups: "the two oldest women", "a young, White and male person".

use jrdb_types::query::{Category, Order, Place, Quantity, Share};
use jrdb_types::{Age, Attribute, Condition, Direction, Pattern};

use crate::grammar::appearance::VISIBLE;
use crate::lexicon::{Measured, Role, Roles};
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
    Role::Most,
    Role::Half,
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
    Role::Looks,
    Role::Color,
    Role::Shade,
    Role::Other,
]);

/// What can begin a noun group.
pub(crate) const NOUN_START: Roles = Roles::of(&[
    Role::Interaction,
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
    Role::Looks,
    Role::Color,
    Role::Shade,
    Role::Other,
    Role::IdMark,
    Role::Most,
    Role::Half,
]);

/// What may stand between adjectives.
const JOINTS: Roles = Roles::of(&[Role::Comma, Role::And, Role::Or]);

/// What may begin a description before a noun.
const LOOKING: Roles = VISIBLE.and(Roles::of(&[Role::Wholly, Role::Implies]));

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
        if self.of_them(group) {
            return true;
        }
        let is_described = self.adjectives(group);
        if self.noun(group) || self.counted_pronoun(group) || is_described {
            reconcile_ages(group);
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
            if let Some(share) = self.share().filter(|_| !is_noun) {
                group.share = Some(share);
                group.is_all = true;
                group.quantity = None;
            } else if roles.has(Role::All) && !is_noun {
                group.is_all = !self.word(self.state.at).to_ascii_lowercase().starts_with("both");
                group.share = Some(Share::All);
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

    /// "most of", "half of", "none of".
    fn share(&self) -> Option<Share> {
        let roles = self.roles();
        if roles.has(Role::Most) {
            Some(Share::Most)
        } else if roles.has(Role::Half) {
            Some(Share::Half)
        } else if roles.has(Role::NoneOf) {
            Some(Share::None)
        } else {
            None
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
            let is_id = roles.has(Role::IdMark) && self.is_at(at + 1, Role::Number);
            if is_id || roles.has_any(Roles::of(&[Role::Noun, Role::One])) {
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
            || roles.has(Role::Implies) && self.is_adjective_here() && !(is_race && !self.is_race())
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

    /// Whether the colour at hand is a race: directly before a person, or before what else is said
    /// of one.
    fn is_race(&self) -> bool {
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
    fn looking(&mut self, group: &mut NounGroup) -> bool {
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

    fn is_race_at_hand(&self) -> bool {
        self.is(Role::Color) && self.is(Role::Implies) && self.is_race()
    }

    fn is_person_noun_ahead(&self) -> bool {
        let noun = (self.state.at..self.state.at + LOOK_MAX)
            .find(|at| !self.roles_at(*at).has_any(BEFORE_NOUN) || self.is_at(*at, Role::Noun));
        noun.is_some_and(|at| self.entry_at(at).category == Some(Category::Person))
    }

    /// "waving" of "a waving person".
    fn doing_adjective(&mut self, group: &mut NounGroup) -> bool {
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

    fn is_person_at(&self, at: usize) -> bool {
        self.entry_at(at).category == Some(Category::Person)
    }

    /// "other": none of those spoken of before.
    fn other(&mut self, group: &mut NounGroup) -> bool {
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
        let (entry, at) = (self.entry(), self.state.at);
        if self.marked_id(&mut group.pattern) {
            return true;
        }
        if !entry.roles.has_any(Roles::of(&[Role::Noun, Role::One])) {
            return false;
        }
        self.bump();
        if entry.roles.has(Role::Other) {
            match self.discourse {
                Some(_) => self.not_those(&mut group.pattern),
                None => {
                    self.state.at = at;
                    self.report_unused();
                }
            }
        } else if let Some(category) = &entry.category {
            group.pattern.category = category.clone();
            group.pattern.conditions.extend(self.implied(at));
            self.numbered(&mut group.pattern);
            self.state.last_noun = Some(entry);
            group.noun = Some(entry);
        } else {
            group.is_pronoun = true;
            group.noun = self.noun_of_one();
            if group.noun.is_none() && self.resume_discourse(group) {
                return true;
            }
            if let Some(noun) = group.noun {
                group.pattern.category = noun.category.clone().unwrap_or_default();
                group.pattern.conditions.extend(noun.implies.iter().cloned());
            }
        }
        if entry.roles.has(Role::All) {
            (group.is_all, group.share) = (true, Some(Share::All));
        }
        if entry.roles.has(Role::No) {
            group.quantity = Some(Quantity::NONE);
        }
        true
    }

    /// "them" of "all of them", "one of them": of those spoken of before, or of all people.
    fn of_them(&mut self, group: &mut NounGroup) -> bool {
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
    fn counted_pronoun(&mut self, group: &mut NounGroup) -> bool {
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
    fn resume_discourse(&mut self, group: &mut NounGroup) -> bool {
        let Some(those) = self.discourse.clone() else { return false };
        let earlier = std::mem::take(&mut group.pattern.conditions);
        group.pattern = (*those).clone();
        group.pattern.conditions.extend(earlier);
        true
    }

    /// "#4", "number four": a person by number.
    fn marked_id(&mut self, pattern: &mut Pattern) -> bool {
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
    fn numbered(&mut self, pattern: &mut Pattern) {
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

/// Leaves one age of "young girl" and "teenage boy": a young child is a child, and a teenage boy is
/// no child.
fn reconcile_ages(group: &mut NounGroup) {
    let age = |condition: &Condition| match condition {
        Condition::Attribute(value) if value.attribute() == Attribute::Age => Some(*value),
        _ => None,
    };
    let conditions = &mut group.pattern.conditions;
    let has = |conditions: &[Condition], wanted: Age| {
        conditions.iter().filter_map(age).any(|value| value == wanted.into())
    };
    let is_named = group.noun.is_some_and(|noun| noun.implies.iter().any(|c| age(c).is_some()));
    if !is_named {
        return;
    }
    let dropped = if has(conditions, Age::Adolescent) && has(conditions, Age::Child) {
        Age::Child
    } else if has(conditions, Age::Young)
        && (has(conditions, Age::Child) || has(conditions, Age::Adolescent))
    {
        Age::Young
    } else {
        return;
    };
    conditions.retain(|condition| age(condition) != Some(dropped.into()));
}
