//! What is said of a thing behind its noun: "who is sitting or standing near the table and not facing me".

use jrdb_types::Pattern;
use jrdb_types::issue::IssueKind;
use jrdb_types::query::{Category, RelationKind};
use jrdb_types::vocab::PairWord;

use crate::lexicon::{Entry, Role, Roles};
use crate::parser::Parser;
use crate::pattern::{all_of, any_of, excludes, identify, split_from};
use crate::phrase::{Behind, Scope};

/// Where the reader of clauses stands.
struct Course {
    scope: Scope,
    /// First condition of the thing asked for that slots may take.
    head: usize,
    /// First condition of what "or" is an alternative to.
    group: usize,
    /// First condition of a list of single words: "sitting, standing or …".
    run: Option<usize>,
    /// A comma was read since the last predicate.
    is_listed: bool,
    /// "and" was read since the last predicate.
    is_joined: bool,
    /// An alternative was read since the last predicate: the next one stands beside all of them.
    is_alternative: bool,
    /// "who" or "is" was read.
    is_clause: bool,
    predicates: usize,
    /// The noun of the thing.
    noun: Option<&'static Entry>,
}

/// Words that say nothing between predicates.
const GLUE: Roles = Roles::of(&[Role::Filler, Role::Slash, Role::Exists]);

/// What may begin a clause about what somebody else does.
const OTHERS: Roles =
    Roles::of(&[Role::The, Role::A, Role::Number, Role::Who, Role::Is, Role::Doing]);

/// What ends the things said of any thing.
const ENDS: Roles = Roles::of(&[Role::Than, Role::Order]);

