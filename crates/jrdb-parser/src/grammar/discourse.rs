//! Several sentences, one after the other: the last question is asked, and pronouns stand for what
//! the sentences before it speak of.

use std::rc::Rc;

use jrdb_types::query::{Category, Command, Task};
use jrdb_types::{Attribute, Condition, Pattern};

use crate::lexicon::{Role, Roles};
use crate::parser::Parser;
use crate::pattern::truncated_antecedent;
use crate::token::Token;

/// Sentences of one text; a text with more is read as one.
const SENTENCES_MAX: usize = 8;

/// What a text asks for.
#[derive(Default)]
pub(crate) struct Asked {
    pub(crate) task: Task,
    pub(crate) target: Pattern,
    pub(crate) command: Option<Command>,
}

/// What kind of sentence was read.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// It asks or requests something.
    Question,
    /// It speaks of something: "there is a boy", "a man in red".
    Statement,
    /// It says more about what was spoken of: "she has a green coat".
    More,
    /// It asks the same about others: "and behind him?", "what about the women?".
    Fragment,
}

impl<'t> Parser<'t> {
    /// Reads all sentences, after a question that was asked before.
    pub(crate) fn discourse(&mut self, before: Asked) -> Asked {
        let all = self.state.tokens;
        let sentences = self.sentences(all);
        let follows = self.discourse.is_some();
        if sentences.len() == 1 && !follows {
            return self.sentence(Kind::Question, &before);
        }
        self.has_pronouns = true;
        let mut asked = before;
        let mut is_asked = follows;
        let count = sentences.len();
        for (number, sentence) in sentences.into_iter().enumerate() {
            let is_last = number + 1 == count;
            self.begin(sentence);
            let kind = match self.kind() {
                Kind::Fragment if !is_asked => Kind::More,
                kind => kind,
            };
            let next = self.sentence(kind, &asked);
            while !self.is_end() {
                self.report_unused();
            }
            let is_empty = next.task == Task::Find && next.target == Pattern::default();
            if is_empty && self.discourse.is_some() {
                continue;
            }
            self.discourse = Some(Rc::new(truncated_antecedent(&next.target)));
            if kind == Kind::Statement && is_asked && !(follows && is_last) {
                continue;
            }
            is_asked |= kind != Kind::Statement;
            let command = next.command.or(asked.command.take());
            asked = Asked { command, ..next };
        }
        asked
    }

