//! The smallest changes that change an answer.

mod candidate;
mod number;

use std::collections::BTreeMap;

use jrdb_graph::GraphIndex;
use jrdb_types::answer::{Change, Check, Criterion, Effect, Measured, Unit};
use jrdb_types::query::{Category, Interval, Measure, RelationKind, Viewpoint};
use jrdb_types::vocab::MatchPolicy;
use jrdb_types::{Condition, EntityId, Query, SceneGraph};

use crate::observer::{Front, Observer};
use crate::place::{is_distance, measured};
use crate::probability::bearing_sigma_deg;
use crate::{SearchConfig, benchmark, search_indexed, select};
use candidate::{Candidate, Reach};
use number::{Number, Scratch};

/// So far beyond a bound a change is tried out, in the number's own unit.
const BEYOND: f64 = 1e-6;
/// So many deviations beyond its bound a number is tried at most.
const DEVIATIONS_MAX: f64 = 6.0;
/// Halvings of the way to a change; enough to come to a millionth of it.
const HALVINGS: i32 = 20;

/// The smallest changes of one number that change who is selected, for [`jrdb_types::Answer::sensitivity`].
///
/// Numbers are distances and bearings: of candidates for the robot, compared with others' too, of edges to the partner that the
/// trace names, of a candidate that goes round that partner as the robot sees both, or off the line that it is between two on; and
/// beliefs, of candidates and of those partners: probability then moves between the asked value and its strongest rival.
/// The words for a distance or bearing change with it. Of each candidate the smallest change of place is returned, in
/// deviations, and the smallest of belief; changes of place come first, the least deviations first, then by id.
///
/// Every returned change was tried out: a millionth beyond [`Change::to`] the thing is in the answer, or no longer. Only those are looked
/// at that are selected or fail one condition; under `majority`, all. Under `ranked`, where no bound decides alone, the turning point is
/// looked for by halving. Where a candidate's answer hangs on its own edges only, the changes are looked for in a graph of these, with
/// everybody else as they are, and those found under `ranked` are then tried out on the whole graph; for groups and relations of
/// relations every trial is a search. Questions about moments have no such changes.
#[must_use]
pub fn sensitivity(graph: &SceneGraph, query: &Query, config: &SearchConfig) -> Vec<Change> {
    if !query.slots.is_empty() {
        return Vec::new();
    }
    let query = &*benchmark::as_asked(query, config);
    let index = GraphIndex::new(graph);
    smallest_changes(&index, Trial::new(&index, query, config))
}

fn smallest_changes(index: &GraphIndex<'_>, mut trial: Trial<'_, '_>) -> Vec<Change> {
    let (query, config) = (trial.query, trial.config);
    let answer = search_indexed(index, query, config);
    let mut smallest: BTreeMap<(EntityId, bool), Change> = BTreeMap::new();
    for trace in &answer.trace {
        let failing = trace.checks.iter().filter(|check| !check.holds).count();
        let at_border = trace.selected || failing <= 1 || config.policy == MatchPolicy::Majority;
        if !at_border {
            continue;
        }
        let mut proposals = Vec::new();
        for (condition, check) in query.target.conditions.iter().zip(&trace.checks) {
            propose(&trace.id, condition, check, &mut proposals);
        }
        trial.turn_to(index, &trace.id);
        let mut turns: Vec<Turn<'_>> = proposals
            .iter()
            .filter_map(|proposal| trial.turn(&trace.id, trace.selected, proposal))
            .collect();
        turns.sort_by(|a, b| size(&a.change).total_cmp(&size(&b.change)));
        for turn in turns {
            let place = (trace.id.clone(), turn.change.measured.unit == Unit::Probability);
            let is_smaller =
                |change: &Change| smallest.get(&place).is_none_or(|old| size(change) < size(old));
            if !is_smaller(&turn.change) {
                continue;
            }
            let confirmed = trial.confirmed(&trace.id, trace.selected, turn);
            if let Some(change) = confirmed.filter(|change| is_smaller(change)) {
                smallest.insert(place, change);
            }
        }
    }
    let mut changes: Vec<Change> = smallest.into_values().collect();
    changes.sort_by(|a, b| {
        let no_deviation = a.deviations.is_none().cmp(&b.deviations.is_none());
        no_deviation.then(size(a).total_cmp(&size(b))).then_with(|| a.id.cmp(&b.id))
    });
    changes
}

