//! Clauses behind a noun: "who is sitting or standing near the table and not facing me".

use jrdb_types::Pattern;
use jrdb_types::issue::IssueKind;
use jrdb_types::query::{Category, RelationKind};
use jrdb_types::vocab::PairWord;

use crate::lexicon::{Entry, Role, Roles};
use crate::parser::Parser;
use crate::pattern::{all_of, any_of, excludes, identify, split_from};
use crate::phrase::{After, Scope};

/// How far the clauses of one noun have been read.
struct ClauseState {
    scope: Scope,
    /// First condition of the target that slots may take.
    head: usize,
    /// First condition of what "or" is an alternative to.
    group: usize,
    /// First condition of a list of single words: "sitting, standing or …".
    run: Option<usize>,
    /// A comma was read since the last predicate.
    is_listed: bool,
    /// "and" was read since the last predicate.
    is_joined: bool,
    /// An alternative was read since the last predicate: the next one applies beside all of them.
    is_alternative: bool,
    /// "who" or "is" was read.
    is_clause: bool,
    predicates: usize,
    noun: Option<&'static Entry>,
}

impl ClauseState {
    fn new(scope: Scope, head: usize, noun: Option<&'static Entry>) -> Self {
        Self {
            scope,
            head,
            group: head,
            run: None,
            is_listed: false,
            is_joined: false,
            is_alternative: false,
            is_clause: false,
            predicates: 0,
            noun,
        }
    }

    /// What the next predicate stands behind.
    fn position(&self) -> After {
        match (self.is_clause, self.scope) {
            (true, _) => After::Verb,
            (false, Scope::Reduced) => After::Partner,
            (false, _) => After::Noun,
        }
    }
}

/// Words that may begin or end a clause, or join two.
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

/// Words without meaning between predicates.
const GLUE: Roles = Roles::of(&[Role::Filler, Role::Slash, Role::Exists]);

/// What may begin a clause with a subject of its own: "(the woman) the man is talking to".
const OTHERS: Roles =
    Roles::of(&[Role::The, Role::A, Role::Number, Role::Who, Role::Is, Role::Doing]);

/// What ends the clauses of any noun.
const ENDS: Roles = Roles::of(&[Role::Than, Role::Order]);

