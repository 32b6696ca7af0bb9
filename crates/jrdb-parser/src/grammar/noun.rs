//! Noun groups: "the two oldest women", "a young, White and male person".

use jrdb_types::query::{Category, Quantity, Share};
use jrdb_types::{Age, Attribute, Condition, Pattern};

use crate::lexicon::{Role, Roles};
use crate::parser::Parser;
use crate::phrase::NounGroup;

/// Words without meaning before a noun.
pub(crate) const ARTICLES: Roles = Roles::of(&[Role::The, Role::A, Role::Filler]);

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

/// Words that may stand between a word and its noun.
pub(crate) const LOOK_MAX: usize = 8;

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

    pub(crate) fn determiners(&mut self, group: &mut NounGroup) {
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
                let is_one_of = (group.start..at).any(|at| {
                    self.is_at(at, Role::A) && self.word(at).to_ascii_lowercase().ends_with(" of")
                });
                let count = self.whole();
                if is_one_of && count.is_some() {
                    continue;
                }
                group.count = count.map(|count| (count, at));
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
    pub(crate) fn share(&self) -> Option<Share> {
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
    pub(crate) fn is_pronoun(&self) -> bool {
        self.is(Role::One) && !self.is_noun_ahead(self.state.at + 1)
    }

    /// "some" of "some 3 people" limits a number.
    pub(crate) fn is_quantity_of_articles(&self) -> bool {
        self.is(Role::Limit) && self.is_at(self.state.at + 1, Role::Number)
    }

    /// Whether the number at hand counts a noun that follows, and is neither "one" alone nor a
    /// length.
    pub(crate) fn is_count(&self) -> bool {
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
