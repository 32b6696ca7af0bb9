//! Why somebody is not in an answer.

use std::fmt;

use jrdb_types::answer::Check;
use jrdb_types::{Answer, EntityId};

use crate::found;

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

/// Why a thing is not in an answer: the conditions that fail, or what else is the reason.
///
/// ```
/// use jrdb_search::{SearchConfig, WhyNot, search, why_not};
/// use jrdb_types::{EntityId, FrameId, LateralConvention, Query, SceneGraph};
/// # let graph = SceneGraph::new(FrameId::default(), LateralConvention::Physical, vec![]);
/// let answer = search(&graph, &Query::default(), &SearchConfig::default());
/// let reason = why_not(&answer, &EntityId::new("pedestrian", 7));
/// assert_eq!(reason, WhyNot::NoSuchThing);
/// assert_eq!(reason.to_string(), "there is no such candidate");
/// ```
#[must_use]
pub fn why_not<'a>(answer: &'a Answer, id: &EntityId) -> WhyNot<'a> {
    let Some(trace) = answer.trace.iter().find(|trace| trace.id == *id) else {
        return WhyNot::NoSuchThing;
    };
    if trace.selected {
        return WhyNot::Selected;
    }
    let mut reasons = Vec::new();
    collect(&trace.checks.iter().collect::<Vec<_>>(), 0, &mut reasons);
    let enough = trace.passed_attributes && trace.passed_relations;
    let picks_fail = trace.checks.last().is_some_and(|check| !check.holds);
    if !reasons.is_empty() && (!enough || picks_fail || reasons.len() == trace.checks.len()) {
        return WhyNot::Fails(reasons);
    }
    let probability_of = |id: &EntityId| {
        answer.ranking.iter().find(|ranked| ranked.id == *id).map(|ranked| ranked.probability)
    };
    let selected = answer.selection.iter().filter_map(probability_of).min_by(f64::total_cmp);
    WhyNot::Outranked { probability: probability_of(id).unwrap_or(0.0), selected }
}

fn collect<'a>(checks: &[&'a Check], depth: usize, reasons: &mut Vec<Reason<'a>>) {
    for check in checks.iter().filter(|check| !check.holds) {
        reasons.push(Reason { check, depth });
        // A relation's only part says what it says itself.
        let parts: Vec<&Check> = check.parts.iter().filter(|p| p.found != check.found).collect();
        collect(&parts, depth + 1, reasons);
    }
}

impl fmt::Display for WhyNot<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Selected => f.write_str("it is in the answer"),
            Self::NoSuchThing => f.write_str("there is no such candidate"),
            Self::Outranked { probability, selected: None } => {
                write!(f, "nothing is selected; its probability is {probability:.2}")
            }
            Self::Outranked { probability, selected: Some(least) }
                if probability - least > -0.005 =>
            {
                f.write_str("others satisfy more of what was asked")
            }
            Self::Outranked { probability, selected: Some(least) } => {
                write!(
                    f,
                    "others fit better: probability {probability:.2}, selected from {least:.2}"
                )
            }
            Self::Fails(reasons) => {
                for (place, reason) in reasons.iter().enumerate() {
                    let line_break = if place == 0 { "" } else { "\n" };
                    write!(f, "{line_break}{reason}")?;
                }
                Ok(())
            }
        }
    }
}

impl fmt::Display for Reason<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let check = self.check;
        let found = check.found.as_deref().unwrap_or("unknown");
        write!(f, "{:width$}{}: {found}", "", check.asked, width = 2 * self.depth)?;
        match check.measured.as_ref().filter(|measured| measured.margin < 0.0).map(found::margin) {
            Some(margin) if !margin.is_empty() => write!(f, " ({margin})"),
            _ => Ok(()),
        }
    }
}
