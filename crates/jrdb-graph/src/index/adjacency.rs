//! Edges as rows of numbers.

use jrdb_types::{Direction, DistanceWord, EdgeRelation, SceneGraph, SpatialRelation};

use super::columns::{DIRECTIONS, direction_code};

/// Distance words, and one place for an unknown distance.
const DISTANCES: usize = 6;
/// Places of a node's spatial edges: every direction and an unknown one, with every distance.
const CODES: usize = (DIRECTIONS + 1) * DISTANCES;

/// An edge with its ends as numbers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ends {
    pub(super) from: u32,
    pub(super) to: u32,
    /// Place in the scene's list.
    pub(super) edge: u32,
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

/// Rows of outgoing and of incoming edges, and runs of spatial ones.
pub(super) fn arrange(scene: &SceneGraph, ends: &[Ends], size: usize) -> (Rows, Rows, Runs) {
    let is_sorted = ends.is_sorted_by_key(|ends| (ends.from, ends.to));
    let by_from = if is_sorted {
        ends.to_vec()
    } else {
        let by_to = sorted(ends, size, |ends| ends.to as usize).1;
        sorted(&by_to, size, |ends| ends.from as usize).1
    };
    let out_starts = starts(&by_from, size, |ends| ends.from as usize);
    let (in_starts, by_to) = sorted(&by_from, size, |ends| ends.to as usize);
    let edges = |sorted: &[Ends]| sorted.iter().map(|ends| ends.edge).collect();
    let others = by_from.iter().map(|ends| ends.to).collect();
    let out = Rows { starts: out_starts, others, edges: edges(&by_from) };
    let others = by_to.iter().map(|ends| ends.from).collect();
    let incoming = Rows { starts: in_starts, others, edges: edges(&by_to) };
    (out, incoming, runs(scene, &by_from, size))
}

fn runs(scene: &SceneGraph, by_from: &[Ends], size: usize) -> Runs {
    // The key takes the place of the edge.
    let spatial =
        by_from.iter().filter_map(|ends| match &scene.edges[ends.edge as usize].relation {
            EdgeRelation::Spatial(relation) => {
                Some(Ends { edge: ends.from * CODES as u32 + code(relation), ..*ends })
            }
            _ => None,
        });
    let spatial: Vec<Ends> = spatial.collect();
    let (starts, spatial) = sorted(&spatial, size * CODES, |ends| ends.edge as usize);
    Runs { starts, others: spatial.iter().map(|ends| ends.to).collect() }
}

fn code(relation: &SpatialRelation) -> u32 {
    let direction = relation.direction.map_or(DIRECTIONS, direction_code);
    let distance = relation.distance.map_or(DISTANCES - 1, |word| word as usize);
    (direction * DISTANCES + distance) as u32
}

/// Where each key's items start in a list sorted by it; one more entry than keys.
fn starts(items: &[Ends], keys: usize, key: impl Fn(&Ends) -> usize) -> Vec<u32> {
    let mut starts = vec![0; keys + 1];
    items.iter().for_each(|item| starts[key(item) + 1] += 1);
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
    let mut sorted = vec![Ends { from: 0, to: 0, edge: 0 }; items.len()];
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
        let ends = |from, edge| Ends { from, to: 0, edge };
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
