//! Conditions made of conditions.

use jrdb_types::query::{Category, Measure, Place, Quantity, Related, RelationKind};
use jrdb_types::{Condition, Pattern};

/// Takes what was said from a place on. Alternatives may have joined conditions that stood before it: then it is nothing.
pub(crate) fn split_from(conditions: &mut Vec<Condition>, from: usize) -> Vec<Condition> {
    conditions.split_off(from.min(conditions.len()))
}

/// One condition that holds when all of these do.
pub(crate) fn all_of(mut conditions: Vec<Condition>) -> Condition {
    match (conditions.len(), conditions.pop()) {
        (1, Some(only)) => only,
        (_, last) => {
            conditions.extend(last);
            Condition::All(conditions)
        }
    }
}

/// One condition that holds when any of these does; alternatives among them are laid flat.
pub(crate) fn any_of(conditions: Vec<Condition>) -> Condition {
    let mut conditions = conditions.into_iter();
    let mut flat = match conditions.next() {
        Some(Condition::Any(parts)) => parts,
        first => first.into_iter().collect(),
    };
    for condition in conditions {
        match condition {
            Condition::Any(parts) => flat.extend(parts),
            other if flat.contains(&other) => {}
            other => flat.push(other),
        }
    }
    if flat.len() == 1 { all_of(flat) } else { Condition::Any(flat) }
}

/// How many conditions and patterns stand inside each other, the pattern itself included.
pub(crate) fn levels(pattern: &Pattern) -> usize {
    1 + pattern.conditions.iter().map(levels_of).max().unwrap_or(0)
}

fn levels_of(condition: &Condition) -> usize {
    1 + match condition {
        Condition::Related(related) => {
            let ends = related.kinds.iter().filter_map(|kind| match kind {
                RelationKind::Between(end) => Some(levels(end)),
                _ => None,
            });
            ends.max().unwrap_or(0).max(levels(&related.partner))
        }
        Condition::Compared(compared) => levels(&compared.than),
        Condition::Is(pattern) => levels(pattern),
        Condition::Not(inner) => levels_of(inner),
        Condition::Any(parts) | Condition::All(parts) => {
            parts.iter().map(levels_of).max().unwrap_or(0)
        }
        _ => 0,
    }
}

/// Makes alternatives of the condition at `length` and the one before it.
pub(crate) fn join_alternative(conditions: &mut Vec<Condition>, length: usize) {
    if length > 0 && conditions.len() == length + 1 {
        let parts = split_from(conditions, length.saturating_sub(1));
        conditions.push(any_of(parts));
    }
}

/// Makes alternatives of the condition at `length` and the one before it if nothing can be both:
/// "young and elderly people".
pub(crate) fn join_exclusive(conditions: &mut Vec<Condition>, length: usize) {
    let pair = length.checked_sub(1).and_then(|first| conditions.get(first..));
    if matches!(pair, Some([first, second]) if excludes(first, second)) {
        join_alternative(conditions, length);
    }
}

/// Whether no thing can be both: two ages, two deeds of the body, two directions.
pub(crate) fn excludes(first: &Condition, second: &Condition) -> bool {
    use Condition::{Action, Age, Any, FromRobot, Gender, Race};
    match (first, second) {
        (Any(parts), second) => parts.iter().any(|part| excludes(part, second)),
        (Age(a), Age(b)) => a != b,
        (Gender(a), Gender(b)) => a != b,
        (Race(a), Race(b)) => a != b,
        (Action(a), Action(b)) => a != b,
        (FromRobot(Place::Direction(a)), FromRobot(Place::Direction(b))) => a != b,
        _ => false,
    }
}

pub(crate) fn related(kinds: Vec<RelationKind>, partner: Pattern, quantity: Quantity) -> Condition {
    Condition::Related(Related { kinds, partner, quantity })
}

