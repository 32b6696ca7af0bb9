//! Numbers that things are ordered and compared by.

use jrdb_graph::BitSet;
use jrdb_types::answer::Unit;
use jrdb_types::query::{Category, Compared, Measure, Order, Pick};
use jrdb_types::{Attribute, Node};

use crate::evaluation::Comparison;
use crate::geometry::apart_m;
use crate::searcher::Searcher;

/// The unit of a measure.
pub(crate) fn unit(measure: &Measure) -> Unit {
    match measure {
        Measure::DistanceTo(_) | Measure::Height => Unit::Metres,
        Measure::FromLeft => Unit::Degrees,
        Measure::Age => Unit::AgeGroup,
        Measure::Speed => Unit::MetresPerSecond,
    }
}

impl Searcher<'_, '_> {
    /// The measure of every numbered thing, as far as it is known.
    pub(crate) fn measures(&self, measure: &Measure) -> Vec<Option<f64>> {
        let of_nodes = |of: fn(&Node) -> Option<f64>| {
            (0..self.index.size()).map(|n| self.index.node(n).and_then(of)).collect()
        };
        match measure {
            Measure::Height => of_nodes(|node| node.height_m),
            Measure::Age => {
                of_nodes(|node| Some(node.attributes.belief(Attribute::Age).best()?.index() as f64))
            }
            Measure::Speed => of_nodes(|node| node.velocity_mps.map(|[x, y]| x.hypot(y))),
            Measure::FromLeft => (0..self.index.size())
                .map(|n| {
                    let bearing_rad = self.seen_by_robot(self.index.node(n)?)?.bearing_rad?;
                    // 0 straight behind, then over the robot's left.
                    Some(180.0 - bearing_rad.to_degrees())
                })
                .collect(),
            Measure::DistanceTo(pattern) if pattern.category == Category::Robot => {
                let metres = |n| self.seen_by_robot(self.index.node(n)?)?.distance_m;
                (0..self.index.size()).map(metres).collect()
            }
            Measure::DistanceTo(pattern) => {
                let those = self.resolve(pattern);
                (0..self.index.size()).map(|n| self.nearest_m(n, &those)).collect()
            }
        }
    }

    /// A comparison, made ready.
    pub(crate) fn comparison(&self, compared: &Compared) -> Comparison {
        let measures = self.measures(&compared.measure);
        Comparison { measures, than: self.resolve(&compared.than), order: compared.order }
    }

    fn nearest_m(&self, number: usize, those: &BitSet) -> Option<f64> {
        let others = those.iter().filter(|&other| other != number);
        others.filter_map(|other| self.apart_m(number, other)).min_by(f64::total_cmp)
    }

    /// Distance between two things: of their centres, else as an edge says.
    pub(crate) fn apart_m(&self, a: usize, b: usize) -> Option<f64> {
        if let (Some(a), Some(b)) = (self.center(a), self.center(b)) {
            return Some(apart_m(a, b));
        }
        let rows = [self.index.outgoing(a), self.index.incoming(a)];
        let mut edges = rows.into_iter().flat_map(|row| self.index.spatial(row.with(b as u32)));
        edges.find_map(|relation| relation.distance_m)
    }

    /// Those of a set that a pick takes. Ties go by id; what cannot be measured is not taken.
    pub(crate) fn pick(&self, set: &BitSet, pick: &Pick) -> BitSet {
        let order = in_order(set, &self.measures(&pick.measure), pick.order);
        let mut picked = BitSet::new(set.size());
        let first = pick.rank.saturating_sub(1) as usize;
        order.into_iter().skip(first).take(pick.count as usize).for_each(|n| picked.insert(n));
        picked
    }
}

/// The members of a set in the order of a measure.
pub(crate) fn in_order(set: &BitSet, measures: &[Option<f64>], order: Order) -> Vec<usize> {
    let mut known: Vec<(f64, usize)> = set.iter().filter_map(|n| Some((measures[n]?, n))).collect();
    known.sort_by(|a, b| {
        let least_first = a.0.total_cmp(&b.0);
        let by_measure = if order == Order::Least { least_first } else { least_first.reverse() };
        by_measure.then(a.1.cmp(&b.1))
    });
    known.into_iter().map(|(_, number)| number).collect()
}
