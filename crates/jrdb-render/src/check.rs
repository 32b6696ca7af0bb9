//! Checks of a trace, in words: what was asked, what was found, and the margin.

use jrdb_types::answer::{
    Check, Criterion, DirectionFound, DistanceFound, Finding, Measured, Partner, Unit,
};
use jrdb_types::query::RelationKind;
use jrdb_types::{AttributeValue, AttributeWording, Condition, EntityId};

use crate::{query, wording};

/// What a check is about, in words: `age young`, `next to #3`.
#[must_use]
pub fn asked(check: &Check) -> String {
    match &check.criterion {
        Criterion::Unstated => check.asked.clone(),
        other => criterion(other),
    }
}

/// A part of a query in words; nothing for one that is not stated.
pub(crate) fn criterion(criterion: &Criterion) -> String {
    match criterion {
        Criterion::Unstated => String::new(),
        Criterion::Condition(condition) => wording::condition(condition),
        Criterion::Relation { kind, partner } => wording::kind(kind, &name(partner)),
        Criterion::Pick(pick) => wording::pick(pick),
        Criterion::Slot { slot, number } => query::slot(slot, *number),
    }
}

/// What was found, in words: `young (0.80)`, `close, 1.05 m`; `None` when nothing is known.
#[must_use]
pub fn found(check: &Check) -> Option<String> {
    if check.criterion == Criterion::Unstated {
        return check.found.clone();
    }
    if let Some(finding) = &check.finding {
        return Some(self::finding(finding, &check.criterion));
    }
    let parts = check.parts.iter().filter(|part| counts(check, part));
    let mut words: Vec<String> = parts.filter_map(found).collect();
    if !is_related(check) {
        words.dedup();
    }
    (!words.is_empty() && composes(check)).then(|| words.join("; "))
}

/// What was found, or that nothing is known.
pub(crate) fn found_or_unknown(check: &Check) -> String {
    found(check).unwrap_or_else(|| "unknown".into())
}

/// Whether a check states what its parts found.
fn composes(check: &Check) -> bool {
    let Criterion::Condition(condition) = &check.criterion else { return false };
    matches!(
        **condition,
        Condition::Related(_) | Condition::Not(_) | Condition::Any(_) | Condition::All(_)
    )
}

fn is_related(check: &Check) -> bool {
    matches!(&check.criterion, Criterion::Condition(c) if matches!(**c, Condition::Related(_)))
}

/// Of a relation the parts with the witness count, and not the witness's own conditions.
fn counts(check: &Check, part: &Check) -> bool {
    !is_related(check) || matches!(part.criterion, Criterion::Relation { .. })
}

fn finding(finding: &Finding, criterion: &Criterion) -> String {
    match finding {
        Finding::Holds(false) => "no".into(),
        Finding::Holds(true) => affirmed(criterion),
        Finding::Attribute { value, probability } => attribute(*value, *probability),
        Finding::Looks { probability, source } => format!("{probability:.2}, says {source}"),
        Finding::Distance(found) => distance(found),
        Finding::Direction(found) => direction(found),
        Finding::RobotIn(found) => format!("the robot at {}", direction(found)),
        Finding::Group(size) => format!("{size} together"),
        Finding::Interactions(labels) => labels.join(", "),
        Finding::Between([one, other]) => format!("between {} and {}", name(one), name(other)),
        Finding::Comparison { own, other, unit } => {
            let other = other.map(|other| format!(" against {}", number(other, *unit)));
            format!("{}{}", number(*own, *unit), other.unwrap_or_default())
        }
        Finding::Order { place, count, value, unit } => {
            let place = place.map(|place| format!("number {place} of {count}"));
            let value = value.map(|value| number(value, *unit));
            place.into_iter().chain(value).collect::<Vec<_>>().join(", ")
        }
        Finding::Frames { matched, seen, shown } => {
            let shown = shown.map(|frame| format!("; here frame {frame}")).unwrap_or_default();
            format!("in {matched} of {seen} frames{shown}")
        }
    }
}

/// That what was asked holds.
fn affirmed(criterion: &Criterion) -> String {
    match criterion {
        Criterion::Relation { kind: RelationKind::Pair(word), .. } => word.to_string(),
        _ => "it is".into(),
    }
}

/// A value, with its probability when it is not certain.
pub(crate) fn attribute(value: AttributeValue, probability: f64) -> String {
    if probability == 1.0 { value.to_string() } else { format!("{value} ({probability:.2})") }
}

/// `close, 1.05 m`.
fn distance(found: &DistanceFound) -> String {
    let metres = found.metres.map(|metres| format!("{metres:.2} m"));
    both(found.word.map(|word| word.to_string()), metres)
}

/// `left, +88°`: degrees counter-clockwise from the front.
fn direction(found: &DirectionFound) -> String {
    let degrees = found.degrees.map(|degrees| format!("{degrees:+.0}°"));
    both(found.word.map(|word| word.to_string()), degrees)
}

fn both(word: Option<String>, number: Option<String>) -> String {
    word.into_iter().chain(number).collect::<Vec<_>>().join(", ")
}

fn name(partner: &Partner) -> String {
    match partner {
        Partner::Robot => "the robot".into(),
        Partner::Thing(id) => id.short(),
    }
}

/// Whether what was found repeats what was asked word for word: "age young" and "young".
pub(crate) fn repeats_itself(check: &Check) -> bool {
    let Criterion::Condition(condition) = &check.criterion else { return false };
    let Condition::Attribute(asked) = **condition else { return false };
    let is_certain = Finding::Attribute { value: asked, probability: 1.0 };
    asked.attribute().row().wording == AttributeWording::Adjective
        && check.finding.as_ref() == Some(&is_certain)
}

/// A number with its unit.
pub(crate) fn number(value: f64, unit: Unit) -> String {
    match unit {
        Unit::Metres => format!("{value:.2} m"),
        Unit::Degrees => format!("{value:.0}°"),
        Unit::Probability => format!("{value:.2}"),
        Unit::Count => format!("{value:.0}"),
        Unit::MetresPerSecond => format!("{value:.2} m/s"),
        Unit::AgeGroup => format!("age group {value:.0}"),
    }
}

/// How far inside or outside its bounds a number is, and where the nearer bound is: `0.28 m inside, bound 1.50 m`. Nothing for
/// beliefs and places in an order, whose findings state it.
pub(crate) fn margin(measured: &Measured) -> Option<String> {
    if matches!(measured.unit, Unit::Probability | Unit::Count) {
        return None;
    }
    let size = number(measured.margin.abs(), measured.unit);
    let bound = nearer_bound(measured)?;
    let bound = match measured.unit {
        Unit::Degrees => format!("{bound:+.0}°"),
        unit => number(bound, unit),
    };
    let side = if measured.margin < 0.0 { "outside" } else { "inside" };
    Some(format!("{size} {side}, bound {bound}"))
}

/// The bound that the margin is counted from.
fn nearer_bound(measured: &Measured) -> Option<f64> {
    let bounds = [measured.bounds.min, measured.bounds.max].into_iter().flatten();
    bounds.min_by(|a, b| (a - measured.value).abs().total_cmp(&(b - measured.value).abs()))
}

/// Ids as people read them: `#1, table:2`.
pub(crate) fn ids(ids: &[EntityId], separator: &str) -> String {
    ids.iter().map(EntityId::short).collect::<Vec<_>>().join(separator)
}
