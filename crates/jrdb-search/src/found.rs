//! What was found, in words.

use jrdb_types::SpatialRelation;
use jrdb_types::answer::{Measured, Unit};
use jrdb_types::query::Place;

/// What a place is, as far as it answers what was asked: distances for distances, directions for directions.
pub(crate) fn place(asked: &Place, relation: &SpatialRelation) -> Option<String> {
    match asked {
        Place::Distance(_) | Place::Metres(_) => distance(relation),
        Place::Direction(_) | Place::Degrees { .. } => direction(relation),
    }
}

/// A distance in words and metres.
pub(crate) fn distance(relation: &SpatialRelation) -> Option<String> {
    match (relation.distance, relation.distance_m) {
        (Some(word), Some(metres)) => Some(format!("{word}, {metres:.2} m")),
        (Some(word), None) => Some(word.to_string()),
        (None, metres) => metres.map(|metres| format!("{metres:.2} m")),
    }
}

/// A direction in words and degrees, counter-clockwise from the front.
pub(crate) fn direction(relation: &SpatialRelation) -> Option<String> {
    let degrees = relation.bearing_rad.map(f64::to_degrees);
    match (relation.direction, degrees) {
        (Some(word), Some(degrees)) => Some(format!("{word}, {degrees:+.0}°")),
        (Some(word), None) => Some(word.to_string()),
        (None, degrees) => degrees.map(|degrees| format!("{degrees:+.0}°")),
    }
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

/// How far inside or outside its bounds a number is, and where the nearer bound is: `0.28 m inside, bound 1.50 m`. Of beliefs and of
/// places in an order nothing: they tell themselves.
pub(crate) fn margin(measured: &Measured) -> String {
    if matches!(measured.unit, Unit::Probability | Unit::Count) {
        return String::new();
    }
    let size = number(measured.margin.abs(), measured.unit);
    let bound = nearer_bound(measured).map(|bound| match measured.unit {
        Unit::Degrees => format!("{bound:+.0}°"),
        unit => number(bound, unit),
    });
    let side = if measured.margin < 0.0 { "outside" } else { "inside" };
    bound.map(|bound| format!("{size} {side}, bound {bound}")).unwrap_or_default()
}

/// The bound that the margin is counted from.
fn nearer_bound(measured: &Measured) -> Option<f64> {
    let bounds = [measured.bounds.min, measured.bounds.max].into_iter().flatten();
    bounds.min_by(|a, b| (a - measured.value).abs().total_cmp(&(b - measured.value).abs()))
}