impl Parser<'_> {
    /// Reads what is said of a thing into its conditions; returns how many of them are not said in the clauses.
    pub(crate) fn clauses(&mut self, pattern: &mut Pattern, scope: Scope) -> usize {
        let head = pattern.conditions.len();
        let mut course = Course {
            scope,
            head,
            group: head,
            run: None,
            is_listed: false,
            is_joined: false,
            is_alternative: false,
            is_clause: false,
            predicates: 0,
            noun: self.last_noun,
        };
        while !self.is_end() && self.step(pattern, &mut course) {}
        course.head
    }

    /// One predicate or joint; false when what is at hand belongs to somebody else.
    fn step(&mut self, pattern: &mut Pattern, course: &mut Course) -> bool {
        const JOINTS: Roles = Roles::of(&[
            Role::Comma,
            Role::And,
            Role::Or,
            Role::Who,
            Role::Whose,
            Role::Is,
            Role::Then,
            Role::During,
            Role::Than,
            Role::Order,
            Role::Has,
        ]);
        let roles = self.roles();
        let is_first = course.predicates == 0 && !course.is_clause;
        if is_first && roles.has_any(OTHERS) && self.done_by_another(pattern) {
            course.predicates += 1;
            return true;
        }
        if roles.has_any(JOINTS)
            && let Some(goes_on) = self.joint(pattern, course)
        {
            return goes_on;
        }
        let (before, start) = (pattern.conditions.len(), self.at);
        let is_word = roles.has(Role::Says);
        let behind = match (course.is_clause, course.scope) {
            (true, _) => Behind::Verb,
            (false, Scope::Reduced) => Behind::Partner,
            (false, _) => Behind::Noun,
        };
        if behind == Behind::Partner && self.is_said_of_subject(pattern) {
            return false;
        }
        if self.predicate(pattern, behind) {
            course.predicates += 1;
            if std::mem::take(&mut course.is_alternative) {
                course.group = before;
            }
            if std::mem::take(&mut course.is_joined) {
                self.part_exclusive(pattern, before, start);
            }
            let is_single = is_word && pattern.conditions.len() == before + 1;
            course.run = match course.run.filter(|_| course.is_listed && is_single) {
                None => is_single.then_some(before),
                run => run,
            };
            course.is_listed = false;
            return true;
        }
        if roles.has_any(GLUE) || course.scope == Scope::Top && roles.has(Role::Located) {
            self.at += 1;
            return true;
        }
        if course.scope == Scope::Top {
            self.report_unused();
            return true;
        }
        false
    }

    /// Steps over a joint; none when the word at hand is none after all.
    fn joint(&mut self, pattern: &mut Pattern, course: &mut Course) -> Option<bool> {
        let (roles, is_top) = (self.roles(), course.scope == Scope::Top);
        if roles.has_any(ENDS) {
            return Some(false);
        }
        if (roles.has_any(Roles::of(&[Role::Comma, Role::And, Role::Then]))) && self.is_then() {
            if is_top {
                self.then(pattern, course.head);
                (course.group, course.run) = (course.head, None);
            }
            return Some(is_top);
        }
        if roles.has(Role::During) {
            return (!is_top || self.during()).then_some(is_top);
        }
        if roles.has(Role::Comma) {
            // "men, women and children"; "which is taller, the man or the woman".
            let is_list = is_top && (!course.is_clause || pattern.pick.is_some());
            if is_list && self.is_thing_next() && !self.is_next_told_of_him() {
                return Some(false);
            }
            let goes_on =
                is_top || course.scope == Scope::Relative && self.is_list_of_words(course);
            if goes_on {
                (course.is_listed, course.group) = (true, pattern.conditions.len());
                self.at += 1;
            }
            return Some(goes_on);
        }
        if roles.has(Role::And) {
            return Some(self.and(pattern, course));
        }
        if roles.has(Role::Or) {
            return Some(self.or(pattern, course));
        }
        if roles.has(Role::Whose) {
            return Some(
                self.whose(pattern)
                    || is_top && {
                        self.report_unused();
                        true
                    },
            );
        }
        self.copula(pattern, course)
    }

    /// Whether what is at hand is said of the thing that this one is a partner of.
    fn is_said_of_subject(&self, pattern: &Pattern) -> bool {
        self.is_told_of_him(self.at)
            || self.is_walk && self.is(Role::Towards)
            || self.is_said_of_people_only(pattern)
    }

    /// Whether what is at hand cannot be said of the partner, which is no person: "the man at the table holding a bag".
    fn is_said_of_people_only(&self, pattern: &Pattern) -> bool {
        const OF_PEOPLE: Roles = Roles::of(&[
            Role::Action,
            Role::Deed,
            Role::Says,
            Role::Not,
            Role::Group,
            Role::With,
            Role::Without,
            Role::Comparative,
            Role::Doing,
        ]);
        let is_other = !matches!(pattern.category, Category::Person | Category::Anything);
        let is_pair = matches!(
            self.entry().relation,
            None | Some(RelationKind::Pair(PairWord::Adjacent | PairWord::Overlapping))
        );
        self.roles().has_any(Roles::of(&[Role::Neither, Role::Except]))
            || is_other && (self.roles().has_any(OF_PEOPLE) || !is_pair)
    }

    fn is_list_of_words(&self, course: &Course) -> bool {
        course.run.is_some() && self.is_at(self.at + 1, Role::Says)
    }

    /// "who", "is", "has".
    fn copula(&mut self, pattern: &mut Pattern, course: &mut Course) -> Option<bool> {
        let roles = self.roles();
        let is_who = roles.has(Role::Who);
        if course.scope == Scope::Reduced && (!is_who || self.is_who_of_another(pattern, course)) {
            return Some(false);
        }
        let is_asked = roles.has(Role::Is)
            && !(is_who || course.is_clause || self.at + 1 == self.tokens.len());
        if is_asked && course.scope == Scope::Top && pattern.pick.is_some() {
            // "which of the two tallest is sitting": the two tallest of all, not of those who sit.
            identify(pattern);
            course.head = pattern.conditions.len();
        }
        if course.scope == Scope::Relative && course.predicates > 0 && !course.is_listed {
            return Some(false);
        }
        if roles.has(Role::Has) && !roles.has(Role::Is) {
            course.is_clause = true;
            return None;
        }
        if course.scope == Scope::Reduced {
            course.scope = Scope::Relative;
        }
        (course.is_clause, course.group) = (true, pattern.conditions.len());
        if roles.has(Role::Not) {
            return None;
        }
        self.at += 1;
        Some(true)
    }

    /// "who" behind a table is said of somebody else, and so is "who are" behind a woman.
    fn is_who_of_another(&self, pattern: &Pattern, course: &Course) -> bool {
        let roles = self.roles();
        let is_personal = !roles.has_any(Roles::of(&[Role::Which, Role::The]));
        let is_which = roles.has(Role::Which) && !roles.has(Role::The);
        let is_person = pattern.category == Category::Person;
        let agrees = course.noun.is_none_or(|noun| agree(noun.roles, self.roles_at(self.at + 1)));
        is_personal && !is_person || is_which && is_person || !agrees
    }

    fn and(&mut self, pattern: &mut Pattern, course: &mut Course) -> bool {
        let begins_anew = self.is_at(self.at + 1, Role::Who) && course.scope != Scope::Top;
        if course.scope == Scope::Reduced || begins_anew {
            return false;
        }
        if self.is(Role::But) && self.is_thing_next() {
            return self.except(pattern);
        }
        if self.is_thing_next() && !(course.is_clause && self.is_next_told_of_him()) {
            return false;
        }
        let mark = self.mark();
        self.at += 1;
        (course.group, course.is_listed) = (pattern.conditions.len(), course.run.is_some());
        course.is_joined = true;
        if course.scope == Scope::Relative {
            self.skip(Roles::of(&[Role::Is, Role::Filler]));
            if !self.predicate(pattern, Behind::Verb) {
                self.reset(mark);
                return false;
            }
            course.run = None;
        }
        true
    }

    fn or(&mut self, pattern: &mut Pattern, course: &mut Course) -> bool {
        let length = pattern.conditions.len();
        let is_word = self.is_at(self.at + 1, Role::Says) && !self.is_at(self.at + 1, Role::Noun);
        if let Some(run) = course.run.filter(|_| is_word) {
            self.at += 1;
            self.word_alternative(pattern);
            let parts = split_from(&mut pattern.conditions, run);
            pattern.conditions.push(any_of(parts));
            return true;
        }
        if course.scope == Scope::Reduced || self.is_thing_next() || length == course.group {
            let is_lost = course.scope == Scope::Top && !self.is_thing_next();
            if is_lost {
                self.report_unused();
            }
            return is_lost;
        }
        let mark = self.mark();
        self.at += 1;
        self.skip(Roles::of(&[Role::Who, Role::Is, Role::Filler, Role::Either]));
        if !self.deeper(|parser| parser.together(pattern)) {
            self.reset(mark);
            if course.scope == Scope::Top {
                self.report_unused();
            }
            return course.scope == Scope::Top;
        }
        if pattern.conditions.len() == length {
            // Nothing of the alternative is known, and that is reported.
            return true;
        }
        let second = all_of(split_from(&mut pattern.conditions, length));
        let first = all_of(split_from(&mut pattern.conditions, course.group));
        pattern.conditions.push(any_of(vec![first, second]));
        (course.run, course.is_alternative) = (None, true);
        true
    }

    fn word_alternative(&mut self, pattern: &mut Pattern) {
        if !self.deed(pattern) {
            self.adjective_predicate(pattern);
        }
    }

    /// "To my left and to my right" is either: nothing is at both.
    fn part_exclusive(&mut self, pattern: &mut Pattern, before: usize, start: usize) {
        let conditions = &mut pattern.conditions;
        let is_pair = before > 0 && conditions.len() == before + 1;
        if is_pair && excludes(&conditions[before - 1], &conditions[before]) {
            let parts = split_from(conditions, before.saturating_sub(1));
            conditions.push(any_of(parts));
            let message = "nothing is both; read as one or the other".into();
            self.report(IssueKind::Ambiguous, start, self.at, message);
        }
    }
}

/// Whether a verb can be said of a noun: "are" of men, "is" of a man.
fn agree(noun: Roles, verb: Roles) -> bool {
    let has_both = |roles: Roles| roles.has(Role::Plural) == roles.has(Role::Singular);
    has_both(noun) || has_both(verb) || noun.has(Role::Plural) == verb.has(Role::Plural)
}