fn size(change: &Change) -> f64 {
    change.deviations.unwrap_or(change.measured.margin.abs())
}

/// A number that could change.
struct Proposal {
    number: Number,
    criterion: Criterion,
    witness: Option<EntityId>,
    measured: Measured,
    holds: bool,
}

fn propose(id: &EntityId, condition: &Condition, check: &Check, found: &mut Vec<Proposal>) {
    match condition {
        Condition::Attribute(value) => {
            add(Number::Belief(id.clone(), *value), None, check, found);
        }
        Condition::FromRobot(place) => {
            let number = if is_distance(place) { Number::Range } else { Number::Bearing };
            add(number(id.clone()), None, check, found);
        }
        Condition::Related(related) => {
            let Some(witness) = check.witnesses.first() else { return };
            let (relations, own) = check.parts.split_at(related.kinds.len().min(check.parts.len()));
            for (kind, part) in related.kinds.iter().zip(relations) {
                if let Some(number) = edge_number(id, &check.witnesses, kind) {
                    add(number, Some(witness), part, found);
                }
            }
            for (condition, part) in related.partner.conditions.iter().zip(own) {
                if !matches!(condition, Condition::Related(_)) {
                    let first = found.len();
                    propose(witness, condition, part, found);
                    found[first..].iter_mut().for_each(|p| p.witness = Some(witness.clone()));
                }
            }
        }
        Condition::Not(inner) => {
            check.parts.iter().for_each(|part| propose(id, inner, part, found));
        }
        Condition::Any(inner) | Condition::All(inner) => {
            let parts = inner.iter().zip(&check.parts);
            parts.for_each(|(condition, part)| propose(id, condition, part, found));
        }
        Condition::Compared(compared) => match &compared.measure {
            Measure::DistanceTo(pattern) if pattern.category == Category::Robot => {
                add(Number::Range(id.clone()), None, check, found);
            }
            Measure::FromLeft => add(Number::Row(id.clone()), None, check, found),
            _ => {}
        },
        Condition::GroupSize(_)
        | Condition::Measures(_)
        | Condition::Nearer(_)
        | Condition::Looks(_)
        | Condition::Id(_)
        | Condition::Phrase(_)
        | Condition::Is(_) => {}
    }
}

fn edge_number(id: &EntityId, witnesses: &[EntityId], kind: &RelationKind) -> Option<Number> {
    let (id, witness) = (id.clone(), witnesses.first()?.clone());
    let (place, viewpoint) = match kind {
        RelationKind::Placed { place, viewpoint } => (place, viewpoint),
        RelationKind::Between(_) => {
            return Some(Number::Aside(id, witness, witnesses.get(1).cloned()));
        }
        _ => return None,
    };
    match viewpoint {
        _ if is_distance(place) => Some(Number::Apart(id, witness)),
        Viewpoint::Subject => Some(Number::Seen(id, witness)),
        Viewpoint::Partner => Some(Number::Seen(witness, id)),
        Viewpoint::Robot => Some(Number::Beside(id, witness)),
    }
}

/// Proposes a number, if the check has one; a height is none that is changed here.
fn add(number: Number, witness: Option<&EntityId>, check: &Check, found: &mut Vec<Proposal>) {
    let Some(measured) = check.measured else { return };
    if measured.unit == number.unit() {
        found.push(Proposal {
            number,
            criterion: check.criterion.clone(),
            witness: witness.cloned(),
            measured,
            holds: check.holds,
        });
    }
}

/// Tries changes out.
struct Trial<'g, 'q> {
    scratch: Scratch<'g>,
    candidate: Option<Candidate<'g, 'q>>,
    reach: Reach,
    query: &'q Query,
    config: &'q SearchConfig,
}

/// What a change is tried out on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum On {
    Candidate,
    WholeGraph,
}

/// Where an answer turns, perhaps, and where it was looked for.
struct Turn<'p> {
    proposal: &'p Proposal,
    change: Change,
    deviation: Option<f64>,
    bound: f64,
    far: f64,
}

