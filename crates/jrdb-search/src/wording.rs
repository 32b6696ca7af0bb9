//! Conditions and findings in words, for the trace.

use jrdb_types::query::{Category, RelationKind, Viewpoint};
use jrdb_types::{Belief, Condition, DistanceWord, Pattern, Query, SpatialRelation, Task};

/// A query in words: what is asked of which kind of thing, then one line per condition.
///
/// ```
/// use jrdb_types::{Condition, Gender, Query};
/// let mut query = Query::default();
/// query.target.conditions.push(Condition::Gender(Gender::Male));
/// assert_eq!(jrdb_search::describe(&query), "find a person with\n  gender male");
/// ```
#[must_use]
pub fn describe(query: &Query) -> String {
    let task = match query.task {
        Task::Find => "find",
        Task::Count => "count",
    };
    let kind =
        pattern(&Pattern { category: query.target.category.clone(), conditions: Vec::new() });
    let conditions =
        query.target.conditions.iter().map(|condition| format!("\n  {}", asked(condition)));
    let with = if query.target.conditions.is_empty() { "" } else { " with" };
    format!("{task} {kind}{with}{}", conditions.collect::<String>())
}

/// What a condition asks for.
pub(crate) fn asked(condition: &Condition) -> String {
    match condition {
        Condition::Age(value) => format!("age {value}"),
        Condition::Gender(value) => format!("gender {value}"),
        Condition::Race(value) => format!("race {value}"),
        Condition::Action(value) => format!("action {value}"),
        Condition::RobotDistance(value) => format!("{value} distance from the robot"),
        Condition::RobotDirection(value) => format!("{value} of the robot"),
        Condition::Relation(relation) => {
            asked_relation(&relation.kind, &pattern(&relation.partner))
        }
    }
}

fn asked_relation(kind: &RelationKind, partner: &str) -> String {
    match kind {
        RelationKind::Interaction { label } => format!("{label} with {partner}"),
        RelationKind::Spatial { distance, direction, viewpoint } => {
            let place = match (direction, viewpoint) {
                (None, _) => return near(*distance, partner),
                (Some(direction), Viewpoint::Subject) => {
                    format!("has {partner} to its {direction}")
                }
                (Some(direction), Viewpoint::Partner) => format!("{direction} of {partner}"),
            };
            let distance = distance.map(|distance| format!(" at {distance} distance"));
            format!("{place}{}", distance.unwrap_or_default())
        }
    }
}

fn near(distance: Option<DistanceWord>, partner: &str) -> String {
    let distance = distance.map_or_else(|| "any".into(), |distance| distance.to_string());
    format!("{distance} distance from {partner}")
}

/// A pattern as a noun phrase, `a young, female person`.
pub(crate) fn pattern(pattern: &Pattern) -> String {
    let noun = match &pattern.category {
        Category::Person => "person",
        Category::Object => "object",
        Category::Class(name) => name,
    };
    let words: Vec<String> = pattern.conditions.iter().map(word).collect();
    let conditions =
        if words.is_empty() { String::new() } else { format!("{} ", words.join(", ")) };
    format!("a {conditions}{noun}")
}

fn word(condition: &Condition) -> String {
    match condition {
        Condition::Age(value) => value.to_string(),
        Condition::Gender(value) => value.to_string(),
        Condition::Race(value) => value.to_string(),
        Condition::Action(value) => value.to_string(),
        other => format!("({})", asked(other)),
    }
}

/// The most probable value, with its probability when it is not certain.
pub(crate) fn belief<T: Ord + Copy + std::fmt::Display>(belief: &Belief<T>) -> Option<String> {
    let best = belief.best()?;
    match belief.probability(best) {
        1.0 => Some(best.to_string()),
        p => Some(format!("{best} ({p:.2})")),
    }
}

/// A distance in words and metres.
pub(crate) fn distance(relation: &SpatialRelation) -> Option<String> {
    let word = relation.distance?;
    Some(relation.distance_m.map_or_else(|| word.to_string(), |m| format!("{word}, {m:.2} m")))
}

/// A direction in words and degrees, counter-clockwise from the front.
pub(crate) fn direction(relation: &SpatialRelation) -> Option<String> {
    let word = relation.direction?;
    let degrees = relation.bearing_rad.map(|b| format!("{word}, {:+.0}°", b.to_degrees()));
    Some(degrees.unwrap_or_else(|| word.to_string()))
}

/// Distance and direction.
pub(crate) fn place(relation: &SpatialRelation) -> Option<String> {
    let parts = [distance(relation), direction(relation)];
    let known: Vec<String> = parts.into_iter().flatten().collect();
    (!known.is_empty()).then(|| known.join("; "))
}
