//! Conditions made of conditions.

use jrdb_types::query::{Place, RelationKind};
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

/// Makes one condition of the last and the one before it, when "or" is between them or nothing can be both.
pub(crate) fn join(conditions: &mut Vec<Condition>, length: usize, is_or: bool) {
    if length == 0 || conditions.len() != length + 1 {
        return;
    }
    if !(is_or || excludes(&conditions[length - 1], &conditions[length])) {
        return;
    }
    let parts = split_from(conditions, length.saturating_sub(1));
    conditions.push(any_of(parts));
}

/// Whether no thing can be both: two ages, two deeds of the body, two directions.
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
