//! What search hands on: who was meant, how probable each candidate is, and why.

use serde::{Deserialize, Serialize};

use crate::artefact::Payload;
use crate::geometry::PixelBox;
use crate::id::{EntityId, FrameId};
use crate::issue::Issue;
use crate::query::Task;
use crate::vocab::{LateralConvention, MatchPolicy};

/// A candidate with its place in the ranking.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Ranked {
    /// Which thing.
    pub id: EntityId,
    /// Where in the image, pixels.
    #[serde(rename = "box")]
    pub bbox: PixelBox,
    /// Probability that it satisfies the whole query, in `[0, 1]`.
    pub probability: f64,
}

/// One condition, checked on one candidate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Check {
    /// What was asked, in words.
    pub asked: String,
    /// What was found, in words; absent when nothing is known.
    pub found: Option<String>,
    /// Whether it holds.
    pub holds: bool,
    /// Probability that it holds, in `[0, 1]`.
    pub probability: f64,
    /// The other thing of a relation: the best partner.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub witness: Option<EntityId>,
    /// The partner's own conditions.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub witness_checks: Vec<Check>,
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
    /// Every condition, in the order of the query.
    pub checks: Vec<Check>,
}

/// The answer to one query on one frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Answer {
    /// The frame.
    pub frame: FrameId,
    /// The question's words.
    pub question: String,
    /// What was asked.
    pub task: Task,
    /// How many of the asked attributes were demanded.
    pub policy: MatchPolicy,
    /// Which side "left" named.
    pub lateral: LateralConvention,
    /// The things meant, sorted by id.
    pub selection: Vec<EntityId>,
    /// How many there are, when that was the question.
    #[serde(default)]
    pub count: Option<usize>,
    /// Every candidate that is not impossible, most probable first; ties by id.
    pub ranking: Vec<Ranked>,
    /// Every candidate of the asked kind, sorted by id.
    pub trace: Vec<CandidateTrace>,
    /// What of the query could not be used.
    #[serde(default)]
    pub issues: Vec<Issue>,
}

impl Payload for Answer {
    const SCHEMA: &'static str = "jrdb.answer";
    const VERSION: u32 = 1;
}
