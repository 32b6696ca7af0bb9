//! What a question asks for: a noun group with its clauses, or several of them.

use jrdb_types::issue::IssueKind;
use jrdb_types::query::Category;
use jrdb_types::{Condition, Pattern};

use crate::lexicon::{Role, Roles};
use crate::parser::Parser;
use crate::pattern::{either, set_count};
use crate::phrase::{NounGroup, Part, Scope, Target};

/// Words between nouns that are asked for together.
const JOINTS: Roles = Roles::of(&[Role::And, Role::Or, Role::Comma]);

/// What "all" without a noun may stand before.
const EXCEPT: Roles = Roles::of(&[Role::Except, Role::But]);

impl Parser<'_> {
    /// A noun group with its clauses and alternatives.
    pub(crate) fn target(&mut self) -> Target {
        let first = self.target_noun_group();
        self.finish_target(first)
    }

    pub(crate) fn target_noun_group(&mut self) -> NounGroup {
        self.skip_while(Roles::of(&[Role::Either, Role::Filler]));
        let mut group = NounGroup::default();
        if self.is(Role::Comparative) && self.older(&mut group) {
            let mut all = NounGroup::default();
            if self.read_noun_group(&mut all) {
                all.pattern.conditions.splice(0..0, group.pattern.conditions);
                return all;
            }
        }
        if let Some(those) = self.demonstrated() {
            return NounGroup { pattern: those, ..NounGroup::default() };
        }
        if self.read_noun_group(&mut group) {
            return group;
        }
        if self.is(Role::Him) {
            let those = self.discourse.clone();
            if let Some(those) = those {
                self.eat_pronoun();
                return NounGroup { pattern: (*those).clone(), ..NounGroup::default() };
            }
            let pattern = self.pronoun().unwrap_or_default();
            return NounGroup { pattern, ..NounGroup::default() };
        }
        if self.is(Role::All) && self.roles_at(self.state.at + 1).has_any(EXCEPT) {
            self.bump();
            return NounGroup::default();
        }
        let next = self.next_not_in(self.state.at, Roles::of(&[Role::The, Role::A]));
        if next > self.state.at && self.is_at(next, Role::Unknown) {
            self.state.at = next;
            let pattern = self.unknown_entity();
            return NounGroup { pattern, ..NounGroup::default() };
        }
        NounGroup::default()
    }

    /// "that" of "is that a man or a woman?": what was spoken of before.
    fn demonstrated(&mut self) -> Option<Pattern> {
        let those = self.discourse.as_deref()?;
        let is_that = ["that", "this", "these", "those"]
            .iter()
            .any(|word| self.word(self.state.at).eq_ignore_ascii_case(word));
        let next = self.roles_at(self.state.at + 1);
        let is_alone = next.has_any(Roles::of(&[Role::A, Role::The])) || self.is_last();
        if !is_that || !is_alone {
            return None;
        }
        let those = those.clone();
        self.bump();
        Some(those)
    }

    fn is_last(&self) -> bool {
        self.state.at + 1 == self.state.tokens.len()
    }

    /// Reads the clauses and alternatives behind a noun group: "the man or the woman next to him".
    pub(crate) fn finish_target(&mut self, group: NounGroup) -> Target {
        self.begin_target(group.noun);
        let (mut pattern, noun) = (group.pattern, group.noun);
        let (start, after_noun) = (group.start, self.state.at);
        let head = self.clauses(&mut pattern, Scope::Top);
        if self.state.is_timed {
            self.close_slot(&mut pattern, head);
        }
        set_count(&mut pattern, group.count);
        if self.is(Role::Comma) && pattern.pick.is_some() {
            self.choice(&mut pattern);
        }
        let pattern = if self.roles().has_any(JOINTS) && self.is_noun_group_next() {
            self.others(Part {
                pattern,
                noun,
                head,
                start,
                after_noun,
                has_places: group.has_places,
                is_joined: true,
            })
        } else {
            pattern
        };
        let NounGroup { quantity, count, share, .. } = group;
        Target { pattern, quantity, count, share, head }
    }

    /// Reads the other parts of "the man, the woman and the child".
    fn others(&mut self, first: Part) -> Pattern {
        let (start, mut is_list) = (self.state.at, true);
        let mut parts = vec![first];
        while self.roles().has_any(JOINTS) && self.is_noun_group_next() {
            let is_joined = !self.is(Role::Or);
            is_list &= self.is(Role::Comma) && !self.roles_at(self.state.at + 1).has_any(JOINTS);
            let checkpoint = self.checkpoint();
            self.bump();
            if let Some(last) = parts.last() {
                self.begin_target(last.noun);
                if self.has_pronouns {
                    self.set_antecedent(&last.pattern);
                }
            }
            let start = self.state.at;
            let Some(NounGroup { mut pattern, noun, count, is_pronoun, .. }) = self.noun_group()
            else {
                self.rewind(checkpoint);
                break;
            };
            if is_pronoun && parts.last().is_some_and(is_beside_person) {
                self.report_resumed(start);
            }
            self.begin_target(noun);
            let has_places = parts[0].has_places && self.places_before_predicate(&mut pattern);
            let (head, after_noun) = (pattern.conditions.len(), self.state.at);
            self.clauses(&mut pattern, Scope::Top);
            set_count(&mut pattern, count);
            parts.push(Part { pattern, noun, head, start, after_noun, has_places, is_joined });
        }
        if is_list {
            let message = "read as a list of things, each of which is meant".into();
            self.report(IssueKind::Ambiguous, start, self.state.at, message);
        }
        self.one_of(parts)
    }

    /// Reports "the one" where it may also stand for one more partner of the part before.
    fn report_resumed(&mut self, start: usize) {
        let message = "read as one more of those asked for, not as one more beside them".into();
        self.report(IssueKind::Ambiguous, start, self.state.at, message);
    }

    /// ", the man or the woman" behind "which person is taller": the candidates.
    pub(crate) fn choice(&mut self, pattern: &mut Pattern) {
        let mut groups = Vec::new();
        while self.roles().has_any(JOINTS) && self.is_noun_group_next() {
            self.bump();
            self.resume_noun(self.state.head_noun);
            let Some(group) = self.noun_group() else { break };
            self.begin_target(group.noun);
            groups.push(self.with_modifiers(group.pattern, group.count));
        }
        let choice = either(groups);
        pattern.category = choice.category;
        pattern.conditions.extend(choice.conditions);
    }
}

/// Whether a part is a person whose last condition is a relation to another person.
fn is_beside_person(part: &Part) -> bool {
    let Some(Condition::Related(related)) =
        part.pattern.conditions.get(part.head..).and_then(<[_]>::last)
    else {
        return false;
    };
    let is_person = |category: &Category| *category == Category::Person;
    is_person(&part.pattern.category) && is_person(&related.partner.category)
}
