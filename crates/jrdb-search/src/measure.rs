//! Numbers that things are ordered and compared by.

use jrdb_graph::BitSet;
use jrdb_types::answer::Unit;
use jrdb_types::query::{Category, Compared, Measure, Nearer, Order, Pick};
use jrdb_types::vocab::MatchPolicy;
use jrdb_types::{Attribute, Node, Pattern, Quantity};

use crate::World;
use crate::evaluation::Comparison;
use crate::geometry::apart_m;
use crate::known::Known;
use crate::searcher::Searcher;
use crate::value::{Truth, UNBOUNDED};

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
            Measure::DistanceTo(pattern) if self.guesses() => {
                let those = self.resolve(pattern);
                (0..self.index.size()).map(|n| self.nearest_m(n, &those)).collect()
            }
            Measure::DistanceTo(pattern) => self.known_distances(pattern),
        }
    }

    /// Whether the best guess stands for what is not known: where everything is ranked, and in a closed world.
    fn guesses(&self) -> bool {
        self.config.policy == MatchPolicy::Ranked || self.config.world == World::Closed
    }

    /// The distance of everything to the nearest thing that a pattern means; unknown where one that may be meant, too,
    /// could be nearer.
    fn known_distances(&self, pattern: &Pattern) -> Vec<Option<f64>> {
        let size = self.index.size();
        if self.may_be_unseen(pattern) {
            return vec![None; size];
        }
        let known = self.known_matching(pattern);
        let mut perhaps = known.possible(&BitSet::below(size, size));
        perhaps.subtract(&known.yes);
        let distance = |number: usize| {
            let nearest = self.nearest_m(number, &known.yes)?;
            let is_nearer = |other| self.apart_m(number, other).is_none_or(|m| m < nearest);
            let is_open = perhaps.iter().any(|other| other != number && is_nearer(other));
            (!is_open).then_some(nearest)
        };
        (0..size).map(distance).collect()
    }

    /// A comparison, made ready.
    pub(crate) fn comparison(&self, compared: &Compared) -> Comparison {
        let measures = self.measures(&compared.measure);
        let than = self.resolve(&compared.than);
        if self.config.world == World::Closed {
            return Comparison {
                perhaps: BitSet::new(than.size()),
                measures,
                than,
                may_be_unseen: false,
                is_closed: true,
                order: compared.order,
            };
        }
        let known = self.known_matching(&compared.than);
        let than = if self.guesses() { than } else { known.yes.clone() };
        let all = BitSet::below(than.size(), than.size());
        let mut perhaps = known.possible(&all);
        perhaps.subtract(&known.yes);
        let may_be_unseen = self.may_be_unseen(&compared.than);
        let (is_closed, order) = (false, compared.order);
        Comparison { measures, than, perhaps, may_be_unseen, is_closed, order }
    }

    /// Whether each thing is nearer to some than to others.
    pub(crate) fn nearer(&self, nearer: &Nearer) -> Vec<Truth> {
        let distances = |to: &Pattern| self.measures(&Measure::DistanceTo(Box::new(to.clone())));
        let (to, than) = (distances(&nearer.to), distances(&nearer.than));
        let pairs = to.into_iter().zip(than);
        pairs.map(|(to, than)| Truth::of_known(to.zip(than).map(|(to, than)| to < than))).collect()
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

    /// Whom a pick surely takes and whom it surely does not, of those that match for sure and those that may match.
    ///
    /// It takes a thing for sure when the thing matches and, whoever else matches, so many are before it as must be. A
    /// thing that cannot be measured may stand anywhere in the order, and so may things that were not seen.
    pub(crate) fn picked(
        &self,
        yes: &BitSet,
        maybe: &BitSet,
        pick: &Pick,
        others_unseen: bool,
    ) -> Known {
        let measures = self.measures(&pick.measure);
        // A thing is not near itself, nor far from itself.
        let itself = self.references(&pick.measure);
        let is_itself = |number: usize| measures[number].is_none() && itself.contains(number);
        let first = pick.rank.saturating_sub(1) as usize;
        let turn = Quantity {
            at_least: first as u32,
            at_most: (first as u32).checked_add(pick.count.saturating_sub(1)),
        };
        Known::split(maybe, |number| {
            if pick.count == 0 || is_itself(number) {
                return Truth::No;
            }
            let (mut sure, mut perhaps) = (0, if others_unseen { UNBOUNDED } else { 0_usize });
            for other in maybe.iter().filter(|&other| other != number && !is_itself(other)) {
                let is_before = is_before(&measures, other, number, pick.order);
                match is_before.map(|is_before| is_before && yes.contains(other)) {
                    Some(true) => sure += 1,
                    Some(false) if is_before == Some(false) => {}
                    _ => perhaps = perhaps.saturating_add(1),
                }
            }
            let own = if yes.contains(number) { Truth::Yes } else { Truth::Unknown };
            own.min(Truth::of_count(turn, sure, perhaps))
        })
    }

    /// The things that distances are measured from.
    fn references(&self, measure: &Measure) -> BitSet {
        match measure {
            Measure::DistanceTo(pattern) if pattern.category != Category::Robot => {
                self.known_matching(pattern).yes
            }
            _ => BitSet::new(self.index.size()),
        }
    }

    /// What a pick takes of those that match, in a closed world; nobody else may match.
    pub(crate) fn picked_from(&self, matching: &BitSet, pick: &Pick) -> Known {
        let yes = self.pick(matching, pick);
        let mut no = matching.clone();
        no.subtract(&yes);
        Known { yes, no }
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

/// Whether one thing is before another in the order of a measure; ties go by id. `None` if one cannot be measured.
fn is_before(measures: &[Option<f64>], one: usize, other: usize, order: Order) -> Option<bool> {
    let (own, others) = (measures[one]?, measures[other]?);
    let by_measure = match order {
        Order::Least => own.total_cmp(&others),
        Order::Most => others.total_cmp(&own),
    };
    Some(by_measure.then(one.cmp(&other)).is_lt())
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
