//! Universals, choices and tags: "are all of them sitting?", "is it a man or a woman?", "…, right?".

use jrdb_types::query::{Place, Property, Quantity, Related, RelationKind, Share, Task, Viewpoint};
use jrdb_types::vocab::PairWord;
use jrdb_types::{Condition, Pattern};

use crate::lexicon::{Role, Roles};
use crate::parser::Parser;
use crate::pattern::{related, split_from};
use crate::phrase::{NounGroup, Target};

impl Parser<'_> {
    /// Whether what is asked about is named, so that a question about it has a choice: "the man",
    /// "he", "#4".
    pub(crate) fn is_definite(&self) -> bool {
        const DEFINITE: Roles =
            Roles::of(&[Role::The, Role::Him, Role::His, Role::IdMark, Role::My]);
        let at = self.next_not_in(self.state.at, Roles::of(&[Role::Filler]));
        self.roles_at(at).has_any(DEFINITE) || self.is_at(at + 1, Role::Number)
    }

    /// "right?", "isn't she?", "is that so?" behind a statement: cut off the end.
    pub(crate) fn drop_tag(&mut self) -> bool {
        const ASKS: Roles =
            Roles::of(&[Role::Is, Role::Doing, Role::Has, Role::Not, Role::Without]);
        const NAMES: Roles = Roles::of(&[Role::Him, Role::Filler, Role::One, Role::The]);
        let end = self.state.tokens.len();
        let Some(comma) = (self.state.at + 1..end).rev().find(|at| self.is_at(*at, Role::Comma))
        else {
            return false;
        };
        let is_word = comma + 2 == end && self.is_tag_word(comma + 1);
        let is_clause = (comma + 2..=comma + 4).contains(&(end - 1))
            && self.roles_at(comma + 1).has_any(ASKS)
            && (comma + 2..end).all(|at| self.roles_at(at).has_any(NAMES) || self.is_tag_word(at));
        let found = is_word || is_clause;
        if found {
            self.state.tokens = &self.state.tokens[..comma];
        }
        found
    }

    fn is_tag_word(&self, at: usize) -> bool {
        const WORDS: [&str; 9] =
            ["right", "correct", "yes", "no", "true", "so", "okay", "ok", "not"];
        WORDS.iter().any(|word| self.word(at).eq_ignore_ascii_case(word))
    }

    /// "none of the women is sitting": a statement about a share.
    pub(crate) fn has_declared_share(&self) -> bool {
        let is_share = self.roles().has_any(Roles::of(&[Role::NoneOf, Role::Most, Role::Half]));
        is_share && (self.state.at..self.state.tokens.len()).any(|at| self.is_at(at, Role::Is))
    }

    /// "it a boy or a girl who stands next to the dog" behind "is".
    pub(crate) fn cleft(&mut self) -> Option<(Task, Pattern)> {
        let is_it = self.is(Role::It) || self.word(self.state.at).eq_ignore_ascii_case("that");
        let next = self.next_not_in(self.state.at + 1, Roles::of(&[Role::A, Role::The]));
        let is_named = next > self.state.at + 1 && self.is_noun_ahead(next);
        if !is_it || !is_named || self.is_at(self.state.at + 1, Role::His) {
            return None;
        }
        let has_clause = (next..self.state.tokens.len()).any(|at| self.is_at(at, Role::Who));
        if self.discourse.is_some() && !has_clause {
            return None;
        }
        let checkpoint = self.checkpoint();
        self.bump();
        let mut options = Vec::new();
        while let Some(group) = self.noun_group() {
            options.push(group.pattern);
            if !self.is(Role::Or) {
                break;
            }
            self.bump();
        }
        let same = options.windows(2).all(|two| two[0].category == two[1].category);
        if !self.is(Role::Who) || !same || options.is_empty() {
            self.rewind(checkpoint);
            return None;
        }
        let category = options[0].category.clone();
        let is_choice = options.len() > 1;
        let mut pattern = Pattern::of(category);
        if !is_choice {
            pattern = options.pop().unwrap_or(pattern);
        }
        let target = self.finish_target(NounGroup { pattern, ..NounGroup::default() });
        drop_shared(&mut options);
        let all = options.into_iter().map(|option| crate::pattern::all_of(option.conditions));
        let task = match is_choice {
            true => Task::Choice { options: all.collect() },
            false => Task::Exists(Quantity::SOME),
        };
        Some((task, target.pattern))
    }

    /// "are the two children more than three metres apart": asked of each and the others.
    pub(crate) fn asked_apart(&mut self, target: &mut Target) -> Option<(Task, Pattern)> {
        if !(0..self.state.at).any(|at| self.is_at(at, Role::Apart)) {
            return None;
        }
        let far = |c: &Condition| matches!(c, Condition::FromRobot(Place::Metres(_)));
        let at = target.pattern.conditions.iter().position(far)?;
        let Condition::FromRobot(place) = target.pattern.conditions.remove(at) else { return None };
        let kinds = vec![RelationKind::Placed { place, viewpoint: Viewpoint::Partner }];
        let asked = related(kinds, target.pattern.clone(), Quantity::SOME);
        let task = Task::Each { share: Share::All, asked: vec![asked] };
        Some((task, std::mem::take(&mut target.pattern)))
    }

    /// The choice between alternatives that were read behind a subject at `start`; they leave its
    /// conditions.
    pub(crate) fn choice_of(&mut self, target: &mut Target, start: usize) -> Option<Task> {
        let has_or = (start..self.state.at).any(|at| self.is_at(at, Role::Or));
        let conditions = &target.pattern.conditions[target.head..];
        let is_choice = |c: &Condition| matches!(c, Condition::Any(parts) if parts.len() > 1);
        if !has_or || conditions.iter().filter(|c| is_choice(c)).count() != 1 {
            return None;
        }
        let mut asked = split_from(&mut target.pattern.conditions, target.head);
        let at = asked.iter().position(is_choice)?;
        let Condition::Any(mut options) = asked.remove(at) else { return None };
        target.pattern.conditions.extend(asked);
        share_partner(&mut options);
        if options.iter().all(is_facing_robot) {
            let properties = vec![Property::Facing];
            return Some(Task::Which { properties, in_order: false });
        }
        Some(Task::Choice { options })
    }
}

