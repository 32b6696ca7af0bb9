//! What is asked: "find", "how many", "is there", "what is the man doing".

use jrdb_types::issue::IssueKind;
use jrdb_types::query::{Category, Order, Property, Quantity, Task};
use jrdb_types::{Attribute, Condition, Issue, Pattern, Query};

use crate::clause::Scope;
use crate::coordination::{either, remembered, set_count};
use crate::joined::{all_of, split_from};
use crate::lexicon::{Role, Roles};
use crate::noun::Thing;
use crate::parser::Parser;
use crate::shared::Part;

/// What "describe" tells.
const DESCRIPTION: [Property; 4] = [
    Property::Attribute(Attribute::Age),
    Property::Attribute(Attribute::Gender),
    Property::Attribute(Attribute::Race),
    Property::Attribute(Attribute::Action),
];

/// Words before a question that say nothing.
const LEAD: Roles = Roles::of(&[Role::Filler, Role::Comma, Role::And, Role::Slash]);

/// Words between a question word and its thing.
pub(crate) const COPULA: Roles = Roles::of(&[Role::Is, Role::Filler, Role::Doing]);

/// Words between things that are asked for together.
const JOINTS: Roles = Roles::of(&[Role::And, Role::Or, Role::Comma]);

/// What "all" without a noun may stand before.
const EXCEPT: Roles = Roles::of(&[Role::Except, Role::But]);

/// The thing asked for, and what was said of its number.
#[derive(Clone, Default)]
pub(crate) struct Target {
    pub(crate) pattern: Pattern,
    pub(crate) quantity: Option<Quantity>,
    pub(crate) count: Option<(u32, usize)>,
    pub(crate) is_all: bool,
    /// How many conditions the noun phrase has.
    pub(crate) head: usize,
}