    /// The sentences of a text, without empty ones.
    fn sentences(&self, all: &'t [Token]) -> Vec<&'t [Token]> {
        let ends = (1..all.len()).filter(|at| self.ends_before(all, *at));
        let ends: Vec<usize> = ends.take(SENTENCES_MAX).collect();
        if ends.is_empty() || ends.len() == SENTENCES_MAX {
            return vec![all];
        }
        let starts = std::iter::once(0).chain(ends.iter().copied());
        let stops = ends.iter().copied().chain(std::iter::once(all.len()));
        starts.zip(stops).map(|(start, stop)| &all[start..stop]).collect()
    }

    /// Whether a sentence ends before a word: at a full stop, or at a comma before a question about
    /// what was just named ("the man with the cart, is he behind me?").
    fn ends_before(&self, all: &[Token], at: usize) -> bool {
        let between = self.text.get(all[at - 1].end..all[at].start).unwrap_or_default();
        let ends = |byte: &u8| matches!(byte, b'.' | b'?' | b'!');
        between.as_bytes().iter().any(ends) || self.is_resumed_at(all, at)
    }

    fn is_resumed_at(&self, all: &[Token], at: usize) -> bool {
        const ASKS: Roles = Roles::of(&[
            Role::Is,
            Role::Doing,
            Role::Has,
            Role::Who,
            Role::Which,
            Role::Where,
            Role::How,
        ]);
        const PRONOUN: Roles = Roles::of(&[Role::Him, Role::His, Role::One]);
        let has = |at: usize, roles: Roles| all.get(at).is_some_and(|t| t.roles.has_any(roles));
        let is_comma = has(at - 1, Roles::of(&[Role::Comma]));
        if !is_comma || !has(at, ASKS) || has(at, Roles::of(&[Role::Not])) {
            return false;
        }
        const TAG: Roles = Roles::of(&[Role::Him, Role::One, Role::The, Role::Filler, Role::Not]);
        let is_verb = has(at, Roles::of(&[Role::Is, Role::Doing, Role::Has]));
        let is_tag = is_verb && (at + 1..all.len()).all(|at| has(at, TAG));
        let is_filler = |token: &&Token| token.roles.has(Role::Filler);
        let first = all.iter().find(|token| !is_filler(token)).map_or(all[0].roles, |t| t.roles);
        let is_named =
            !first.has_any(ASKS.and(Roles::of(&[Role::Find, Role::Count, Role::Command])))
                || first.has(Role::The);
        let is_that = |at: usize| {
            let word = all.get(at).and_then(|token| self.text.get(token.start..token.end));
            word.is_some_and(|word| word.eq_ignore_ascii_case("that"))
        };
        let names =
            |at: usize| (has(at, PRONOUN) || is_that(at)) && !has(at + 1, Roles::of(&[Role::Noun]));
        is_named && !is_tag && (at + 1..at + 4).any(names)
    }

    fn begin(&mut self, sentence: &'t [Token]) {
        self.state.tokens = sentence;
        self.state.at = 0;
        self.state.antecedent.clone_from(&self.discourse);
        (self.state.last_noun, self.state.head_noun) = (None, None);
        (self.state.asks_doing, self.state.asks_several) = (false, false);
        self.state.subjects = None;
    }

    fn kind(&self) -> Kind {
        const SKIPPED: Roles = Roles::of(&[Role::Filler, Role::Comma, Role::And, Role::But]);
        const QUESTION: Roles = Roles::of(&[
            Role::Find,
            Role::Count,
            Role::Where,
            Role::Describe,
            Role::Is,
            Role::Doing,
            Role::Has,
            Role::If,
            Role::More,
            Role::Fewer,
            Role::Asks,
            Role::Colour,
            Role::Command,
        ]);
        const WORDS: Roles =
            Roles::of(&[Role::How, Role::Which, Role::What, Role::Who, Role::Whose]);
        let start = self.next_not_in(0, SKIPPED);
        let roles = self.roles_at(start);
        if self.discourse.is_some() && self.is_about(start) {
            return Kind::Fragment;
        }
        if self.is_there(start) {
            return Kind::Statement;
        }
        if roles.has_any(QUESTION) || roles.has_any(WORDS) && !roles.has(Role::The) {
            return Kind::Question;
        }
        if roles.has(Role::Him) && !roles.has(Role::His) || self.is_his_subject(start) {
            return Kind::More;
        }
        let had_and = (0..start).any(|at| self.is_at(at, Role::And));
        if self.discourse.is_some() && (had_and || self.is_predicate_only(start)) {
            return Kind::Fragment;
        }
        Kind::Statement
    }

    /// "there is", "i see".
    fn is_there(&self, start: usize) -> bool {
        let is_there = self.word(start.saturating_sub(1)).eq_ignore_ascii_case("there");
        is_there && start > 0 && self.is_at(start, Role::Is)
            || self.is_at(start, Role::Exists)
                && !self.is_at(start, Role::Robot)
                && start == 0
                && self.word(0).to_ascii_lowercase().starts_with('i')
    }

    /// "his shirt is red".
    fn is_his_subject(&self, start: usize) -> bool {
        self.is_at(start, Role::His) && self.is_at(start + 1, Role::Garment)
    }

    /// "what about", "how about".
    fn is_about(&self, start: usize) -> bool {
        let is_about = self.word(start + 1).eq_ignore_ascii_case("about");
        is_about && self.roles_at(start).has_any(Roles::of(&[Role::How, Role::What]))
    }

    /// "behind him", "on the left": a place and no noun of its own.
    fn is_predicate_only(&self, start: usize) -> bool {
        const PLACES: Roles = Roles::of(&[
            Role::Sector,
            Role::Near,
            Role::Relation,
            Role::At,
            Role::Between,
            Role::With,
            Role::To,
        ]);
        self.roles_at(start).has_any(PLACES) && !self.is_at(start, Role::Noun)
    }

    fn sentence(&mut self, kind: Kind, before: &Asked) -> Asked {
        match kind {
            Kind::Fragment => self.fragment(before),
            Kind::More => self.more(before),
            Kind::Statement => Asked { target: self.statement(), ..Asked::default() },
            Kind::Question => self.one_question(),
        }
    }

    /// "there is a man with a cart": what is spoken of.
    fn statement(&mut self) -> Pattern {
        const LEAD: Roles = Roles::of(&[
            Role::Filler,
            Role::Comma,
            Role::And,
            Role::Is,
            Role::Exists,
            Role::But,
            Role::Find,
        ]);
        self.skip_while(LEAD);
        self.target().pattern
    }

    /// "she has a green coat": more conditions of what was spoken of; the question stays.
    fn more(&mut self, before: &Asked) -> Asked {
        const LEAD: Roles = Roles::of(&[Role::Filler, Role::Comma, Role::And]);
        self.skip_while(LEAD);
        let target = if self.is_predicate_only(self.state.at) {
            let mut pattern = self.discourse.as_deref().cloned().unwrap_or_default();
            self.clauses_of_all(&mut pattern);
            pattern
        } else if self.is(Role::His) && !self.is(Role::Him) {
            let mut pattern = self.discourse.as_deref().cloned().unwrap_or_default();
            self.bump();
            if !self.whose_clothes(&mut pattern) {
                self.clauses_of_all(&mut pattern);
            }
            pattern
        } else {
            self.target().pattern
        };
        Asked { task: before.task.clone(), target, command: before.command.clone() }
    }

    fn clauses_of_all(&mut self, pattern: &mut Pattern) {
        self.clauses(pattern, crate::phrase::Scope::Top);
    }

    /// "and behind him?", "what about the women?": the question before, about others.
    fn fragment(&mut self, before: &Asked) -> Asked {
        const LEAD: Roles = Roles::of(&[Role::Filler, Role::Comma, Role::And, Role::But]);
        self.skip_while(LEAD);
        if self.is_about(self.state.at) {
            self.state.at += 2;
        }
        self.skip_while(LEAD);
        if self.is_predicate_only(self.state.at) {
            let mut target = Pattern::of(before.target.category.clone());
            let kept = before.target.conditions.iter().filter(|c| is_of_people(c));
            target.conditions.extend(kept.cloned());
            self.clauses_of_all(&mut target);
            return Asked { task: before.task.clone(), target, command: None };
        }
        let mut target = self.target().pattern;
        if self.is_refined(&target) {
            let others = before.target.conditions.iter().filter(|c| !is_of_people(c));
            target.conditions.extend(others.cloned());
        }
        Asked { task: before.task.clone(), target, command: None }
    }

    /// Whether a fragment only says of which people the same is asked.
    fn is_refined(&self, target: &Pattern) -> bool {
        target.category == Category::Person && target.conditions.iter().all(is_of_people)
    }
}

/// Whether a condition says what kind of people is meant: "women".
fn is_of_people(condition: &Condition) -> bool {
    let Condition::Attribute(value) = condition else { return false };
    matches!(value.attribute(), Attribute::Age | Attribute::Gender | Attribute::Race)
}
