//! Why a candidate was chosen or refused: conditions, findings and numbers, as values.
//!
//! `jrdb-render` turns them into words. The fields with words are empty until it fills them for a file.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::found::{DirectionFound, DistanceFound};
use crate::attribute::AttributeValue;
use crate::id::EntityId;
use crate::query::{Condition, Interval, Pick, RelationKind, Slot};

/// What a measured number is a number of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Unit {
    /// Metres.
    Metres,
    /// Degrees, counter-clockwise.
    Degrees,
    /// Probability in `[0, 1]`.
    Probability,
    /// A number of things.
    Count,
    /// Metres per second.
    MetresPerSecond,
    /// Age groups, 0 for child to 4 for elderly.
    AgeGroup,
}

/// The number behind a check.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Measured {
    /// What was measured; an angle is brought within half a turn of the middle of the bounds.
    pub value: f64,
    /// Its unit.
    pub unit: Unit,
    /// Where it must lie for the check to hold.
    pub bounds: Interval,
    /// How far the value is inside the nearer bound; negative: how far it is outside.
    pub margin: f64,
}

/// The robot, or a thing of the scene.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Partner {
    /// The robot itself.
    Robot,
    /// A thing of the scene.
    Thing(EntityId),
}

/// What a check is about: a part of the query.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Criterion {
    /// Not stated: the check comes from a file that has words only.
    #[default]
    Unstated,
    /// A condition of the query. Many checks share it.
    Condition(Arc<Condition>),
    /// One relation with one partner.
    Relation {
        /// Which relation.
        kind: RelationKind,
        /// With whom.
        partner: Partner,
    },
    /// A superlative or ordinal.
    Pick(Arc<Pick>),
    /// A stretch of a recording with its conditions.
    Slot {
        /// Which.
        slot: Arc<Slot>,
        /// Its place in the question, from 1.
        number: usize,
    },
}

/// What was found of a candidate: the fact that decides a check.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Finding {
    /// Whether it is so, where nothing more can be stated.
    Holds(bool),
    /// The most probable value of an attribute.
    Attribute {
        /// Which value.
        value: AttributeValue,
        /// Its probability in `[0, 1]`.
        probability: f64,
    },
    /// What whoever was asked says of a description that no table holds.
    Looks {
        /// Probability that the description is true, in `[0, 1]`.
        probability: f64,
        /// Who was asked, in a word or two.
        source: String,
    },
    /// How far it is.
    Distance(DistanceFound),
    /// In which direction it is, seen from whoever the condition says.
    Direction(DirectionFound),
    /// In which direction the robot is, seen from the candidate.
    RobotIn(DirectionFound),
    /// How many people the candidate's group has, itself included.
    Group(u32),
    /// What it does with the partner: labels.
    Interactions(Vec<String>),
    /// Between whom it is.
    Between([Partner; 2]),
    /// Its own number and the number of the one that is hardest to beat, in one unit.
    Comparison {
        /// Of the candidate.
        own: f64,
        /// Of the other; absent when unknown.
        other: Option<f64>,
        /// Unit of both.
        unit: Unit,
    },
    /// Its place in an order.
    Order {
        /// From 1; absent when it is not in the order.
        place: Option<usize>,
        /// How many are in the order.
        count: usize,
        /// The number that it is ordered by; absent when unknown.
        value: Option<f64>,
        /// Unit of the number.
        unit: Unit,
    },
    /// In how many frames of a slot it matches.
    Frames {
        /// Frames in which it matches.
        matched: usize,
        /// Frames in which it is seen.
        seen: usize,
        /// Number of the frame that the parts of the check are about.
        shown: Option<u32>,
    },
}

/// One condition, checked on one candidate.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Check {
    /// What was asked, in words; empty until `jrdb-render` fills it.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub asked: String,
    /// What was found, in words; absent when nothing is known, and until `jrdb-render` fills it.
    #[serde(default)]
    pub found: Option<String>,
    /// What was asked.
    #[serde(default)]
    pub criterion: Criterion,
    /// What was found. Absent when nothing is known, and where it consists of what the parts found.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub finding: Option<Finding>,
    /// Whether it holds.
    pub holds: bool,
    /// Whether it is unknown whether it holds; then `holds` is false.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub unknown: bool,
    /// Probability that it holds, in `[0, 1]`.
    pub probability: f64,
    /// The number behind it, where there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measured: Option<Measured>,
    /// The other things of a relation: the best partner first; for "between", the two ends.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub witnesses: Vec<EntityId>,
    /// What it consists of: the relations with the witness, then the witness's own conditions; the parts of
    /// "and", "or" and "not".
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<Check>,
}

impl Check {
    /// Everything that was found: its own finding, or else what its parts found. Of a relation only the relations with the
    /// witness count, not the witness's own conditions. Equal findings that follow each other count once in "and", "or" and
    /// "not".
    #[must_use]
    pub fn findings(&self) -> Vec<&Finding> {
        if let Some(finding) = &self.finding {
            return vec![finding];
        }
        let Criterion::Condition(condition) = &self.criterion else { return Vec::new() };
        let is_relation = match &**condition {
            Condition::Related(_) => true,
            Condition::Not(_) | Condition::Any(_) | Condition::All(_) => false,
            _ => return Vec::new(),
        };
        let parts = self.parts.iter().filter(|part| !is_relation || part.is_relation());
        let mut found: Vec<Vec<&Finding>> =
            parts.map(Self::findings).filter(|found| !found.is_empty()).collect();
        if !is_relation {
            found.dedup();
        }
        found.concat()
    }

    fn is_relation(&self) -> bool {
        matches!(self.criterion, Criterion::Relation { .. })
    }

    /// Its parts that found something else than the whole: the only part of a relation repeats the relation.
    pub fn telling_parts(&self) -> impl Iterator<Item = &Check> {
        let found = self.findings();
        self.parts.iter().filter(move |part| part.findings() != found)
    }
}

/// Why a candidate was chosen or refused.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CandidateTrace {
    /// Which thing.
    pub id: EntityId,
    /// Whether it is part of the answer.
    pub selected: bool,
    /// Whether enough attributes hold (the paper's phase 1).
    pub passed_attributes: bool,
    /// Whether the relations hold (the paper's phase 2).
    pub passed_relations: bool,
    /// Every condition, in the order of the query; a superlative or ordinal comes last.
    pub checks: Vec<Check>,
}