impl Parser<'_> {
    /// Reads the whole question.
    pub(crate) fn question(mut self) -> Query {
        let (task, target) = self.asked();
        while !self.is_end() {
            self.report_unused();
        }
        if self.tokens.is_empty() {
            let issue = Issue::new(IssueKind::UnknownWord, "the question has no words");
            self.issues.push(issue);
        }
        if let Some(at) = self.too_deep.filter(|at| *at < self.tokens.len()) {
            let message =
                "too many things inside each other; the rest is read apart from them".into();
            self.report(IssueKind::Ambiguous, at, at + 1, message);
        }
        self.suggest();
        self.issues.sort_by_key(|issue| issue.span);
        Query { text: self.text.into(), task, target, slots: self.slots, issues: self.issues }
    }

    pub(crate) fn asked(&mut self) -> (Task, Pattern) {
        self.skip(LEAD);
        self.addressed();
        let roles = self.roles();
        let what = self.after(self.at, Roles::of(&[Role::The]));
        let links = Roles::of(&[Role::Is, Role::Of]);
        if self.is_at(what, Role::Lacks) && self.roles_at(what + 1).has_any(links) {
            self.at = what;
            self.report_unused();
            self.take(Role::Of);
            self.skip(COPULA);
            return (Task::Find, self.target().pattern);
        }
        if roles.has(Role::Find) {
            return self.find();
        }
        if roles.has(Role::Count) {
            self.at += 1;
            self.skip(Roles::of(&[Role::Of]));
            let target = self.target();
            self.report_count(&target);
            return (Task::Count, target.pattern);
        }
        if roles.has(Role::Where) {
            self.at += 1;
            self.skip(COPULA);
            self.skip(Roles::of(&[Role::Find, Role::Filler]));
            let target = self.target();
            self.report_count(&target);
            return (Task::Where, target.pattern);
        }
        if roles.has(Role::Describe) {
            self.at += 1;
            let properties = DESCRIPTION.into();
            return (Task::Which { properties, in_order: false }, self.target().pattern);
        }
        if roles.has(Role::How) && self.entry().asks.is_some() {
            return self.how();
        }
        if roles.has(Role::Which) {
            return self.which();
        }
        if roles.has(Role::Who) && !roles.has(Role::The) {
            return self.who();
        }
        if roles.has(Role::Asks) {
            return self.properties();
        }
        if roles.has_any(Roles::of(&[Role::Is, Role::Exists, Role::Doing, Role::Has])) {
            return self.exists();
        }
        if roles.has(Role::If) {
            return self.whether();
        }
        if roles.has_any(Roles::of(&[Role::More, Role::Fewer])) {
            return self.compare_counts();
        }
        if roles.has(Role::Of) && !roles.has(Role::Sector) {
            return self.among();
        }
        self.named()
    }

    /// "Robot, ..." speaks to the robot, not of it.
    fn addressed(&mut self) {
        const NEXT: Roles = Roles::of(&[Role::Comma, Role::Find, Role::Which, Role::Count]);
        if self.is(Role::Robot) && self.roles_at(self.at + 1).has_any(NEXT) {
            self.at += 1;
            self.skip(LEAD);
        }
    }

    fn find(&mut self) -> (Task, Pattern) {
        const OPENERS: Roles = Roles::of(&[
            Role::Where,
            Role::Which,
            Role::How,
            Role::Count,
            Role::Who,
            Role::Exists,
            Role::Find,
            Role::Describe,
            Role::If,
        ]);
        self.at += 1;
        self.skip(Roles::of(&[Role::Filler, Role::To]));
        let roles = self.roles();
        if roles.has_any(OPENERS) && !roles.has(Role::The) {
            return self.deeper(Self::asked);
        }
        if roles.has(Role::Asks) || roles.has(Role::The) && self.is_at(self.at + 1, Role::Asks) {
            return self.properties();
        }
        let target = self.target();
        self.report_count(&target);
        if target.quantity.is_some() {
            let message = "all that match are found, whatever their number".into();
            self.report(IssueKind::Ambiguous, 0, 1, message);
        }
        (Task::Find, target.pattern)
    }

    /// A number that asks for nothing: all are found.
    pub(crate) fn report_count(&mut self, target: &Target) {
        let count = target.count.filter(|(count, _)| *count > 1);
        if let (Some((count, at)), None) = (count, &target.pattern.pick) {
            let message = format!("all that match are found, not only {count}");
            self.report(IssueKind::Ambiguous, at, at + 1, message);
        }
    }

    /// "of the people near the door, who is the tallest?"
    fn among(&mut self) -> (Task, Pattern) {
        let mark = self.mark();
        self.at += 1;
        let all = self.thing().map(|thing| self.with_modifiers(thing.pattern, thing.count));
        self.take(Role::Comma);
        let (Some(all), false) = (all, self.is_end()) else {
            self.reset(mark);
            return self.named();
        };
        let (task, mut target) = self.deeper(Self::asked);
        let fits = matches!(target.category, Category::Person | Category::Anything);
        target.category = if fits { all.category } else { target.category };
        target.conditions.splice(0..0, all.conditions);
        (task, target)
    }

    /// A question without a question word: "the man near the table", "exactly three people sitting".
    fn named(&mut self) -> (Task, Pattern) {
        let target = self.target();
        match target.quantity {
            Some(quantity) => (Task::Exists(quantity), target.pattern),
            None => {
                self.report_count(&target);
                (Task::Find, target.pattern)
            }
        }
    }

    /// The thing asked for with all that is said of it.
    pub(crate) fn target(&mut self) -> Target {
        let first = self.target_thing();
        self.finish(first)
    }

    pub(crate) fn target_thing(&mut self) -> Thing {
        self.skip(Roles::of(&[Role::Either, Role::Filler]));
        let mut thing = Thing::default();
        if self.read_thing(&mut thing) {
            return thing;
        }
        if self.is(Role::Him) {
            let pattern = self.pronoun().unwrap_or_default();
            return Thing { pattern, ..Thing::default() };
        }
        if self.is(Role::All) && self.roles_at(self.at + 1).has_any(EXCEPT) {
            self.at += 1;
            return Thing::default();
        }
        let next = self.after(self.at, Roles::of(&[Role::The, Role::A]));
        if next > self.at && self.is_at(next, Role::Unknown) {
            self.at = next;
            self.report_stranger();
            let pattern = Pattern::of(Category::Anything);
            return Thing { pattern, ..Thing::default() };
        }
        Thing::default()
    }

    /// Reads what is said behind the noun, and alternatives: "the man or the woman next to him".
    pub(crate) fn finish(&mut self, thing: Thing) -> Target {
        let mut pattern = thing.pattern;
        let (start, told) = (thing.start, self.at);
        let head = self.clauses(&mut pattern, Scope::Top);
        if self.is_timed {
            self.close_slot(&mut pattern, head);
        }
        set_count(&mut pattern, thing.count);
        if self.is(Role::Comma) && pattern.pick.is_some() {
            self.choice(&mut pattern);
        }
        let pattern = if self.roles().has_any(JOINTS) && self.is_thing_next() {
            self.others(Part { pattern, head, start, told, is_joined: true })
        } else {
            pattern
        };
        let Thing { quantity, count, is_all, .. } = thing;
        Target { pattern, quantity, count, is_all, head }
    }

    /// Reads the others of "the man, the woman and the child".
    fn others(&mut self, first: Part) -> Pattern {
        let (start, mut is_list) = (self.at, true);
        let mut parts = vec![first];
        while self.roles().has_any(JOINTS) && self.is_thing_next() {
            let is_joined = !self.is(Role::Or);
            is_list &= self.is(Role::Comma) && !self.roles_at(self.at + 1).has_any(JOINTS);
            self.at += 1;
            if self.has_pronouns {
                self.spoken = parts.last().map(|part| remembered(&part.pattern));
            }
            let start = self.at;
            let Some(Thing { mut pattern, count, .. }) = self.thing() else { break };
            let (head, told) = (pattern.conditions.len(), self.at);
            self.clauses(&mut pattern, Scope::Top);
            set_count(&mut pattern, count);
            parts.push(Part { pattern, head, start, told, is_joined });
        }
        if is_list {
            let message = "read as a list of things, each of which is meant".into();
            self.report(IssueKind::Ambiguous, start, self.at, message);
        }
        self.one_of(parts)
    }

    /// ", the man or the woman" behind "which person is taller": from whom is chosen.
    pub(crate) fn choice(&mut self, pattern: &mut Pattern) {
        let mut things = Vec::new();
        while self.roles().has_any(JOINTS) && self.is_thing_next() {
            self.at += 1;
            let Some(thing) = self.thing() else { break };
            things.push(self.with_modifiers(thing.pattern, thing.count));
        }
        let choice = either(things);
        pattern.category = choice.category;
        pattern.conditions.extend(choice.conditions);
    }

    /// "is there a man", "are there more men than women", "is the man sitting".
    fn exists(&mut self) -> (Task, Pattern) {
        let is_has = self.is(Role::Has);
        self.at += 1;
        self.skip(Roles::of(&[Role::Filler, Role::Doing]));
        if self.roles().has_any(Roles::of(&[Role::More, Role::Fewer])) {
            return self.compare_counts();
        }
        let is_definite = self.is(Role::The);
        self.exist(is_definite, is_has)
    }

    /// "if anyone is sitting".
    fn whether(&mut self) -> (Task, Pattern) {
        self.at += 1;
        self.skip(LEAD);
        if self.roles().has_any(Roles::of(&[Role::Is, Role::Exists, Role::Doing])) {
            return self.exists();
        }
        let is_definite = self.is(Role::The);
        self.exist(is_definite, false)
    }

    fn exist(&mut self, is_definite: bool, is_has: bool) -> (Task, Pattern) {
        self.asks_several = true;
        let mut thing = self.target_thing();
        if is_has && self.is(Role::A) {
            self.possessed(&mut thing.pattern);
        }
        let is_told = is_definite || thing.is_all || thing.pattern.pick.is_some();
        let mut target = if is_told { self.told_of(thing) } else { self.finish(thing) };
        let subjects = self.subjects.and_then(|count| u32::try_from(count).ok());
        let counted = target.count.map(|(count, _)| count).or(subjects).map(Quantity::at_least);
        let quantity = target.quantity.or(counted).unwrap_or_default();
        if target.is_all && target.pattern.conditions.len() > target.head {
            // All of them are, when none of them is not.
            let told = all_of(split_from(&mut target.pattern.conditions, target.head));
            target.pattern.conditions.push(Condition::Not(Box::new(told)));
            return (Task::Exists(Quantity::NONE), target.pattern);
        }
        (Task::Exists(quantity), target.pattern)
    }

    /// "more men than women near the door": what is said last is said of both.
    fn compare_counts(&mut self) -> (Task, Pattern) {
        let order = if self.is(Role::More) { Order::Most } else { Order::Least };
        let start = self.at;
        self.at += 1;
        let thing = self.target_thing();
        let noun = thing.pattern.clone();
        let mut first = self.finish(thing);
        if !self.take(Role::Than) {
            let message = "more than what is not said, not used".into();
            self.report(IssueKind::MisplacedWord, start, start + 1, message);
            return (Task::Exists(Quantity::SOME), first.pattern);
        }
        self.skip(Roles::of(&[Role::Filler, Role::Is]));
        let second = self.thing().map_or(noun, |thing| thing.pattern);
        let head = second.conditions.len();
        let second = self.finish(Thing { pattern: second, ..Thing::default() });
        if first.pattern.conditions.len() == first.head && second.head == head {
            let told = second.pattern.conditions.get(head..).unwrap_or_default().to_vec();
            first.pattern.conditions.extend(told);
        }
        let than = Box::new(second.pattern);
        (Task::CompareCounts { order, than }, first.pattern)
    }
}