impl<'g, 'q> Trial<'g, 'q> {
    fn new(index: &GraphIndex<'g>, query: &'q Query, config: &'q SearchConfig) -> Self {
        let graph = index.scene();
        let all_placed = graph.nodes.iter().all(|node| node.center.is_some());
        let reach = Reach::of(&query.target, all_placed);
        let candidate = Candidate::new(index, query, config, reach);
        let is_exact = candidate.as_ref().is_some_and(Candidate::is_exact);
        let needs_edges = reach != Reach::Nothing && !is_exact;
        let edges = if needs_edges { graph.edges.clone() } else { Vec::new() };
        let scratch = Scratch::with_edges(graph, edges);
        Self { scratch, candidate, reach, query, config }
    }

    fn turn_to(&mut self, index: &GraphIndex<'_>, id: &EntityId) {
        if let Some(candidate) = &mut self.candidate {
            candidate.turn_to(index, id, self.reach);
        }
    }

    /// The smallest change of one number that changes the answer for one thing, as far as the thing itself shows.
    fn turn<'p>(
        &mut self,
        id: &EntityId,
        selected: bool,
        proposal: &'p Proposal,
    ) -> Option<Turn<'p>> {
        let range_m = self.scratch.range_m(&proposal.number);
        let deviation = self.deviation(&proposal.number, range_m);
        let now = proposal.measured.value;
        let ways = self.ways(proposal, deviation).into_iter().filter_map(|(bound, far)| {
            let to = self.turning_point(id, selected, proposal, (bound, far), On::Candidate)?;
            Some((to, bound, far))
        });
        let nearest = ways.min_by(|a, b| (a.0 - now).abs().total_cmp(&(b.0 - now).abs()));
        let (to, bound, far) = nearest?;
        let change = change_to(id, selected, proposal, deviation, to);
        Some(Turn { proposal, change, deviation, bound, far })
    }

    /// A change as the whole graph has it: there the others may change with it.
    fn confirmed(&mut self, id: &EntityId, selected: bool, turn: Turn<'_>) -> Option<Change> {
        let Turn { proposal, change, deviation, bound, far } = turn;
        if self.candidate.as_ref().is_none_or(Candidate::is_exact) {
            return Some(change);
        }
        let (now, to) = (proposal.measured.value, change.to);
        let beyond = if to > now { BEYOND } else { -BEYOND };
        let short = to - beyond - (far - now) / 2_f64.powi(HALVINGS);
        let mut turns =
            |value: f64| self.is_selected(id, proposal, value, On::WholeGraph) != selected;
        if turns(to + beyond) && ((short - now) * beyond <= 0.0 || !turns(short)) {
            return Some(change);
        }
        let to = self.turning_point(id, selected, proposal, (bound, far), On::WholeGraph)?;
        Some(change_to(id, selected, proposal, deviation, to))
    }

    /// One standard deviation of a number.
    fn deviation(&self, number: &Number, range_m: Option<f64>) -> Option<f64> {
        let lateral = self.scratch.graph().lateral;
        let front = Front::OfPerson;
        let observer = Observer { lateral, front, config: self.config };
        match number {
            Number::Range(_) | Number::Apart(..) | Number::Aside(..) => {
                Some(self.config.position_sigma_m)
            }
            Number::Bearing(_) | Number::Beside(..) | Number::Row(_) => {
                Some(bearing_sigma_deg(range_m?, 0.0, &observer))
            }
            Number::Seen(..) => {
                Some(bearing_sigma_deg(range_m?, self.config.heading_sigma_rad, &observer))
            }
            Number::Belief(..) => None,
        }
    }

    /// Bounds that could be crossed, and how far beyond each at most.
    fn ways(&self, proposal: &Proposal, deviation: Option<f64>) -> Vec<(f64, f64)> {
        let Measured { value, bounds, .. } = proposal.measured;
        if let Number::Belief(id, asked_value) = &proposal.number {
            let [asked, rival] = self.scratch.rivals(id, *asked_value);
            let level = f64::midpoint(asked, rival);
            let both = [(level, 0.0), (level, asked + rival)];
            return both.into_iter().filter(|(_, far)| *far != value).collect();
        }
        let far = DEVIATIONS_MAX * deviation.unwrap_or(0.0);
        let bounds = [bounds.min, bounds.max].into_iter().flatten();
        bounds
            .filter(|bound| {
                proposal.holds || (bound - value).abs() <= proposal.measured.margin.abs() + BEYOND
            })
            .map(|bound| (bound, if bound > value { value.max(bound) + far } else { bound - far }))
            .filter(|(bound, _)| *bound > 0.0 || proposal.measured.unit == Unit::Degrees)
            .collect()
    }

    /// Where on the way to a far value the answer for a thing turns: at the bound, or where halving finds it.
    fn turning_point(
        &mut self,
        id: &EntityId,
        selected: bool,
        proposal: &Proposal,
        (bound, far): (f64, f64),
        on: On,
    ) -> Option<f64> {
        let now = proposal.measured.value;
        let is_ranked = self.config.policy == MatchPolicy::Ranked;
        let beyond = if far > now { BEYOND } else { -BEYOND };
        let mut turns = |value: f64| self.is_selected(id, proposal, value, on) != selected;
        let bound_is_ahead = (bound - now) * beyond >= 0.0;
        if bound_is_ahead && turns(bound + beyond) && !turns(bound - beyond) {
            return Some(bound);
        }
        if !is_ranked || !turns(far) {
            return None;
        }
        let (mut near, mut far) = (now, far);
        for _ in 0..HALVINGS {
            let middle = f64::midpoint(near, far);
            if turns(middle) { far = middle } else { near = middle }
        }
        turns(far + beyond).then_some(far)
    }

    fn is_selected(&mut self, id: &EntityId, proposal: &Proposal, value: f64, on: On) -> bool {
        let (number, from) = (&proposal.number, proposal.measured.value);
        let candidate = self.candidate.as_mut().filter(|_| on == On::Candidate);
        let alone = candidate.and_then(|c| c.is_selected(id, number, from, value));
        alone.unwrap_or_else(|| {
            let index = GraphIndex::new(self.scratch.with(number, from, value));
            let found = select(&index, self.query, self.config);
            index.number(id).is_some_and(|number| found.contains(number))
        })
    }
}