pub(crate) fn push_related(
    pattern: &mut Pattern,
    kinds: Vec<RelationKind>,
    partner: Pattern,
    quantity: Quantity,
) {
    let is_none = quantity == Quantity::NONE;
    let quantity = if is_none { Quantity::SOME } else { quantity };
    let one = related(kinds, partner, quantity);
    pattern.conditions.push(if is_none { Condition::Not(Box::new(one)) } else { one });
}

/// "The two women closest to me": the number is of the choice.
pub(crate) fn set_count(pattern: &mut Pattern, count: Option<(u32, usize)>) {
    if let (Some(pick), Some((count, _))) = (&mut pattern.pick, count) {
        pick.count = count;
    }
}

/// Things that are one of these.
pub(crate) fn either(mut things: Vec<Pattern>) -> Pattern {
    if things.len() < 2 {
        return things.pop().unwrap_or_default();
    }
    let first = things[0].category.clone();
    let same = things.iter().all(|thing| thing.category == first);
    let category = if same { first } else { Category::Anything };
    let parts = things.into_iter().map(|thing| alternative(thing, &category)).collect();
    Pattern { conditions: vec![any_of(parts)], category, pick: None }
}

/// What must hold of a thing of a category for it to be one of the pattern.
pub(crate) fn alternative(pattern: Pattern, category: &Category) -> Condition {
    let is_plain = pattern.pick.is_none() && pattern.category == *category;
    if is_plain && !pattern.conditions.is_empty() {
        all_of(pattern.conditions)
    } else {
        Condition::Is(Box::new(pattern))
    }
}

/// Conditions that a pronoun stands for at most, and the parts that each may have; a question whose pronouns stand for
/// pronouns would grow without bound.
const ANTECEDENT_MAX: usize = 8;

/// What is kept of a thing for the pronouns that follow: all that is said of it, but for what is very long.
pub(crate) fn truncated_antecedent(pattern: &Pattern) -> Pattern {
    let is_short = |condition: &&Condition| fits(condition, &mut { ANTECEDENT_MAX });
    let conditions = pattern.conditions.iter().take(ANTECEDENT_MAX).filter(is_short);
    let pick = pattern.pick.as_ref().filter(|pick| match &pick.measure {
        Measure::DistanceTo(things) => pattern_fits(things, &mut { ANTECEDENT_MAX }),
        _ => true,
    });
    Pattern {
        category: pattern.category.clone(),
        conditions: conditions.cloned().collect(),
        pick: pick.cloned(),
    }
}

/// Whether a condition has no more parts than are left; takes them off.
fn fits(condition: &Condition, left: &mut usize) -> bool {
    let Some(rest) = left.checked_sub(1) else { return false };
    *left = rest;
    match condition {
        Condition::Related(related) => {
            let kind_fits = |kind: &RelationKind, left: &mut usize| match kind {
                RelationKind::Between(other) => pattern_fits(other, left),
                _ => true,
            };
            related.kinds.iter().all(|kind| kind_fits(kind, left))
                && pattern_fits(&related.partner, left)
        }
        Condition::Compared(compared) => pattern_fits(&compared.than, left),
        Condition::Is(pattern) => pattern_fits(pattern, left),
        Condition::Not(inner) => fits(inner, left),
        Condition::Any(parts) | Condition::All(parts) => parts.iter().all(|part| fits(part, left)),
        _ => true,
    }
}

fn pattern_fits(pattern: &Pattern, left: &mut usize) -> bool {
    pattern.conditions.iter().all(|condition| fits(condition, left))
}

/// Makes a choice a condition, so that what is said next is said of the one chosen, and chooses no other.
pub(crate) fn identify(pattern: &mut Pattern) {
    let category = pattern.category.clone();
    let chosen = std::mem::replace(pattern, Pattern::of(category));
    pattern.conditions.push(Condition::Is(Box::new(chosen)));
}

/// Whether a condition is a deed with nobody and nothing named.
pub(crate) fn bare_label(condition: &Condition) -> Option<&str> {
    let Condition::Related(related) = condition else { return None };
    match &related.kinds[..] {
        [RelationKind::Interaction(label)] if related.partner.conditions.is_empty() => Some(label),
        _ => None,
    }
}