impl Parser<'_> {
    /// Reads the clauses behind a noun into its conditions. Returns how many of the conditions come
    /// from before them.
    pub(crate) fn clauses(&mut self, pattern: &mut Pattern, scope: Scope) -> usize {
        let mut clause = ClauseState::new(scope, pattern.conditions.len(), self.state.last_noun);
        while !self.is_end() && self.predicate_or_joint(pattern, &mut clause) {}
        clause.head
    }

    /// One predicate or joint; false if the word at hand belongs to another entity.
    fn predicate_or_joint(&mut self, pattern: &mut Pattern, clause: &mut ClauseState) -> bool {
        let roles = self.roles();
        let is_first = clause.predicates == 0 && !clause.is_clause;
        if is_first && roles.has_any(OTHERS) && self.object_relative(pattern) {
            clause.predicates += 1;
            return true;
        }
        if roles.has_any(JOINTS)
            && let Some(goes_on) = self.joint(pattern, clause)
        {
            return goes_on;
        }
        let after = clause.position();
        if after == After::Partner && self.belongs_to_subject(pattern) {
            return false;
        }
        self.clause_predicate(pattern, clause, after) || self.stray_word(clause)
    }

    fn clause_predicate(
        &mut self,
        pattern: &mut Pattern,
        clause: &mut ClauseState,
        after: After,
    ) -> bool {
        let (before, start) = (pattern.conditions.len(), self.state.at);
        let is_word = self.is(Role::Implies);
        if !self.predicate(pattern, after) {
            return false;
        }
        clause.predicates += 1;
        if std::mem::take(&mut clause.is_alternative) {
            clause.group = before;
        }
        if std::mem::take(&mut clause.is_joined) {
            self.split_exclusive(pattern, before, start);
        }
        let is_single = is_word && pattern.conditions.len() == before + 1;
        clause.run = match clause.run.filter(|_| clause.is_listed && is_single) {
            None => is_single.then_some(before),
            run => run,
        };
        clause.is_listed = false;
        true
    }

    /// Consumes a word that no predicate begins with; false where an outer clause may use it.
    fn stray_word(&mut self, clause: &ClauseState) -> bool {
        let is_top = clause.scope == Scope::Top;
        let is_both = self.word(self.state.at).eq_ignore_ascii_case("both");
        if is_both || self.roles().has_any(GLUE) || is_top && self.is(Role::Located) {
            self.bump();
            return true;
        }
        if is_top {
            self.report_unused();
        }
        is_top
    }

    /// Reads a joint and returns whether the clause goes on; none if the word at hand is not a
    /// joint after all.
    fn joint(&mut self, pattern: &mut Pattern, clause: &mut ClauseState) -> Option<bool> {
        let (roles, is_top) = (self.roles(), clause.scope == Scope::Top);
        if roles.has_any(ENDS) {
            return Some(false);
        }
        if (roles.has_any(Roles::of(&[Role::Comma, Role::And, Role::Then]))) && self.is_then() {
            if is_top {
                self.then(pattern, clause.head);
                (clause.group, clause.run) = (clause.head, None);
            }
            return Some(is_top);
        }
        if roles.has(Role::During) {
            return (!is_top || self.during()).then_some(is_top);
        }
        if roles.has(Role::Comma) {
            return Some(self.comma(pattern, clause));
        }
        if roles.has(Role::And) {
            return Some(self.and(pattern, clause));
        }
        if roles.has(Role::Or) {
            return Some(self.or(pattern, clause));
        }
        if roles.has(Role::Whose) {
            return Some(self.whose(pattern) || self.stray_word(clause));
        }
        self.copula(pattern, clause)
    }

    /// A comma, unless it continues a list of entities: "men, women and children"; "which is
    /// taller, the man or the woman".
    fn comma(&mut self, pattern: &mut Pattern, clause: &mut ClauseState) -> bool {
        let is_top = clause.scope == Scope::Top;
        let is_bare = pattern.category == Category::Person
            && self.is_bare_thing_at(self.state.at + 1)
            && !(self.state.at..self.state.tokens.len())
                .any(|at| self.roles_at(at).has_any(Roles::of(&[Role::And, Role::Or])));
        let next = self.next_not_in(self.state.at + 1, Roles::of(&[Role::Color, Role::Shade]));
        let is_bare = is_bare || next > self.state.at + 1 && self.is_at(next, Role::Garment);
        let is_list = is_top && !is_bare && (!clause.is_clause || pattern.pick.is_some());
        if is_list && self.is_noun_group_next() && !self.is_next_located_by_his() {
            return false;
        }
        let goes_on = is_top || clause.scope == Scope::Relative && self.is_list_of_words(clause);
        if goes_on {
            (clause.is_listed, clause.group) = (true, pattern.conditions.len());
            self.bump();
        }
        goes_on
    }

    /// Whether the word at hand describes the subject and not this partner of it.
    fn belongs_to_subject(&self, pattern: &Pattern) -> bool {
        self.is_located_by_his_at(self.state.at)
            || self.state.is_walk && self.is(Role::Towards)
            || self.is_said_of_people_only(pattern)
    }

    /// Whether the word at hand cannot describe the partner because the partner is not a person:
    /// "the man at the table holding a bag".
    fn is_said_of_people_only(&self, pattern: &Pattern) -> bool {
        const OF_PEOPLE: Roles = Roles::of(&[
            Role::Action,
            Role::Interaction,
            Role::Implies,
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

    fn is_list_of_words(&self, clause: &ClauseState) -> bool {
        clause.run.is_some() && self.is_at(self.state.at + 1, Role::Implies)
    }

    /// "who", "is", "has".
    fn copula(&mut self, pattern: &mut Pattern, clause: &mut ClauseState) -> Option<bool> {
        let roles = self.roles();
        let is_who = roles.has(Role::Who);
        if clause.scope == Scope::Reduced && (!is_who || self.is_who_of_another(pattern, clause)) {
            return Some(false);
        }
        let is_asked = roles.has(Role::Is)
            && !(is_who || clause.is_clause || self.state.at + 1 == self.state.tokens.len());
        if is_asked && clause.scope == Scope::Top && pattern.pick.is_some() {
            // "which of the two tallest is sitting": the two tallest of all, not of those who sit.
            identify(pattern);
            clause.head = pattern.conditions.len();
        }
        if clause.scope == Scope::Relative && clause.predicates > 0 && !clause.is_listed {
            return Some(false);
        }
        if roles.has(Role::Has) && !roles.has(Role::Is) {
            clause.is_clause = true;
            return None;
        }
        if clause.scope == Scope::Reduced {
            clause.scope = Scope::Relative;
        }
        (clause.is_clause, clause.group) = (true, pattern.conditions.len());
        if roles.has(Role::Not) {
            return None;
        }
        self.bump();
        Some(true)
    }

    /// Whether "who" describes an outer noun: it cannot describe a table, nor can "who are"
    /// describe a woman.
    fn is_who_of_another(&self, pattern: &Pattern, clause: &ClauseState) -> bool {
        let roles = self.roles();
        let is_personal = !roles.has_any(Roles::of(&[Role::Which, Role::The]));
        let is_which = roles.has(Role::Which) && !roles.has(Role::The);
        let is_person = pattern.category == Category::Person;
        let agrees =
            clause.noun.is_none_or(|noun| agree(noun.roles, self.roles_at(self.state.at + 1)));
        is_personal && !is_person || is_which && is_person || !agrees
    }

    fn and(&mut self, pattern: &mut Pattern, clause: &mut ClauseState) -> bool {
        let begins_anew = self.is_at(self.state.at + 1, Role::Who) && clause.scope != Scope::Top;
        if clause.scope == Scope::Reduced || begins_anew {
            return false;
        }
        if self.is(Role::But) && self.is_noun_group_next() {
            return self.except(pattern);
        }
        let not = self.state.at + 1;
        if self.is_at(not, Role::Not) && self.is_head_resumed(not) {
            // "But not the one on the table" is an exception.
            self.bump();
            return self.except(pattern);
        }
        if self.is_noun_group_next() && !(clause.is_clause && self.is_next_located_by_his()) {
            return false;
        }
        let checkpoint = self.checkpoint();
        self.bump();
        (clause.group, clause.is_listed) = (pattern.conditions.len(), clause.run.is_some());
        clause.is_joined = true;
        if clause.scope == Scope::Relative {
            self.skip_while(Roles::of(&[Role::Is, Role::Filler]));
            if !self.predicate(pattern, After::Verb) {
                self.rewind(checkpoint);
                return false;
            }
            clause.run = None;
        }
        true
    }

    fn or(&mut self, pattern: &mut Pattern, clause: &mut ClauseState) -> bool {
        let length = pattern.conditions.len();
        let is_word = self.is_at(self.state.at + 1, Role::Implies)
            && !self.is_at(self.state.at + 1, Role::Noun);
        if let Some(run) = clause.run.filter(|_| is_word) {
            self.bump();
            self.word_alternative(pattern);
            let parts = split_from(&mut pattern.conditions, run);
            pattern.conditions.push(any_of(parts));
            return true;
        }
        if clause.scope == Scope::Reduced || self.is_noun_group_next() || length == clause.group {
            let is_lost = clause.scope == Scope::Top && !self.is_noun_group_next();
            if is_lost {
                self.report_unused();
            }
            return is_lost;
        }
        let checkpoint = self.checkpoint();
        self.bump();
        self.skip_while(Roles::of(&[Role::Who, Role::Is, Role::Filler, Role::Either]));
        if !self.nested(|parser| parser.conditions(pattern)) {
            self.rewind(checkpoint);
            if clause.scope == Scope::Top {
                self.report_unused();
            }
            return clause.scope == Scope::Top;
        }
        if pattern.conditions.len() == length {
            // The alternative consists of reported words only.
            return true;
        }
        let second = all_of(split_from(&mut pattern.conditions, length));
        let first = all_of(split_from(&mut pattern.conditions, clause.group));
        pattern.conditions.push(any_of(vec![first, second]));
        (clause.run, clause.is_alternative) = (None, true);
        true
    }

    fn word_alternative(&mut self, pattern: &mut Pattern) {
        if !self.activity(pattern) {
            self.adjective_predicate(pattern);
        }
    }

    /// Makes alternatives of two conditions that exclude each other: "to my left and to my right".
    fn split_exclusive(&mut self, pattern: &mut Pattern, before: usize, start: usize) {
        let conditions = &mut pattern.conditions;
        let is_pair = before > 0 && conditions.len() == before + 1;
        if is_pair && excludes(&conditions[before - 1], &conditions[before]) {
            let parts = split_from(conditions, before.saturating_sub(1));
            conditions.push(any_of(parts));
            let message = "nothing is both; read as one or the other".into();
            self.report(IssueKind::Ambiguous, start, self.state.at, message);
        }
    }
}

/// Whether noun and verb agree in number: "men are", "a man is".
fn agree(noun: Roles, verb: Roles) -> bool {
    let has_both = |roles: Roles| roles.has(Role::Plural) == roles.has(Role::Singular);
    has_both(noun) || has_both(verb) || noun.has(Role::Plural) == verb.has(Role::Plural)
}
