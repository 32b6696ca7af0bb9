//! Builders of conditions and patterns.

use jrdb_types::query::{Category, Measure, Pick, Place, Quantity, Related, RelationKind};
use jrdb_types::{Condition, Pattern};

/// Splits off the conditions from a position on. There are none if alternatives have joined them
/// with conditions before that position.
pub(crate) fn split_from(conditions: &mut Vec<Condition>, from: usize) -> Vec<Condition> {
    conditions.split_off(from.min(conditions.len()))
}

/// One condition that holds if all of these hold.
pub(crate) fn all_of(mut conditions: Vec<Condition>) -> Condition {
    match (conditions.len(), conditions.pop()) {
        (1, Some(only)) => only,
        (_, last) => {
            conditions.extend(last);
            Condition::All(conditions)
        }
    }
}

/// One condition that holds if any of these holds; nested alternatives are flattened.
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

/// Depth of nested conditions and patterns, including the pattern itself.
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
        Condition::Nearer(nearer) => levels(&nearer.to).max(levels(&nearer.than)),
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

/// Whether the two conditions exclude each other: two ages, two actions, two directions.
pub(crate) fn excludes(first: &Condition, second: &Condition) -> bool {
    use Condition::{Any, Attribute, FromRobot};
    match (first, second) {
        (Any(parts), second) => parts.iter().any(|part| excludes(part, second)),
        (Attribute(a), Attribute(b)) => {
            a.attribute() == b.attribute() && a.attribute().row().exclusive && a != b
        }
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

/// Applies the number of "the two women closest to me" to the pick.
pub(crate) fn set_count(pattern: &mut Pattern, count: Option<(u32, usize)>) {
    if let (Some(pick), Some((count, _))) = (&mut pattern.pick, count) {
        pick.count = count;
    }
}

/// A pattern for anything that matches one of these.
pub(crate) fn either(mut groups: Vec<Pattern>) -> Pattern {
    if groups.len() < 2 {
        return groups.pop().unwrap_or_default();
    }
    let first = groups[0].category.clone();
    let same = groups.iter().all(|group| group.category == first);
    let category = if same { first } else { Category::Anything };
    let parts = groups.into_iter().map(|group| alternative(group, &category)).collect();
    Pattern { conditions: vec![any_of(parts)], category, pick: None }
}

/// The condition under which an entity of a category matches the pattern.
pub(crate) fn alternative(pattern: Pattern, category: &Category) -> Condition {
    let is_plain = pattern.pick.is_none() && pattern.category == *category;
    if is_plain && !pattern.conditions.is_empty() {
        all_of(pattern.conditions)
    } else {
        Condition::Is(Box::new(pattern))
    }
}

/// Limit on the conditions of an antecedent, and on the parts of each. A question whose pronouns
/// stand for pronouns would grow without bound.
const ANTECEDENT_MAX: usize = 8;

/// What pronouns stand for: the pattern without its very long conditions.
pub(crate) fn truncated_antecedent(pattern: &Pattern) -> Pattern {
    let is_short = |condition: &&Condition| fits(condition, &mut { ANTECEDENT_MAX });
    let conditions = pattern.conditions.iter().take(ANTECEDENT_MAX).filter(is_short);
    let pick = pattern.pick.as_ref().filter(|pick| match &pick.measure {
        Measure::DistanceTo(groups) => pattern_fits(groups, &mut { ANTECEDENT_MAX }),
        _ => true,
    });
    Pattern {
        category: pattern.category.clone(),
        conditions: conditions.cloned().collect(),
        pick: pick.cloned(),
    }
}

/// Whether a condition has at most `left` parts; subtracts them.
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
        Condition::Nearer(nearer) => {
            pattern_fits(&nearer.to, left) && pattern_fits(&nearer.than, left)
        }
        Condition::Is(pattern) => pattern_fits(pattern, left),
        Condition::Not(inner) => fits(inner, left),
        Condition::Any(parts) | Condition::All(parts) => parts.iter().all(|part| fits(part, left)),
        _ => true,
    }
}

fn pattern_fits(pattern: &Pattern, left: &mut usize) -> bool {
    pattern.conditions.iter().all(|condition| fits(condition, left))
}

/// The condition that something is the one picked of its category.
pub(crate) fn chosen(pick: Pick, category: &Category) -> Condition {
    let all = Pattern::of(category.clone());
    Condition::Is(Box::new(Pattern { pick: Some(pick), ..all }))
}

/// Makes a pattern with a pick a condition, so that later conditions describe the one picked.
pub(crate) fn identify(pattern: &mut Pattern) {
    let category = pattern.category.clone();
    let chosen = std::mem::replace(pattern, Pattern::of(category));
    pattern.conditions.push(Condition::Is(Box::new(chosen)));
}

/// The label of an interaction without a described partner.
pub(crate) fn bare_label(condition: &Condition) -> Option<&str> {
    let Condition::Related(related) = condition else { return None };
    match &related.kinds[..] {
        [RelationKind::Interaction(label)] if related.partner.conditions.is_empty() => Some(label),
        _ => None,
    }
}
