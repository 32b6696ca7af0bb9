//! Who belongs together.

use std::collections::BTreeMap;

use jrdb_graph::GraphIndex;
use jrdb_types::EdgeRelation;

use crate::SearchConfig;

/// Somebody's group.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Membership {
    /// How many people it has.
    pub(crate) size: u32,
    /// Its number among all groups: labelled ones by their label, others by one of their members.
    pub(crate) group: (bool, u32),
}

/// The group of each.
///
/// People with a group number are with those of the same number. Of the others those are together who do something with one
/// another, or are at most [`SearchConfig::close_m`] apart (where the graph has words only, "close"), directly or through
/// others. Of somebody without a number, a place and an edge nothing is known.
pub(crate) fn memberships(
    index: &GraphIndex<'_>,
    config: &SearchConfig,
) -> Vec<Option<Membership>> {
    let people = index.columns().people();
    let labelled = |number: usize| index.node(number).and_then(|node| node.group);
    let mut counts: BTreeMap<u32, u32> = BTreeMap::new();
    for group in people.iter().filter_map(labelled) {
        *counts.entry(group).or_default() += 1;
    }
    let is_free = |number: usize| {
        people.contains(number) && number < index.node_count() && labelled(number).is_none()
    };
    let roots = index.components(is_free, |relation| joins(relation, config));
    let mut members = vec![0; index.size()];
    people.iter().filter(|&n| n < index.node_count()).for_each(|n| members[roots[n]] += 1);
    (0..index.node_count())
        .map(|number| {
            let is_known = || {
                let has_edge = !index.outgoing(number).others.is_empty()
                    || !index.incoming(number).others.is_empty();
                has_edge || index.node(number).is_some_and(|node| node.center.is_some())
            };
            match labelled(number) {
                _ if !people.contains(number) => None,
                Some(group) => {
                    let size = counts.get(&group).copied()?;
                    Some(Membership { size, group: (true, group) })
                }
                None => is_known().then(|| {
                    let root = roots[number];
                    Membership { size: members[root], group: (false, root as u32) }
                }),
            }
        })
        .collect()
}

fn joins(relation: &EdgeRelation, config: &SearchConfig) -> bool {
    match relation {
        EdgeRelation::Interaction { .. } => true,
        EdgeRelation::Spatial(place) => match (place.distance_m, place.distance) {
            (Some(metres), _) => metres <= config.close_m,
            (None, Some(word)) => word.bounds_m().1 <= config.close_m,
            (None, None) => false,
        },
        EdgeRelation::Pair { .. } => false,
    }
}