/// Drops what all alternatives have in common: of "a boy or a girl" the age.
fn drop_shared(options: &mut [Pattern]) {
    let Some(first) = options.first().cloned() else { return };
    let is_shared = |c: &Condition| options.iter().all(|option| option.conditions.contains(c));
    let shared: Vec<Condition> = first.conditions.into_iter().filter(is_shared).collect();
    if options.iter().any(|option| option.conditions.len() == shared.len()) {
        return;
    }
    for option in options {
        option.conditions.retain(|condition| !shared.contains(condition));
    }
}

/// Gives a side without a reference the one that is named behind the last: "to the left or to the
/// right of the woman".
fn share_partner(options: &mut [Condition]) {
    let Some(Condition::Related(last)) = options.last().cloned() else { return };
    let [RelationKind::Placed { viewpoint, .. }] = last.kinds[..] else { return };
    for option in options.iter_mut() {
        if let Condition::FromRobot(place @ Place::Direction(_)) = option {
            let kinds = vec![RelationKind::Placed { place: *place, viewpoint }];
            *option = Condition::Related(Related { kinds, ..last.clone() });
        }
    }
}

/// Whether a condition says that somebody faces the robot, or turns the back to it.
fn is_facing_robot(condition: &Condition) -> bool {
    let parts = match condition {
        Condition::All(parts) => &parts[..],
        one => std::slice::from_ref(one),
    };
    parts.iter().any(|part| match part {
        Condition::Related(Related { kinds, partner, .. }) => {
            let is_way = kinds.iter().any(|kind| {
                matches!(kind, RelationKind::Pair(PairWord::Facing) | RelationKind::Placed { .. })
            });
            partner.category == jrdb_types::query::Category::Robot && is_way
        }
        _ => false,
    })
}
