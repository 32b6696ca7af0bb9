//! The smallest changes that change an answer.

mod number;

use std::collections::BTreeMap;

use jrdb_graph::GraphIndex;
use jrdb_types::answer::{Change, Check, Effect, Measured, Unit};
use jrdb_types::query::{Interval, RelationKind, Viewpoint};
use jrdb_types::vocab::MatchPolicy;
use jrdb_types::{Condition, EntityId, Query, SceneGraph};

use crate::place::{View, measured};
use crate::probability::bearing_sigma_deg;
use crate::searcher::is_distance;
use crate::{SearchConfig, engine, search_indexed, select};
use number::{Number, Scratch};

/// So far beyond a bound a change is tried out, in the number's own unit.
const BEYOND: f64 = 1e-6;
/// So many deviations beyond its bound a number is tried at most.
const DEVIATIONS_MAX: f64 = 6.0;
/// Halvings of the way to a change; enough to come to a millionth of it.
const HALVINGS: usize = 20;

/// The smallest changes of one number that change who is selected, for [`jrdb_types::Answer::sensitivity`].
///
/// Numbers are distances and bearings, of candidates for the robot and of edges to the partner that the trace names, and beliefs,
/// of candidates and of those partners: probability then moves between the asked value and its strongest rival.
/// The words for a distance or bearing change with it. Of each candidate the smallest change of place is told, in
/// deviations, and the smallest of belief; changes of place come first, the least deviations first, then by id.
///
/// Every change told was tried out: a millionth beyond [`Change::to`] the thing is in the answer, or no longer. Only those are looked
/// at that are selected or fail one condition; under `majority`, all. Every number costs a search, under `ranked`, where no bound
/// decides alone and the turning point is looked for by halving, a score of them. Questions about moments have no such
/// changes.
#[must_use]
pub fn sensitivity(graph: &SceneGraph, query: &Query, config: &SearchConfig) -> Vec<Change> {
    if !query.slots.is_empty() {
        return Vec::new();
    }
    let query = &*engine::as_asked(query, config);
    let index = GraphIndex::new(graph);
    let answer = search_indexed(&index, query, config);
    let mut trial = Trial { scratch: Scratch::new(graph), query, config };
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
        for proposal in proposals {
            let Some(change) = trial.change(&trace.id, trace.selected, &proposal) else { continue };
            let place = (trace.id.clone(), change.measured.unit == Unit::Probability);
            let is_smaller = smallest.get(&place).is_none_or(|old| size(&change) < size(old));
            if is_smaller {
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
struct Proposal<'q> {
    number: Number<'q>,
    asked: String,
    witness: Option<EntityId>,
    measured: Measured,
    holds: bool,
}

fn propose<'q>(
    id: &EntityId,
    condition: &'q Condition,
    check: &Check,
    found: &mut Vec<Proposal<'q>>,
) {
    match condition {
        Condition::Age(_) | Condition::Gender(_) | Condition::Race(_) | Condition::Action(_) => {
            add(Number::Belief(id.clone(), condition), None, check, found);
        }
        Condition::FromRobot(place) => {
            let number = if is_distance(place) { Number::Range } else { Number::Bearing };
            add(number(id.clone()), None, check, found);
        }
        Condition::Related(related) => {
            let Some(witness) = check.witnesses.first() else { return };
            let (relations, own) = check.parts.split_at(related.kinds.len().min(check.parts.len()));
            for (kind, part) in related.kinds.iter().zip(relations) {
                if let Some(number) = edge_number(id, witness, kind) {
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
        Condition::GroupSize(_) | Condition::Compared(_) | Condition::Is(_) => {}
    }
}

fn edge_number<'q>(id: &EntityId, witness: &EntityId, kind: &RelationKind) -> Option<Number<'q>> {
    let RelationKind::Placed { place, viewpoint } = kind else { return None };
    let (id, witness) = (id.clone(), witness.clone());
    match viewpoint {
        _ if is_distance(place) => Some(Number::Apart(id, witness)),
        Viewpoint::Subject => Some(Number::Seen(id, witness)),
        Viewpoint::Partner => Some(Number::Seen(witness, id)),
        Viewpoint::Robot => None,
    }
}

/// Proposes a number, if the check has one; a height is none that is changed here.
fn add<'q>(
    number: Number<'q>,
    witness: Option<&EntityId>,
    check: &Check,
    found: &mut Vec<Proposal<'q>>,
) {
    let Some(measured) = check.measured else { return };
    if measured.unit == number.unit() {
        found.push(Proposal {
            number,
            asked: check.asked.clone(),
            witness: witness.cloned(),
            measured,
            holds: check.holds,
        });
    }
}

/// Tries changes out.
struct Trial<'g, 'q> {
    scratch: Scratch<'g>,
    query: &'q Query,
    config: &'q SearchConfig,
}

impl Trial<'_, '_> {
    /// The smallest change of one number that changes the answer for one thing.
    fn change(&mut self, id: &EntityId, selected: bool, proposal: &Proposal<'_>) -> Option<Change> {
        let range_m = self.scratch.range_m(&proposal.number);
        let deviation = self.deviation(&proposal.number, range_m);
        let now = proposal.measured.value;
        let ways = self.ways(proposal, deviation);
        let to = ways
            .into_iter()
            .filter_map(|(bound, far)| self.turning_point(id, selected, proposal, bound, far));
        let to = to.min_by(|a, b| (a - now).abs().total_cmp(&(b - now).abs()))?;
        // Inside its bounds the answer stays what it is for a selected thing, and becomes what it would be for another.
        let low_end = (to < now) == selected;
        let bounds = if low_end {
            Interval { min: Some(to), max: None }
        } else {
            Interval { min: None, max: Some(to) }
        };
        Some(Change {
            id: id.clone(),
            effect: if selected { Effect::Leaves } else { Effect::Enters },
            condition: proposal.asked.clone(),
            witness: proposal.witness.clone(),
            measured: measured(now, proposal.measured.unit, bounds),
            to,
            deviations: deviation.filter(|&d| d > 0.0).map(|d| (to - now).abs() / d),
        })
    }

    /// One standard deviation of a number.
    fn deviation(&self, number: &Number<'_>, range_m: Option<f64>) -> Option<f64> {
        let lateral = self.scratch.graph().lateral;
        let heading = crate::place::Heading::OfPerson;
        let view = View { lateral, heading, config: self.config };
        match number {
            Number::Range(_) | Number::Apart(..) => Some(self.config.position_sigma_m),
            Number::Bearing(_) => Some(bearing_sigma_deg(range_m?, 0.0, &view)),
            Number::Seen(..) => {
                Some(bearing_sigma_deg(range_m?, self.config.heading_sigma_rad, &view))
            }
            Number::Belief(..) => None,
        }
    }

    /// Bounds that could be crossed, and how far beyond each at most.
    fn ways(&self, proposal: &Proposal<'_>, deviation: Option<f64>) -> Vec<(f64, f64)> {
        let Measured { value, bounds, .. } = proposal.measured;
        if let Number::Belief(id, condition) = &proposal.number {
            let [asked, rival] = self.scratch.rivals(id, condition);
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
        proposal: &Proposal<'_>,
        bound: f64,
        far: f64,
    ) -> Option<f64> {
        let now = proposal.measured.value;
        let beyond = if far > now { BEYOND } else { -BEYOND };
        let mut turns = |value: f64| self.is_selected(id, proposal, value) != selected;
        let bound_is_ahead = (bound - now) * beyond >= 0.0;
        if bound_is_ahead && turns(bound + beyond) && !turns(bound - beyond) {
            return Some(bound);
        }
        if self.config.policy != MatchPolicy::Ranked {
            return None;
        }
        let mut turns = |value: f64| self.is_selected(id, proposal, value) != selected;
        if !turns(far) {
            return None;
        }
        let (mut near, mut far) = (now, far);
        for _ in 0..HALVINGS {
            let middle = f64::midpoint(near, far);
            if turns(middle) { far = middle } else { near = middle }
        }
        turns(far + beyond).then_some(far)
    }

    fn is_selected(&mut self, id: &EntityId, proposal: &Proposal<'_>, value: f64) -> bool {
        let graph = self.scratch.with(&proposal.number, proposal.measured.value, value);
        let index = GraphIndex::new(graph);
        let found = select(&index, self.query, self.config);
        index.number(id).is_some_and(|number| found.contains(number))
    }
}
