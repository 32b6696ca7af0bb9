//! The reply to what was asked: a number, yes or no, values of properties, places.

use jrdb_graph::BitSet;
use jrdb_types::answer::{
    Count, DirectionFound, DistanceFound, Landmark, PropertyValue, PropertyValues, Reply,
};
use jrdb_types::query::{Order, Property};
use jrdb_types::{AttributeBelief, Node, Query, SpatialRelation, Task};

use crate::candidates::by_sets;
use crate::searcher::Searcher;

/// The reply, given who is meant.
pub(crate) fn reply(searcher: &Searcher<'_, '_>, query: &Query, selection: &BitSet) -> Reply {
    match &query.task {
        Task::Find => Reply::Things,
        Task::Count => Reply::Number(Count::Exact(selection.count())),
        Task::Exists(quantity) => Reply::YesNo(Some(quantity.holds(selection.count()))),
        Task::CompareCounts { order, than } => {
            let others = by_sets(searcher, than).count();
            Reply::YesNo(Some(compare(selection.count(), *order, others)))
        }
        Task::Where => {
            Reply::Properties(selection.iter().filter_map(|n| place(searcher, n)).collect())
        }
        Task::Which { properties, .. } => {
            let values = selection.iter().flat_map(|number| {
                properties
                    .iter()
                    .filter_map(move |property| property_of(searcher, number, *property))
            });
            Reply::Properties(values.collect())
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
) -> Option<PropertyValues> {
    let node = searcher.index.node(number)?;
    let (known, place) = (&node.attributes, searcher.seen_by_robot(node));
    let values = match property {
        Property::Attribute(attribute) => likely(known.belief(attribute)),
        Property::Distance => place
            .and_then(|p| DistanceFound::of(&p))
            .map(PropertyValue::Distance)
            .into_iter()
            .collect(),
        Property::Direction => place
            .and_then(|p| DirectionFound::of(&p))
            .map(PropertyValue::Direction)
            .into_iter()
            .collect(),
        Property::SocialInteraction => interactions(searcher, number, Others::People),
        Property::ObjectInteraction => interactions(searcher, number, Others::Objects),
        Property::PeopleAround => around(searcher, number, Others::People),
        Property::ObjectsAround => around(searcher, number, Others::Objects),
        Property::Category => vec![PropertyValue::Category(node.category.clone())],
    };
    Some(values_of(node, Some(property), values))
}

fn values_of(
    node: &Node,
    property: Option<Property>,
    values: Vec<PropertyValue>,
) -> PropertyValues {
    PropertyValues { id: node.id.clone(), property, values, words: Vec::new() }
}

/// The most probable value; what is at least half as probable follows.
fn likely(belief: AttributeBelief<'_>) -> Vec<PropertyValue> {
    let mut values = belief.entries().to_vec();
    values.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    let least = values.first().map_or(0.0, |(_, p)| p / 2.0);
    let values = values.into_iter().filter(|(_, p)| *p > 0.0 && *p >= least);
    values.map(|(value, probability)| PropertyValue::Attribute { value, probability }).collect()
}

/// Which other things a property is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Others {
    People,
    Objects,
}

impl Others {
    fn include(self, searcher: &Searcher<'_, '_>, number: usize) -> bool {
        searcher.index.columns().people().contains(number) == (self == Self::People)
    }
}

/// What a person does with people, or with objects.
fn interactions(searcher: &Searcher<'_, '_>, number: usize, others: Others) -> Vec<PropertyValue> {
    let mut numbers = searcher.index.outgoing(number).others.to_vec();
    numbers.dedup();
    let numbers = numbers.into_iter().map(|other| other as usize);
    let mut found: Vec<PropertyValue> = numbers
        .filter(|&other| others.include(searcher, other))
        .filter_map(|other| Some((other, searcher.index.id(other)?)))
        .flat_map(|(other, partner)| {
            let labels = searcher.interactions(number, other);
            labels.map(|label| PropertyValue::Interaction {
                label: label.into(),
                partner: partner.clone(),
            })
        })
        .collect();
    found.dedup();
    found
}

/// Where the others are that somebody has at "close" distance or nearer, nearest first.
fn around(searcher: &Searcher<'_, '_>, number: usize, others: Others) -> Vec<PropertyValue> {
    let row = searcher.index.outgoing(number);
    let mut seen: Vec<(f64, u32, PropertyValue)> = Vec::new();
    for &other in row.others {
        if !others.include(searcher, other as usize) || seen.iter().any(|(_, n, _)| *n == other) {
            continue;
        }
        let near = searcher.index.spatial(row.with(other)).next().filter(|relation| {
            relation.distance.is_some_and(|word| word.bounds_m().1 <= searcher.config.close_m)
        });
        if let (Some(relation), Some(id)) = (near, searcher.index.id(other as usize)) {
            let metres = relation.distance_m.unwrap_or(f64::INFINITY);
            let value = PropertyValue::Around {
                id: id.clone(),
                direction: DirectionFound::of(relation),
                distance: DistanceFound::of(relation),
            };
            seen.push((metres, other, value));
        }
    }
    seen.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    seen.into_iter().map(|(_, _, value)| value).collect()
}

/// Where a thing is: how far, in which direction, and what it is nearest to.
pub(crate) fn place(searcher: &Searcher<'_, '_>, number: usize) -> Option<PropertyValues> {
    let node = searcher.index.node(number)?;
    let place = searcher.seen_by_robot(node);
    let value = place.and_then(|place| place_value(searcher, number, node, &place));
    Some(values_of(node, None, value.into_iter().collect()))
}

fn place_value(
    searcher: &Searcher<'_, '_>,
    number: usize,
    node: &Node,
    place: &SpatialRelation,
) -> Option<PropertyValue> {
    let (distance, direction) = (DistanceFound::of(place), DirectionFound::of(place));
    let is_known = distance.is_some() || direction.is_some() || node.center.is_some();
    let landmark = landmark(searcher, number);
    is_known.then_some(PropertyValue::Place { distance, direction, landmark })
}

/// The nearest thing, within twice the "close" distance.
fn landmark(searcher: &Searcher<'_, '_>, number: usize) -> Option<Landmark> {
    let close_m = searcher.config.close_m;
    let (metres, other) = (0..searcher.index.node_count())
        .filter(|&other| other != number)
        .filter_map(|other| Some((searcher.apart_m(number, other)?, other)))
        .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))
        .filter(|(metres, _)| *metres <= 2.0 * close_m)?;
    let id = searcher.index.id(other)?.clone();
    Some(Landmark { id, metres, is_close: metres <= close_m })
}
