//! Predicates: "not sitting near the table", "except those standing", "is a woman".

use jrdb_types::query::{Category, Quantity, RelationKind};
use jrdb_types::{Condition, Pattern};

use crate::grammar::appearance::VISIBLE;
use crate::grammar::clothes::CLOTHES_START;
use crate::grammar::noun::NOUN_START;
use crate::grammar::place::LOCATION_START;
use crate::lexicon::{Role, Roles};
use crate::parser::Parser;
use crate::pattern::{all_of, alternative, any_of, chosen, push_related, split_from};
use crate::phrase::After;

impl Parser<'_> {
    /// Predicates without a joint between them: "sitting near the table".
    pub(crate) fn predicates(&mut self, pattern: &mut Pattern) -> bool {
        if !self.predicate(pattern, After::Verb) {
            return false;
        }
        const JOINTS: Roles = Roles::of(&[
            Role::Comma,
            Role::And,
            Role::Or,
            Role::Who,
            Role::Is,
            Role::Then,
            Role::During,
            Role::Neither,
            Role::Not,
            Role::Doing,
            Role::Has,
            Role::Than,
            Role::Without,
            Role::Unsupported,
            Role::Except,
        ]);
        while !self.is_end()
            && !self.roles().has_any(JOINTS)
            && self.predicate(pattern, After::Noun)
        {}
        true
    }

    /// [`Self::predicates`] as conditions only: in "not the tallest" and "sitting or the tallest"
    /// the choice is one condition among others, and chooses nothing by itself.
    pub(crate) fn conditions(&mut self, pattern: &mut Pattern) -> bool {
        let outer = pattern.pick.take();
        let found = self.predicates(pattern);
        if let Some(pick) = std::mem::replace(&mut pattern.pick, outer) {
            pattern.conditions.push(chosen(pick, &pattern.category));
        }
        found
    }

    /// One predicate of the subject.
    pub(crate) fn predicate(&mut self, pattern: &mut Pattern, after: After) -> bool {
        let roles = self.roles();
        if roles.has(Role::Not) {
            return self.negated(pattern);
        }
        if roles.has_any(CLOTHES_START) && self.clothes(pattern) {
            return true;
        }
        if roles.has_any(Roles::of(&[Role::Action, Role::Interaction])) {
            if self.passive(pattern) {
                return true;
            }
            return self.activity(pattern);
        }
        if roles.has(Role::Noun) && after == After::Verb && self.predicate_nominal(pattern) {
            return true;
        }
        if roles.has(Role::Implies) && self.adjective_predicate(pattern) {
            return true;
        }
        if roles.has(Role::Common) && self.is_at(self.state.at + 1, Role::Looks) {
            // "looks happy".
            let checkpoint = self.checkpoint();
            self.bump();
            if self.deed(pattern) {
                return true;
            }
            self.rewind(checkpoint);
        }
        if roles.has_any(Roles::of(&[Role::Looks, Role::Unknown])) && self.deed(pattern) {
            return true;
        }
        if roles.has_any(LOCATION_START) && !roles.has(Role::Noun) && self.location(pattern, after)
        {
            return true;
        }
        if roles.has(Role::Relation) && self.relation(pattern) {
            return true;
        }
        if roles.has_any(Roles::of(&[Role::Has, Role::With, Role::Without]))
            && self.possession(pattern)
        {
            return true;
        }
        self.rare_predicate(pattern, after)
    }

    fn rare_predicate(&mut self, pattern: &mut Pattern, after: After) -> bool {
        let (roles, start) = (self.roles(), self.state.at);
        if roles.has(Role::Neither) {
            return self.neither(pattern);
        }
        if roles.has(Role::Either) {
            self.skip_while(Roles::of(&[Role::Either]));
            return self.predicate(pattern, after) || {
                self.state.at = start;
                false
            };
        }
        if roles.has(Role::Except) {
            return self.except(pattern);
        }
        if roles.has(Role::Doing) {
            self.bump();
            self.state.asks_doing = true;
            return true;
        }
        let is_the = roles.has(Role::The) && self.is_at(start + 1, Role::Superlative);
        if roles.has(Role::Superlative) || is_the {
            self.state.at += usize::from(is_the);
            return self.superlative_predicate(pattern, 1, start);
        }
        if roles.has(Role::Comparative) {
            return self.comparative(pattern);
        }
        if roles.has(Role::Between) {
            return self.between(pattern);
        }
        if roles.has(Role::Group) {
            return self.group(pattern);
        }
        if let Some((rank, length)) = self.ordinal() {
            self.state.at += length;
            return self.superlative_predicate(pattern, rank, start);
        }
        after == After::Noun && self.bare_thing(pattern)
            || self.trailing_view()
            || self.passive(pattern)
            || self.at_thing(pattern)
            || self.unsupported_predicate()
            || after == After::Verb && self.predicate_nominal(pattern)
    }

    fn superlative_predicate(&mut self, pattern: &mut Pattern, rank: u32, start: usize) -> bool {
        match self.superlative(rank, 1).or_else(|| self.side_pick(rank, 1)) {
            Some(pick) => self.put_pick(pattern, pick, start),
            None => {
                self.state.at = start;
                false
            }
        }
    }

    /// "is a child", "is a woman located to his right", "is the tallest person".
    fn predicate_nominal(&mut self, pattern: &mut Pattern) -> bool {
        if !self.roles().has_any(NOUN_START) || self.is(Role::Unknown) {
            return false;
        }
        if self.noun_located_by_his(pattern) {
            return true;
        }
        let (checkpoint, start) = (self.checkpoint(), self.state.at);
        let Some(group) = self.noun_group() else { return false };
        let (is, was) = (&group.pattern.category, &pattern.category);
        if is != was && *was != Category::Anything {
            self.rewind(checkpoint);
            return false;
        }
        if *was == Category::Anything {
            pattern.category = is.clone();
        }
        pattern.conditions.extend(group.pattern.conditions);
        match group.pattern.pick {
            Some(pick) => self.put_pick(pattern, pick, start),
            None => true,
        }
    }

    /// "not sitting", "isn't near the door or the wall".
    fn negated(&mut self, pattern: &mut Pattern) -> bool {
        let (checkpoint, start) = (self.checkpoint(), pattern.conditions.len());
        self.bump();
        self.skip_while(Roles::of(&[Role::Is, Role::Filler, Role::Either]));
        if !self.nested(|parser| parser.conditions(pattern)) {
            self.rewind(checkpoint);
            return false;
        }
        if pattern.conditions.len() == start {
            return true;
        }
        let mut parts = vec![all_of(split_from(&mut pattern.conditions, start))];
        while self.roles().has_any(Roles::of(&[Role::Or, Role::Neither]))
            && !self.is_noun_group_next()
        {
            let checkpoint = self.checkpoint();
            self.bump();
            if !self.nested(|parser| parser.conditions(pattern)) {
                self.rewind(checkpoint);
                break;
            }
            parts.push(all_of(split_from(&mut pattern.conditions, start)));
        }
        let inner = if parts.len() == 1 { all_of(parts) } else { any_of(parts) };
        pattern.conditions.push(Condition::Not(Box::new(inner)));
        true
    }

    /// "neither sitting nor standing".
    fn neither(&mut self, pattern: &mut Pattern) -> bool {
        let (checkpoint, start) = (self.checkpoint(), pattern.conditions.len());
        while self.eat(Role::Neither) || pattern.conditions.len() > start && self.eat(Role::Or) {
            let length = pattern.conditions.len();
            if !self.nested(|parser| parser.conditions(pattern)) {
                break;
            }
            if pattern.conditions.len() == length {
                break;
            }
            let inner = all_of(split_from(&mut pattern.conditions, length));
            pattern.conditions.push(Condition::Not(Box::new(inner)));
        }
        let found = pattern.conditions.len() > start;
        if !found {
            self.rewind(checkpoint);
        }
        found
    }

    /// "except those standing".
    pub(crate) fn except(&mut self, pattern: &mut Pattern) -> bool {
        let checkpoint = self.checkpoint();
        self.bump();
        self.resume_noun(self.state.head_noun);
        let category = pattern.category.clone();
        let partners = self.closed_list(pattern);
        if partners.is_empty() {
            self.rewind(checkpoint);
            return false;
        }
        for partner in partners {
            let condition = alternative(partner.pattern, &category);
            pattern.conditions.push(Condition::Not(Box::new(condition)));
        }
        true
    }

    /// "in the red shirt": skips and reports what no scene graph holds.
    fn unsupported_predicate(&mut self) -> bool {
        const LEAD: Roles = Roles::of(&[
            Role::At,
            Role::The,
            Role::A,
            Role::With,
            Role::Has,
            Role::My,
            Role::His,
            Role::To,
            Role::Located,
        ]);
        let next = self.next_not_in(self.state.at, LEAD);
        if !self.is_at(next, Role::Unsupported) {
            return false;
        }
        self.state.at = next;
        while self.eat_unsupported() {
            let and = self.is(Role::And) && self.is_at(self.state.at + 1, Role::Unsupported);
            self.state.at += usize::from(and);
        }
        if self.eat(Role::Relative) {
            self.eat(Role::To);
            self.robot();
        }
        true
    }

    /// "at the table", "on a chair": the relation "with".
    fn at_thing(&mut self, pattern: &mut Pattern) -> bool {
        let checkpoint = self.checkpoint();
        let is_named = self.eat(Role::At) && self.is_object_next();
        let partners = if is_named { self.partners_of(pattern) } else { Vec::new() };
        if partners.is_empty() {
            self.rewind(checkpoint);
            return false;
        }
        for partner in partners {
            push_related(pattern, vec![RelationKind::With], partner.pattern, partner.quantity);
        }
        true
    }

    fn is_object_next(&self) -> bool {
        let next = self.next_not_in(
            self.state.at,
            Roles::of(&[
                Role::The,
                Role::A,
                Role::His,
                Role::My,
                Role::Implies,
                Role::Sector,
                Role::Far,
                Role::All,
                Role::Superlative,
                Role::Number,
                Role::Unsupported,
            ]),
        );
        self.entry_at(next).category.as_ref().is_some_and(|c| *c != Category::Person)
    }

    /// "cane" of "old man cane": telegram style for "with a cane".
    fn bare_thing(&mut self, pattern: &mut Pattern) -> bool {
        let is_worn = self.roles().has_any(Roles::of(&[Role::Worn, Role::Garment, Role::Color]));
        if is_worn && pattern.category == Category::Person && self.bare_worn(pattern) {
            return true;
        }
        if !self.is_bare_thing_at(self.state.at) || pattern.category != Category::Person {
            return false;
        }
        let Some(group) = self.noun_group() else { return false };
        push_related(pattern, vec![RelationKind::With], group.pattern, Quantity::SOME);
        true
    }

    /// Whether a thing without an article is named at a position.
    pub(crate) fn is_bare_thing_at(&self, at: usize) -> bool {
        let category = self.entry_at(at).category.as_ref();
        let is_thing = matches!(category, Some(Category::Class(_)));
        let before = self.roles_at(at.wrapping_sub(1));
        let is_plural = self.is_at(at, Role::Plural) && !self.is_at(at, Role::Singular);
        is_thing
            && !is_plural
            && !before.has_any(Roles::of(&[Role::The, Role::A, Role::And, Role::Or]))
    }

    /// "whose age is young".
    pub(crate) fn whose(&mut self, pattern: &mut Pattern) -> bool {
        let checkpoint = self.checkpoint();
        self.bump();
        let is_property = self.eat(Role::Asks) && self.eat(Role::Is);
        let found = if is_property {
            self.predicate(pattern, After::Noun)
        } else {
            self.whose_clothes(pattern)
        };
        if found {
            return true;
        }
        self.rewind(checkpoint);
        let first = self.state.at + 1;
        let is_said = self.roles_at(first).has_any(VISIBLE) && self.is_at(first + 1, Role::Is);
        if is_said {
            let end = self.description_end(first + 2).max(first + 3).min(self.state.tokens.len());
            self.push_looks(pattern, first, end);
        }
        is_said
    }
}
