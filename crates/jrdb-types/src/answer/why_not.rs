//! Why something is not in an answer, read from its trace.

use super::{Answer, Check};
use crate::id::EntityId;

/// Why a thing is not in an answer.
#[derive(Debug, Clone, PartialEq)]
pub enum WhyNot<'a> {
    /// It is in the answer.
    Selected,
    /// The answer knows no such candidate: the graph has no such thing, or it is of another kind than was asked for.
    NoSuchThing,
    /// These conditions do not hold, in the order of the question; after each, deeper, what of it does not hold.
    Fails(Vec<Reason<'a>>),
    /// Enough holds, but others fit better: the candidate's probability and the selection's least.
    Outranked {
        /// Of the candidate; 0 when it is not in the ranking.
        probability: f64,
        /// The least of the selected ones; absent when nothing is selected.
        selected: Option<f64>,
    },
}

/// A condition that does not hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reason<'a> {
    /// The condition, with what was found.
    pub check: &'a Check,
    /// 0 for a condition of the question, 1 for a part of one, and so on.
    pub depth: usize,
}

impl Answer {
    /// Why a thing is not in the answer: the conditions that fail, or what else is the reason.
    #[must_use]
    pub fn why_not(&self, id: &EntityId) -> WhyNot<'_> {
        let Some(trace) = self.trace.iter().find(|trace| trace.id == *id) else {
            return WhyNot::NoSuchThing;
        };
        if trace.selected {
            return WhyNot::Selected;
        }
        let mut reasons = Vec::new();
        collect(&mut trace.checks.iter(), 0, &mut reasons);
        let enough = trace.passed_attributes && trace.passed_relations;
        let picks_fail = trace.checks.last().is_some_and(|check| !check.holds);
        if !reasons.is_empty() && (!enough || picks_fail || reasons.len() == trace.checks.len()) {
            return WhyNot::Fails(reasons);
        }
        let selected = self.selection.iter().filter_map(|id| self.probability(id));
        WhyNot::Outranked {
            probability: self.probability(id).unwrap_or(0.0),
            selected: selected.min_by(f64::total_cmp),
        }
    }

    /// The probability of a thing in the ranking, in `[0, 1]`.
    #[must_use]
    pub fn probability(&self, id: &EntityId) -> Option<f64> {
        let ranked = self.ranking.iter().find(|ranked| ranked.id == *id);
        ranked.map(|ranked| ranked.probability)
    }
}

fn collect<'a>(
    checks: &mut dyn Iterator<Item = &'a Check>,
    depth: usize,
    reasons: &mut Vec<Reason<'a>>,
) {
    for check in checks.filter(|check| !check.holds) {
        reasons.push(Reason { check, depth });
        collect(&mut check.telling_parts(), depth + 1, reasons);
    }
}
