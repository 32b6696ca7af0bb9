//! One thing said of a subject: "not sitting near the table", "except those standing", "is a woman".

use jrdb_types::query::{Category, RelationKind};
use jrdb_types::{Condition, Pattern};

use crate::grammar::clothes::CLOTHES_START;
use crate::grammar::noun::NOUN_START;
use crate::grammar::place::SPOT_START;
use crate::lexicon::{Role, Roles};
use crate::parser::Parser;
use crate::pattern::{all_of, alternative, any_of, push_related, split_from};
use crate::phrase::Behind;

impl Parser<'_> {
    /// Predicates that stand together without a joint: "sitting near the table".
    pub(crate) fn together(&mut self, pattern: &mut Pattern) -> bool {
        if !self.predicate(pattern, Behind::Verb) {
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
            Role::Lacks,
            Role::Except,
        ]);
        while !self.is_end()
            && !self.roles().has_any(JOINTS)
            && self.predicate(pattern, Behind::Noun)
        {}
        true
    }

    /// One thing said of the subject.
    pub(crate) fn predicate(&mut self, pattern: &mut Pattern, behind: Behind) -> bool {
        let roles = self.roles();
        if roles.has(Role::Not) {
            return self.negated(pattern);
        }
        if roles.has_any(CLOTHES_START) && self.clothes(pattern) {
            return true;
        }
        if roles.has_any(Roles::of(&[Role::Action, Role::Deed])) {
            return self.deed(pattern);
        }
        if roles.has(Role::Noun) && behind == Behind::Verb && self.nominal(pattern) {
            return true;
        }
        if roles.has(Role::Says) {
            return self.adjective_predicate(pattern);
        }
        if roles.has_any(SPOT_START) && !roles.has(Role::Noun) && self.placed(pattern, behind) {
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
        self.rare_predicate(pattern, behind)
    }

    fn rare_predicate(&mut self, pattern: &mut Pattern, behind: Behind) -> bool {
        let (roles, start) = (self.roles(), self.at);
        if roles.has(Role::Neither) {
            return self.neither(pattern);
        }
        if roles.has(Role::Either) {
            self.skip(Roles::of(&[Role::Either]));
            return self.predicate(pattern, behind) || {
                self.at = start;
                false
            };
        }
        if roles.has(Role::Except) {
            return self.except(pattern);
        }
        if roles.has(Role::Doing) {
            self.at += 1;
            self.asks_doing = true;
            return true;
        }
        let is_the = roles.has(Role::The) && self.is_at(start + 1, Role::Superlative);
        if roles.has(Role::Superlative) || is_the {
            self.at += usize::from(is_the);
            return self.chosen_predicate(pattern, 1, start);
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
            self.at += length;
            return self.chosen_predicate(pattern, rank, start);
        }
        self.at_thing(pattern) || self.lacking() || behind == Behind::Verb && self.nominal(pattern)
    }

    fn chosen_predicate(&mut self, pattern: &mut Pattern, rank: u32, start: usize) -> bool {
        match self.superlative(rank, 1).or_else(|| self.side_pick(rank, 1)) {
            Some(pick) => self.put_pick(pattern, pick, start),
            None => {
                self.at = start;
                false
            }
        }
    }

    /// "is a child", "is a woman located to his right", "is the tallest person".
    fn nominal(&mut self, pattern: &mut Pattern) -> bool {
        if !self.roles().has_any(NOUN_START) || self.is(Role::Unknown) {
            return false;
        }
        if self.other_at_his(pattern) {
            return true;
        }
        let (mark, start) = (self.mark(), self.at);
        let Some(thing) = self.thing() else { return false };
        let (is, was) = (&thing.pattern.category, &pattern.category);
        if is != was && *was != Category::Anything {
            self.reset(mark);
            return false;
        }
        if *was == Category::Anything {
            pattern.category = is.clone();
        }
        pattern.conditions.extend(thing.pattern.conditions);
        match thing.pattern.pick {
            Some(pick) => self.put_pick(pattern, pick, start),
            None => true,
        }
    }

    /// "not sitting", "isn't near the door or the wall".
    fn negated(&mut self, pattern: &mut Pattern) -> bool {
        let (mark, start) = (self.mark(), pattern.conditions.len());
        self.at += 1;
        self.skip(Roles::of(&[Role::Is, Role::Filler, Role::Either]));
        if !self.deeper(|parser| parser.together(pattern)) {
            self.reset(mark);
            return false;
        }
        if pattern.conditions.len() == start {
            return true;
        }
        let mut parts = vec![all_of(split_from(&mut pattern.conditions, start))];
        while self.roles().has_any(Roles::of(&[Role::Or, Role::Neither])) && !self.is_thing_next() {
            let mark = self.mark();
            self.at += 1;
            if !self.deeper(|parser| parser.together(pattern)) {
                self.reset(mark);
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
        let (mark, start) = (self.mark(), pattern.conditions.len());
        while self.take(Role::Neither) || pattern.conditions.len() > start && self.take(Role::Or) {
            let length = pattern.conditions.len();
            if !self.deeper(|parser| parser.together(pattern)) {
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
            self.reset(mark);
        }
        found
    }

    /// "except those standing".
    pub(crate) fn except(&mut self, pattern: &mut Pattern) -> bool {
        let mark = self.mark();
        self.at += 1;
        let category = pattern.category.clone();
        let partners = self.partners_of(pattern);
        if partners.is_empty() {
            self.reset(mark);
            return false;
        }
        for partner in partners {
            let condition = alternative(partner.pattern, &category);
            pattern.conditions.push(Condition::Not(Box::new(condition)));
        }
        true
    }

    /// "in the red shirt": what no scene graph holds, with an issue.
    fn lacking(&mut self) -> bool {
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
        let next = self.after(self.at, LEAD);
        if !self.is_at(next, Role::Lacks) {
            return false;
        }
        self.at = next;
        while self.lacks() {
            let and = self.is(Role::And) && self.is_at(self.at + 1, Role::Lacks);
            self.at += usize::from(and);
        }
        if self.take(Role::Relative) {
            self.take(Role::To);
            self.robot();
        }
        true
    }

    /// "at the table", "on a chair": has to do with it.
    fn at_thing(&mut self, pattern: &mut Pattern) -> bool {
        let mark = self.mark();
        let is_named = self.take(Role::At) && self.is_object_next();
        let partners = if is_named { self.partners_of(pattern) } else { Vec::new() };
        if partners.is_empty() {
            self.reset(mark);
            return false;
        }
        for partner in partners {
            push_related(pattern, vec![RelationKind::With], partner.pattern, partner.quantity);
        }
        true
    }

    fn is_object_next(&self) -> bool {
        let next = self.after(
            self.at,
            Roles::of(&[
                Role::The,
                Role::A,
                Role::His,
                Role::My,
                Role::Says,
                Role::Sector,
                Role::Far,
                Role::All,
                Role::Superlative,
                Role::Number,
                Role::Lacks,
            ]),
        );
        self.entry_at(next).category.as_ref().is_some_and(|c| *c != Category::Person)
    }

    /// "whose age is young".
    pub(crate) fn whose(&mut self, pattern: &mut Pattern) -> bool {
        let mark = self.mark();
        self.at += 1;
        let is_property = self.take(Role::Asks) && self.take(Role::Is);
        let found = if is_property {
            self.predicate(pattern, Behind::Noun)
        } else {
            self.whose_clothes(pattern)
        };
        if !found {
            self.reset(mark);
        }
        found
    }
}
