//! The reply to what was asked: a number, yes or no, properties, places.

use jrdb_graph::BitSet;
use jrdb_types::answer::{Reply, Told};
use jrdb_types::query::{Order, Property};
use jrdb_types::{AttributeBelief, EntityId, Node, Query, SpatialRelation, Task};

use crate::search::by_sets;
use crate::searcher::Searcher;

/// The reply, given who is meant.
pub(crate) fn reply(searcher: &Searcher<'_, '_>, query: &Query, selection: &BitSet) -> Reply {
    match &query.task {
        Task::Find => Reply::Things,
        Task::Count => Reply::Number(selection.count()),
        Task::Exists(quantity) => Reply::YesNo(quantity.holds(selection.count())),
        Task::CompareCounts { order, than } => {
            let others = by_sets(searcher, than).count();
            Reply::YesNo(compare(selection.count(), *order, others))
        }
        Task::Where => Reply::Told(selection.iter().filter_map(|n| place(searcher, n)).collect()),
        Task::Which { properties, .. } => {
            let told = selection.iter().flat_map(|number| {
                properties
                    .iter()
                    .filter_map(move |property| property_of(searcher, number, *property))
            });
            Reply::Told(told.collect())
        }
    }
}

/// More, or fewer, than the others.
pub(crate) fn compare(number: usize, order: Order, others: usize) -> bool {
    match order {
        Order::Least => number < others,
        Order::Most => number > others,
    }
}

/// One property of one thing.
pub(crate) fn property_of(
    searcher: &Searcher<'_, '_>,
    number: usize,
    property: Property,
) -> Option<Told> {
    let node = searcher.index.node(number)?;
    let (known, place) = (&node.attributes, searcher.seen_by_robot(node));
    let words = match property {
        Property::Attribute(attribute) => belief(known.belief(attribute)),
        Property::Distance => place.and_then(|p| distance(&p)).into_iter().collect(),
        Property::Direction => place.and_then(|p| direction(&p)).into_iter().collect(),
        Property::SocialInteraction => deeds(searcher, number, true),
        Property::ObjectInteraction => deeds(searcher, number, false),
        Property::PeopleAround => around(searcher, number, true),
        Property::ObjectsAround => around(searcher, number, false),
        Property::Category => vec![node.category.clone()],
    };
    Some(Told { id: node.id.clone(), property: Some(property), words })
}

/// The most probable value; what is at least half as probable follows with its probability.
fn belief(belief: AttributeBelief<'_>) -> Vec<String> {
    let mut values = belief.entries().to_vec();
    values.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    let likely = values.first().map_or(0.0, |(_, p)| p / 2.0);
    let values = values.into_iter().filter(|(_, p)| *p > 0.0 && *p >= likely);
    values
        .map(|(value, p)| if p == 1.0 { value.to_string() } else { format!("{value} ({p:.2})") })
        .collect()
}

fn distance(place: &SpatialRelation) -> Option<String> {
    match (place.distance_m, place.distance) {
        (Some(metres), Some(word)) => Some(format!("{metres:.1} m, {word}")),
        (Some(metres), None) => Some(format!("{metres:.1} m")),
        (None, word) => word.map(|word| word.to_string()),
    }
}

/// `front left, 34° to the left`.
fn direction(place: &SpatialRelation) -> Option<String> {
    let degrees = place.bearing_rad.map(|bearing| {
        let degrees = bearing.to_degrees().round();
        let side = if degrees < 0.0 { "right" } else { "left" };
        if degrees == 0.0 {
            "straight ahead".into()
        } else {
            format!("{:.0}° to the {side}", degrees.abs())
        }
    });
    let words: Vec<String> =
        place.direction.map(|word| word.to_string()).into_iter().chain(degrees).collect();
    (!words.is_empty()).then(|| words.join(", "))
}

/// What somebody does with people, or with objects.
fn deeds(searcher: &Searcher<'_, '_>, number: usize, with_people: bool) -> Vec<String> {
    let people = searcher.index.columns().people();
    let mut others = searcher.index.outgoing(number).others.to_vec();
    others.dedup();
    let others = others.into_iter().map(|other| other as usize);
    let others = others.filter(|&other| people.contains(other) == with_people);
    let mut told: Vec<String> = others
        .flat_map(|other| {
            let name = name(searcher, other);
            searcher.deeds(number, other).map(move |label| format!("{label}: {name}"))
        })
        .collect();
    told.dedup();
    told
}

fn name(searcher: &Searcher<'_, '_>, number: usize) -> String {
    searcher.index.id(number).map(EntityId::short).unwrap_or_default()
}

/// Where the others are that somebody has at "close" distance or nearer, nearest first.
fn around(searcher: &Searcher<'_, '_>, number: usize, people: bool) -> Vec<String> {
    let set = searcher.index.columns().people();
    let row = searcher.index.outgoing(number);
    let mut seen: Vec<(f64, u32, String)> = Vec::new();
    for &other in row.others {
        if set.contains(other as usize) != people || seen.iter().any(|(_, n, _)| *n == other) {
            continue;
        }
        let near = searcher.index.spatial(row.with(other)).next().filter(|relation| {
            relation.distance.is_some_and(|word| word.bounds_m().1 <= searcher.config.close_m)
        });
        if let Some(relation) = near {
            let place = [direction(relation), distance(relation)].into_iter().flatten();
            let place = place.collect::<Vec<_>>().join(", ");
            let metres = relation.distance_m.unwrap_or(f64::INFINITY);
            seen.push((metres, other, format!("{}: {place}", name(searcher, other as usize))));
        }
    }
    seen.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    seen.into_iter().map(|(_, _, words)| words).collect()
}

/// Where a thing is: how far, in which direction, and what it is nearest to.
pub(crate) fn place(searcher: &Searcher<'_, '_>, number: usize) -> Option<Told> {
    let node = searcher.index.node(number)?;
    let place = searcher.seen_by_robot(node);
    let words = place.and_then(|place| sentence(searcher, number, node, &place));
    Some(Told { id: node.id.clone(), property: None, words: words.into_iter().collect() })
}

fn sentence(
    searcher: &Searcher<'_, '_>,
    number: usize,
    node: &Node,
    place: &SpatialRelation,
) -> Option<String> {
    let parts: Vec<String> = [distance(place), direction(place)].into_iter().flatten().collect();
    let landmark = (0..searcher.index.node_count())
        .filter(|&other| other != number)
        .filter_map(|other| Some((searcher.apart_m(number, other)?, other)))
        .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))
        .filter(|(metres, _)| *metres <= 2.0 * searcher.config.close_m);
    let beside = landmark.map(|(metres, other)| {
        let how = if metres <= searcher.config.close_m { "next to" } else { "near" };
        format!(", {how} {} ({metres:.1} m)", name(searcher, other))
    });
    let is_known = !parts.is_empty() || node.center.is_some();
    is_known.then(|| format!("{}{}", parts.join("; "), beside.unwrap_or_default()))
}
