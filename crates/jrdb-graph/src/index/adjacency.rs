//! Edges as rows of numbers.

use jrdb_types::{Direction, DistanceWord, EdgeRelation, SpatialRelation};

use super::columns::{DIRECTIONS, direction_code};

/// Distance words, and one place for an unknown distance.
const DISTANCES: usize = 6;
/// Places of a node's spatial edges: every direction and an unknown one, with every distance.
const CODES: usize = (DIRECTIONS + 1) * DISTANCES;

/// Code of an edge that tells no place.
const NO_PLACE: u32 = u32::MAX;

/// An edge with its ends as numbers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ends {
    pub(super) from: u32,
    pub(super) to: u32,
    /// Place in the scene's list.
    pub(super) edge: u32,
    /// What it says of the place.
    pub(super) code: u32,
}

/// The edges of each node, sorted by the other end, then as in the scene.
#[derive(Debug, Default)]
pub(super) struct Rows {
    starts: Vec<u32>,
    others: Vec<u32>,
    edges: Vec<u32>,
}

/// One node's edges to or from others, sorted by the other end.
#[derive(Debug, Clone, Copy)]
pub struct Row<'a> {
    /// The other ends, as numbers; once per edge.
    pub others: &'a [u32],
    /// The edges, as places in the scene's list.
    pub edges: &'a [u32],
}

impl Row<'_> {
    /// The part of the row that leads to one other end.
    #[must_use]
    pub fn with(self, other: u32) -> Self {
        let low = self.others.partition_point(|&end| end < other);
        let length = self.others[low..].iter().take_while(|&&end| end == other).count();
        Self { others: &self.others[low..low + length], edges: &self.edges[low..low + length] }
    }
}

impl Rows {
    pub(super) fn row(&self, number: usize) -> Row<'_> {
        let bounds = (self.starts.get(number), self.starts.get(number + 1));
        let (Some(&low), Some(&high)) = bounds else { return Row { others: &[], edges: &[] } };
        let range = low as usize..high as usize;
        Row { others: &self.others[range.clone()], edges: &self.edges[range] }
    }
}

/// The spatial edges from each node, sorted by direction, then distance, then the other end.
#[derive(Debug, Default)]
pub(super) struct Runs {
    starts: Vec<u32>,
    others: Vec<u32>,
}

impl Runs {
    /// The other ends of a node's edges in a direction, at a distance or at any.
    #[inline]
    pub(super) fn run(
        &self,
        number: usize,
        direction: Direction,
        distance: Option<DistanceWord>,
    ) -> &[u32] {
        let first = number * CODES + direction_code(direction) * DISTANCES;
        let (low, high) = match distance {
            Some(word) => (first + word as usize, first + word as usize + 1),
            None => (first, first + DISTANCES),
        };
        match (self.starts.get(low), self.starts.get(high)) {
            (Some(&low), Some(&high)) => &self.others[low as usize..high as usize],
            _ => &[],
        }
    }
}

/// Edges in the order of their ends.
pub(super) fn in_order(ends: Vec<Ends>, size: usize) -> Vec<Ends> {
    if ends.is_sorted_by_key(|ends| (ends.from, ends.to)) {
        return ends;
    }
    let by_to = sorted(&ends, size, |ends| ends.to as usize).1;
    sorted(&by_to, size, |ends| ends.from as usize).1
}

/// Rows of outgoing edges, from edges in order.
pub(super) fn outgoing(in_order: &[Ends], size: usize) -> Rows {
    let others = in_order.iter().map(|ends| ends.to).collect();
    let edges = in_order.iter().map(|ends| ends.edge).collect();
    Rows { starts: starts(in_order, size, |ends| ends.from as usize), others, edges }
}

/// Rows of incoming edges, from edges in order.
pub(super) fn incoming(in_order: &[Ends], size: usize) -> Rows {
    let (starts, by_to) = sorted(in_order, size, |ends| ends.to as usize);
    let others = by_to.iter().map(|ends| ends.from).collect();
    Rows { starts, others, edges: by_to.iter().map(|ends| ends.edge).collect() }
}

/// Runs of spatial edges, from edges in order.
pub(super) fn runs(in_order: &[Ends], size: usize) -> Runs {
    let spatial = || in_order.iter().filter(|ends| ends.code != NO_PLACE);
    let key = |ends: &Ends| ends.from as usize * CODES + ends.code as usize;
    let starts = starts(spatial(), size * CODES, key);
    let mut next = starts.clone();
    let mut others = vec![0; spatial().count()];
    for ends in spatial() {
        let place = &mut next[key(ends)];
        others[*place as usize] = ends.to;
        *place += 1;
    }
    Runs { starts, others }
}

/// What an edge says of the place.
pub(super) fn place_code(relation: &EdgeRelation) -> u32 {
    match relation {
        EdgeRelation::Spatial(relation) => code(relation),
        _ => NO_PLACE,
    }
}

fn code(relation: &SpatialRelation) -> u32 {
    let direction = relation.direction.map_or(DIRECTIONS, direction_code);
    let distance = relation.distance.map_or(DISTANCES - 1, |word| word as usize);
    (direction * DISTANCES + distance) as u32
}

/// Where each key's items start in a list sorted by it; one more entry than keys.
fn starts<'e>(
    items: impl IntoIterator<Item = &'e Ends>,
    keys: usize,
    key: impl Fn(&Ends) -> usize,
) -> Vec<u32> {
    let mut starts = vec![0; keys + 1];
    items.into_iter().for_each(|item| starts[key(item) + 1] += 1);
    let mut sum = 0;
    for start in &mut starts {
        sum += *start;
        *start = sum;
    }
    starts
}

/// A stable counting sort.
fn sorted(items: &[Ends], keys: usize, key: impl Fn(&Ends) -> usize) -> (Vec<u32>, Vec<Ends>) {
    let starts = starts(items, keys, &key);
    let mut next = starts.clone();
    let mut sorted = vec![Ends { from: 0, to: 0, edge: 0, code: NO_PLACE }; items.len()];
    for item in items {
        let place = &mut next[key(item)];
        sorted[*place as usize] = *item;
        *place += 1;
    }
    (starts, sorted)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counting_keeps_the_order_of_equal_keys() {
        let ends = |from, edge| Ends { from, to: 0, edge, code: NO_PLACE };
        let items = [ends(2, 0), ends(0, 1), ends(2, 2)];
        let (starts, sorted) = sorted(&items, 3, |ends| ends.from as usize);
        assert_eq!(starts, [0, 1, 1, 3]);
        assert_eq!(sorted.iter().map(|ends| ends.edge).collect::<Vec<_>>(), [1, 0, 2]);
    }

    #[test]
    fn every_place_has_its_own_code() {
        assert_eq!(code(&SpatialRelation::default()), CODES as u32 - 1);
        assert_eq!(DISTANCES, DistanceWord::ALL.len() + 1);
    }
}
