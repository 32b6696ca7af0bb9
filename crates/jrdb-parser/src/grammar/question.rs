//! Questions and requests: "find", "how many", "is there", "what is the man doing".

use std::rc::Rc;

use jrdb_types::issue::IssueKind;
use jrdb_types::query::{Category, Order, Property, Quantity, Task};
use jrdb_types::{Attribute, Condition, Pattern, Query};

use crate::grammar::discourse::Asked;

use crate::lexicon::{Role, Roles};
use crate::parser::{Parser, has_known_word};
use crate::pattern::{split_from, truncated_antecedent};
use crate::phrase::{NounGroup, Target};

/// What "describe" asks for.
const DESCRIPTION: [Property; 4] = [
    Property::Attribute(Attribute::Age),
    Property::Attribute(Attribute::Gender),
    Property::Attribute(Attribute::Race),
    Property::Attribute(Attribute::Action),
];

/// Words without meaning before a question.
const LEAD: Roles = Roles::of(&[Role::Filler, Role::Comma, Role::And, Role::Slash]);

/// Words between a question word and its noun.
pub(crate) const COPULA: Roles = Roles::of(&[Role::Is, Role::Filler, Role::Doing]);

/// The verb that a yes-or-no question begins with.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Verb {
    /// "is", "are there", "does".
    Be,
    /// "has the man a phone".
    Have,
}

