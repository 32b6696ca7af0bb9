//! The reply to what was asked: a number, yes or no, values of properties, places.

use std::collections::BTreeSet;

use jrdb_graph::BitSet;
use jrdb_types::answer::{
    Count, DirectionFound, DistanceFound, HeadingFound, Landmark, PropertyValue, PropertyValues,
    Reply,
};
use jrdb_types::query::{Order, Property};
use jrdb_types::vocab::MatchPolicy;
use jrdb_types::{AttributeBelief, Condition, DistanceWord, Node, Query, SpatialRelation, Task};

use crate::candidates::by_sets;
use crate::known::Known;
use crate::searcher::Searcher;
use crate::status::Meant;

/// The reply, given who is meant.
pub(crate) fn reply(searcher: &Searcher<'_, '_>, query: &Query, selection: &BitSet) -> Reply {
    match &query.task {
        Task::Find if query.command.is_none() => Reply::Things,
        Task::Each { .. } => Reply::YesNo(None),
        Task::Groups => Reply::Number(groups(searcher, selection)),
        Task::Choice { options } => Reply::Properties(
            selection.iter().filter_map(|n| choice(searcher, n, options)).collect(),
        ),
        Task::From { property, partner } => {
            let partners = Meant::by(&searcher.with(MatchPolicy::Strict), partner).sure;
            let told = selection.iter().filter_map(|n| from(searcher, n, *property, &partners));
            Reply::Properties(told.collect())
        }
        Task::Count => Reply::Number(Count::Exact(selection.count())),
        Task::Exists(quantity) => Reply::YesNo(Some(quantity.holds(selection.count()))),
        Task::CompareCounts { order, than } => {
            let others = by_sets(searcher, than).count();
            Reply::YesNo(Some(compare(selection.count(), *order, others)))
        }
        Task::Find | Task::Where => {
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
        Property::Height => node.height_m.map(PropertyValue::Height).into_iter().collect(),
        Property::Speed => {
            let speed = node.velocity_mps.map(|[x, y]| x.hypot(y));
            speed.map(PropertyValue::Speed).into_iter().collect()
        }
        Property::Facing => heading(node).map(PropertyValue::Heading).into_iter().collect(),
    };
    Some(values_of(node, Some(property), values))
}

/// Which way somebody faces.
fn heading(node: &Node) -> Option<HeadingFound> {
    let heading = node.heading_rad?;
    let off = |[x, y, _]: [f64; 3]| {
        let (sine, cosine) = (heading - (-y).atan2(-x)).sin_cos();
        sine.atan2(cosine).abs().to_degrees()
    };
    Some(HeadingFound { degrees: heading.to_degrees(), off_robot: node.center.map(off) })
}

/// The alternatives that hold of a thing; that none does where none can.
fn choice(
    searcher: &Searcher<'_, '_>,
    number: usize,
    options: &[Condition],
) -> Option<PropertyValues> {
    let node = searcher.index.node(number)?;
    let mut only = BitSet::new(searcher.index.size());
    only.insert(number);
    let strict = searcher.with(MatchPolicy::Strict);
    let known: Vec<Known> = options.iter().map(|option| strict.known(option, &only)).collect();
    let held = options.iter().zip(&known).filter(|(_, known)| known.yes.contains(number));
    let mut values: Vec<PropertyValue> =
        held.map(|(option, _)| PropertyValue::Option(option.clone())).collect();
    if values.is_empty() && known.iter().all(|known| known.no.contains(number)) {
        let any = Condition::Any(options.to_vec());
        values.push(PropertyValue::Option(Condition::Not(Box::new(any))));
    }
    Some(values_of(node, None, values))
}

/// How far a thing is from others, or in which direction from them.
fn from(
    searcher: &Searcher<'_, '_>,
    number: usize,
    property: Property,
    partners: &BitSet,
) -> Option<PropertyValues> {
    let node = searcher.index.node(number)?;
    let place = |other: usize| {
        let id = searcher.index.id(other)?.clone();
        let row = searcher.index.outgoing(other).with(number as u32);
        let edge = searcher.index.spatial(row).next();
        let (direction, distance) = match property {
            Property::Direction => (Some(edge.and_then(DirectionFound::of)?), None),
            _ => {
                let metres = searcher.apart_m(number, other)?;
                let word = DistanceWord::of_metres(metres);
                (None, Some(DistanceFound { word, metres: Some(metres) }))
            }
        };
        Some(PropertyValue::Around { id, direction, distance })
    };
    let others = partners.iter().filter(|&other| other != number);
    Some(values_of(node, Some(property), others.filter_map(place).collect()))
}

/// How many groups of two or more there are among some people; at least so many, if the group of
/// one is unknown or perception sees no groups.
fn groups(searcher: &Searcher<'_, '_>, people: &BitSet) -> Count {
    let members: Vec<_> = people.iter().map(|number| searcher.membership(number)).collect();
    let known = members.iter().flatten().filter(|one| one.size > 1).map(|one| one.group);
    let number = known.collect::<BTreeSet<_>>().len();
    let is_known = searcher.sees_groups() && members.iter().all(Option::is_some);
    if is_known { Count::Exact(number) } else { Count::between(0, None) }
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