/// The change of a number to where the answer for a thing turns.
fn change_to(
    id: &EntityId,
    selected: bool,
    proposal: &Proposal,
    deviation: Option<f64>,
    to: f64,
) -> Change {
    let Measured { value: now, unit, .. } = proposal.measured;
    // Inside its bounds the answer stays what it is for a selected thing, and becomes what it would be for another.
    let low_end = (to < now) == selected;
    let bounds = if low_end {
        Interval { min: Some(to), max: None }
    } else {
        Interval { min: None, max: Some(to) }
    };
    Change {
        id: id.clone(),
        effect: if selected { Effect::Leaves } else { Effect::Enters },
        words: String::new(),
        criterion: proposal.criterion.clone(),
        witness: proposal.witness.clone(),
        measured: measured(now, unit, bounds),
        to,
        deviations: deviation.filter(|&d| d > 0.0).map(|d| (to - now).abs() / d),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{asked, graphs};
    use graphs::{Beliefs, Random};

    #[test]
    fn what_is_found_of_a_candidate_alone_is_what_searches_find() {
        let (mut same, mut all) = (0, 0);
        for seed in 0..400 {
            let scene = graphs::random(&mut Random(seed), Beliefs::Mixed);
            let query = asked::plain(&mut Random(seed));
            let index = GraphIndex::new(&scene);
            for policy in [MatchPolicy::Strict, MatchPolicy::Majority, MatchPolicy::Ranked] {
                let config = SearchConfig { policy, ..SearchConfig::default() };
                let searched = Trial {
                    scratch: Scratch::with_edges(&scene, scene.edges.clone()),
                    candidate: None,
                    ..Trial::new(&index, &query, &config)
                };
                let searched = smallest_changes(&index, searched);
                let found = sensitivity(&scene, &query, &config);
                let is_in = |change: &&Change| {
                    found.iter().any(|other| {
                        (&other.id, other.measured.unit) == (&change.id, change.measured.unit)
                            && (other.to - change.to).abs() < 1e-3
                    })
                };
                all += searched.len().max(found.len());
                same += searched.iter().filter(is_in).count();
                if policy != MatchPolicy::Ranked {
                    assert_eq!(searched, found, "{seed} {policy}");
                }
            }
        }
        // Under `ranked` others may change too, and so the first place where the answer turns.
        assert!(all > 500 && same * 100 >= all * 98, "{same} of {all}");
    }
}