impl Parser<'_> {
    /// Reads a question that follows another.
    pub(crate) fn question_after(mut self, before: &Query) -> Query {
        self.discourse = Some(Rc::new(truncated_antecedent(&before.target)));
        let asked =
            Asked { task: before.task.clone(), target: before.target.clone(), command: None };
        self.question_in(asked)
    }

    /// Reads the whole question.
    pub(crate) fn question(self) -> Query {
        self.question_in(Asked::default())
    }

    fn question_in(mut self, before: Asked) -> Query {
        let all = self.state.tokens;
        let Asked { task, mut target, command } = self.discourse(before);
        while !self.is_end() {
            self.report_unused();
        }
        let asks = task != Task::Find || target != Pattern::default();
        if !asks && !has_known_word(self.text) {
            self.report_not_understood();
        }
        let text = self.text.into();
        target.conditions.extend(self.unread(all));
        let (slots, issues) = self.finish();
        Query { text, task, target, command, slots, issues }
    }

    /// A question or a command.
    pub(crate) fn one_question(&mut self) -> Asked {
        self.skip_while(LEAD);
        self.view();
        self.addressed();
        if let Some(asked) = self.command() {
            return asked;
        }
        let (task, target) = self.question_form();
        Asked { task, target, command: None }
    }

    /// Any form of question: the task, and the pattern that it is about.
    pub(crate) fn question_form(&mut self) -> (Task, Pattern) {
        self.skip_while(LEAD);
        self.addressed();
        let is_tagged = self.drop_tag();
        if self.asked_color_at_hand() {
            return self.asked_color();
        }
        if self.eat_unsupported_property() {
            return (Task::Find, self.target().pattern);
        }
        let roles = self.roles();
        if roles.has_any(Roles::of(&[Role::Find, Role::Count, Role::Where, Role::Describe])) {
            return self.request();
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
            return self.yes_no_question();
        }
        if roles.has(Role::If) {
            return self.embedded_question();
        }
        if roles.has_any(Roles::of(&[Role::More, Role::Fewer])) {
            return self.compare_counts();
        }
        if roles.has(Role::Of) && !roles.has(Role::Sector) {
            return self.among();
        }
        if is_tagged || self.has_declared_share() {
            return self.yes_no_about(Verb::Be);
        }
        self.verbless_question()
    }

    /// "the name of", "the weight is": a property that no scene graph holds, with an issue.
    fn eat_unsupported_property(&mut self) -> bool {
        const LINKS: Roles = Roles::of(&[Role::Is, Role::Of]);
        let what = self.next_not_in(self.state.at, Roles::of(&[Role::The]));
        if !self.is_at(what, Role::Unsupported) || !self.roles_at(what + 1).has_any(LINKS) {
            return false;
        }
        self.state.at = what;
        self.report_unused();
        self.eat(Role::Of);
        self.skip_while(COPULA);
        true
    }

    /// "find", "how many", "where is", "describe".
    fn request(&mut self) -> (Task, Pattern) {
        let roles = self.roles();
        if roles.has(Role::Find) {
            return self.find();
        }
        self.bump();
        if roles.has(Role::Count) {
            self.skip_while(Roles::of(&[Role::Of]));
            let pattern = self.counted_target();
            let task = if self.counts_groups() { Task::Groups } else { Task::Count };
            return (task, pattern);
        }
        if roles.has(Role::Where) {
            self.skip_while(COPULA);
            self.skip_while(Roles::of(&[Role::Find, Role::Filler]));
            return (Task::Where, self.counted_target());
        }
        let properties = DESCRIPTION.into();
        (Task::Which { properties, in_order: false }, self.target().pattern)
    }

    fn counted_target(&mut self) -> Pattern {
        let target = self.target();
        self.report_count(&target);
        target.pattern
    }

    /// "how many couples": the groups are counted, and not the people in them.
    fn counts_groups(&self) -> bool {
        let is_group = |c: &Condition| matches!(c, Condition::GroupSize(_));
        self.state.head_noun.is_some_and(|noun| noun.implies.iter().any(is_group))
    }

    /// Skips "Robot, …", which addresses the robot.
    fn addressed(&mut self) {
        const NEXT: Roles = Roles::of(&[
            Role::Comma,
            Role::Find,
            Role::Which,
            Role::Count,
            Role::Filler,
            Role::Command,
            Role::Where,
            Role::How,
        ]);
        if self.is(Role::Robot) && self.roles_at(self.state.at + 1).has_any(NEXT) {
            self.bump();
            self.skip_while(LEAD);
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
        self.bump();
        self.skip_while(Roles::of(&[Role::Filler, Role::To, Role::Comma]));
        let roles = self.roles();
        let asks = roles.has_any(Roles::of(&[Role::Is, Role::Doing, Role::Has]));
        let is_asked = asks && self.is_at(self.state.at - 1, Role::Comma);
        if is_asked || roles.has_any(OPENERS) && !roles.has(Role::The) {
            return self.nested(Self::question_form);
        }
        if self.eat_unsupported_property() {
            return (Task::Find, self.target().pattern);
        }
        if roles.has(Role::Asks)
            || roles.has(Role::The) && self.is_at(self.state.at + 1, Role::Asks)
        {
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

    /// Reports a number that has no effect, because every match is returned.
    pub(crate) fn report_count(&mut self, target: &Target) {
        let count = target.count.filter(|(count, _)| *count > 1);
        if let (Some((count, at)), None) = (count, &target.pattern.pick) {
            let message = format!("all that match are found, not only {count}");
            self.report(IssueKind::Ambiguous, at, at + 1, message);
        }
    }

    /// "of the people near the door, who is the tallest?"
    fn among(&mut self) -> (Task, Pattern) {
        let checkpoint = self.checkpoint();
        self.bump();
        let all = self.noun_group().map(|group| self.with_modifiers(group.pattern, group.count));
        self.eat(Role::Comma);
        let (Some(all), false) = (all, self.is_end()) else {
            self.rewind(checkpoint);
            return self.verbless_question();
        };
        let (task, mut target) = self.nested(Self::question_form);
        let fits = matches!(target.category, Category::Person | Category::Anything);
        target.category = if fits { all.category } else { target.category };
        target.conditions.splice(0..0, all.conditions);
        (task, target)
    }

    /// A question without a question word: "the man near the table", "exactly three people
    /// sitting".
    fn verbless_question(&mut self) -> (Task, Pattern) {
        let target = self.target();
        match target.quantity {
            Some(quantity) => (Task::Exists(quantity), target.pattern),
            None => {
                self.report_count(&target);
                (Task::Find, target.pattern)
            }
        }
    }

    /// "is there a man", "are there more men than women", "is the man sitting".
    fn yes_no_question(&mut self) -> (Task, Pattern) {
        let verb = if self.is(Role::Has) { Verb::Have } else { Verb::Be };
        self.bump();
        self.skip_while(Roles::of(&[Role::Filler, Role::Doing]));
        if self.roles().has_any(Roles::of(&[Role::More, Role::Fewer])) {
            return self.compare_counts();
        }
        self.yes_no_about(verb)
    }

    /// "if anyone is sitting": a yes-or-no question inside another sentence.
    fn embedded_question(&mut self) -> (Task, Pattern) {
        self.bump();
        self.skip_while(LEAD);
        if self.roles().has_any(Roles::of(&[Role::Is, Role::Exists, Role::Doing])) {
            return self.yes_no_question();
        }
        self.yes_no_about(Verb::Be)
    }

    /// The subject of a yes-or-no question, and what is asked of it.
    fn yes_no_about(&mut self, verb: Verb) -> (Task, Pattern) {
        self.state.asks_several = true;
        if let Some(asked) = self.cleft() {
            return asked;
        }
        if let Some(asked) = self.garment_question() {
            return asked;
        }
        let start = self.state.at;
        let is_definite = self.is_definite();
        let mut group = self.target_noun_group();
        if verb == Verb::Have && self.is(Role::A) {
            self.possessed(&mut group.pattern);
        }
        let has_predicate =
            is_definite || group.is_all || group.share.is_some() || group.pattern.pick.is_some();
        let mut target =
            if has_predicate { self.predicate_of(group) } else { self.finish_target(group) };
        if let Some(asked) = self.asked_apart(&mut target) {
            return asked;
        }
        let has_asked = target.pattern.conditions.len() > target.head;
        if let Some(share) = target.share.filter(|_| has_asked) {
            let asked = split_from(&mut target.pattern.conditions, target.head);
            return (Task::Each { share, asked }, target.pattern);
        }
        let may_choose = is_definite && has_asked && self.state.subjects.is_none();
        if may_choose && let Some(task) = self.choice_of(&mut target, start) {
            return (task, target.pattern);
        }
        let count = target.count.map(|(count, _)| count).or(self.state.subjects);
        let quantity = target.quantity.or(count.map(Quantity::at_least));
        (Task::Exists(quantity.unwrap_or_default()), target.pattern)
    }

    /// "more men than women near the door": a clause behind the last noun describes both.
    fn compare_counts(&mut self) -> (Task, Pattern) {
        let order = if self.is(Role::More) { Order::Most } else { Order::Least };
        let start = self.state.at;
        self.bump();
        let group = self.target_noun_group();
        let noun = group.pattern.clone();
        let mut first = self.finish_target(group);
        if !self.eat(Role::Than) {
            let message = "more than what is not said, not used".into();
            self.report_unread(IssueKind::MisplacedWord, start, start + 1, message);
            return (Task::Exists(Quantity::SOME), first.pattern);
        }
        self.skip_while(Roles::of(&[Role::Filler, Role::Is]));
        let second = self.noun_group().map_or(noun, |group| group.pattern);
        let head = second.conditions.len();
        let second = self.finish_target(NounGroup { pattern: second, ..NounGroup::default() });
        if first.pattern.conditions.len() == first.head && second.head == head {
            let shared = second.pattern.conditions.get(head..).unwrap_or_default().to_vec();
            first.pattern.conditions.extend(shared);
        }
        let than = Box::new(second.pattern);
        (Task::CompareCounts { order, than }, first.pattern)
    }
}
