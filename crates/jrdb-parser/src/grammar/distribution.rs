//! A clause behind several nouns: whether it describes all of them or the last.

use jrdb_types::issue::IssueKind;
use jrdb_types::query::{Quantity, RelationKind};
use jrdb_types::vocab::PairWord;
use jrdb_types::{Condition, Pattern};

use crate::lexicon::{Role, Roles};
use crate::parser::Parser;
use crate::pattern::{all_of, alternative, any_of, bare_label, either, related, split_from};
use crate::phrase::Part;

/// Which of several nouns the clause behind the last one describes.
#[derive(PartialEq, Eq)]
enum Sharing {
    All,
    /// All, in a question about all of them.
    Together,
    /// Most likely all.
    PerhapsAll,
    Last,
    /// All, with each other.
    EachOther,
}

impl Parser<'_> {
    /// A pattern for any of the parts. The clause behind the last part describes all of them where
    /// the grammar says so.
    pub(crate) fn one_of(&mut self, mut parts: Vec<Part>) -> Pattern {
        let clause = self.clause_of_last(&mut parts);
        let patterns = |parts: Vec<Part>| parts.into_iter().map(|part| part.pattern).collect();
        if clause.is_empty() {
            self.ask_together(&parts);
            return either(patterns(parts));
        }
        let sharing = self.sharing(&parts, &clause);
        self.report_sharing(&sharing, &parts);
        match sharing {
            Sharing::EachOther => return with_each_other(&patterns(parts), &clause),
            Sharing::Last => {
                if let Some(last) = parts.last_mut() {
                    last.pattern.conditions.extend(clause);
                }
                return either(patterns(parts));
            }
            Sharing::Together => self.state.subjects = u32::try_from(parts.len()).ok(),
            Sharing::All | Sharing::PerhapsAll => {}
        }
        let mut all = either(patterns(parts));
        all.conditions.extend(clause);
        all
    }

    /// "is there a man and a woman": one entity cannot be both.
    fn ask_together(&mut self, parts: &[Part]) {
        let is_and = parts.len() > 1 && parts[1..].iter().all(|part| part.is_joined);
        if is_and && self.state.asks_several {
            self.state.subjects = u32::try_from(parts.len()).ok();
            self.report_sharing(&Sharing::Together, parts);
        }
    }

    /// Cuts off the clause of the last part. Returns nothing if another part has a clause or a
    /// pick, or if pronouns stand for parts.
    fn clause_of_last(&self, parts: &mut [Part]) -> Vec<Condition> {
        let Some((last, others)) = parts.split_last_mut() else { return Vec::new() };
        let is_plain =
            |part: &Part| part.pattern.pick.is_none() && part.pattern.conditions.len() == part.head;
        if others.is_empty()
            || self.has_pronouns
            || !others.iter().all(is_plain)
            || last.pattern.pick.is_some()
        {
            return Vec::new();
        }
        split_from(&mut last.pattern.conditions, last.head)
    }

    fn sharing(&self, parts: &[Part], clause: &[Condition]) -> Sharing {
        const DEFINITE: Roles = Roles::of(&[Role::The, Role::My, Role::His]);
        const DETERMINERS: Roles =
            Roles::of(&[Role::The, Role::A, Role::My, Role::His, Role::No, Role::All]);
        let begins = |part: &Part, roles: Roles| self.roles_at(part.start).has_any(roles);
        let Some(last) = parts.last() else { return Sharing::Last };
        let is_and = parts[1..].iter().all(|part| part.is_joined);
        let is_singular = |part: &Part| !self.is_at(part.after_noun.wrapping_sub(1), Role::Plural);
        let is_pair = parts.len() == 2 && is_and && parts.iter().all(is_singular);
        if is_pair && clause.len() == 1 && is_mutual(&clause[0]) {
            return Sharing::EachOther;
        }
        let is_plural =
            self.is_at(last.after_noun, Role::Who) && self.is_at(last.after_noun + 1, Role::Plural);
        let is_bare = !begins(last, DETERMINERS);
        if is_and && self.state.asks_several {
            return Sharing::Together;
        }
        if is_plural && is_singular(last) || is_bare {
            Sharing::All
        } else if !parts.iter().any(|part| begins(part, DEFINITE)) {
            Sharing::PerhapsAll
        } else {
            Sharing::Last
        }
    }

    fn report_sharing(&mut self, sharing: &Sharing, parts: &[Part]) {
        let message = match sharing {
            Sharing::All | Sharing::EachOther => return,
            Sharing::Together => {
                "asked of several things together; read as at least that many of either kind"
            }
            Sharing::PerhapsAll => "read as said of all of these, not only of the last",
            Sharing::Last => {
                "read as said only of the last of these; say it of each, if all are meant"
            }
        };
        let Some(last) = parts.last() else { return };
        let start = if last.after_noun < self.state.at { last.after_noun } else { last.start };
        self.report(IssueKind::Ambiguous, start, self.state.at, message.into());
    }
}

/// Whether a condition is an interaction or relation without a named partner.
fn is_mutual(condition: &Condition) -> bool {
    let Condition::Related(related) = condition else { return false };
    let is_pair = matches!(
        related.kinds[..],
        [RelationKind::Pair(PairWord::FacingEachOther | PairWord::Adjacent)]
    );
    related.partner == Pattern::default() && (is_pair || bare_label(condition).is_some())
}

/// "the man and the woman talking": each of them does it with the other.
fn with_each_other(groups: &[Pattern], clause: &[Condition]) -> Pattern {
    let kinds = match clause {
        [Condition::Related(related)] => related.kinds.clone(),
        _ => Vec::new(),
    };
    let all = either(groups.to_vec());
    let partners = groups.iter().rev().cloned();
    let with = |(group, partner): (Pattern, Pattern)| {
        let category = all.category.clone();
        let mut conditions = vec![alternative(group, &category)];
        if let [Condition::All(parts)] = &mut conditions[..] {
            conditions = std::mem::take(parts);
        }
        conditions.push(related(kinds.clone(), partner, Quantity::SOME));
        all_of(conditions)
    };
    let parts: Vec<Condition> = groups.iter().cloned().zip(partners).map(with).collect();
    Pattern { conditions: vec![any_of(parts)], category: all.category, pick: None }
}
