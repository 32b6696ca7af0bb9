//! What search hands on: the reply, who was meant, how probable each candidate is, and why.

mod found;
mod status;
mod trace;
mod why_not;

pub use found::{
    DirectionFound, DistanceFound, HeadingFound, Landmark, PropertyValue, PropertyValues,
};
pub use status::{Cause, CauseKind, Count, Possible, Status};
pub use trace::{CandidateTrace, Check, Criterion, Finding, Measured, Partner, Unit};
pub use why_not::{Reason, WhyNot};

use serde::{Deserialize, Serialize};

use crate::artefact::Payload;
use crate::geometry::PixelBox;
use crate::id::{EntityId, FrameId};
use crate::issue::Issue;
use crate::query::{Command, Query, Task};
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

/// The answer to what was asked.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Reply {
    /// The selection itself.
    Things,
    /// How many.
    Number(Count),
    /// Yes or no; absent when it cannot be determined.
    YesNo(Option<bool>),
    /// Values or places, sorted by thing, then as asked.
    #[serde(rename = "told")]
    Properties(Vec<PropertyValues>),
}

/// One thing at one moment of a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Sighting {
    /// Who.
    pub id: EntityId,
    /// Number of the frame.
    pub frame: u32,
    /// Where in its image, pixels.
    #[serde(rename = "box")]
    pub bbox: PixelBox,
}

/// The answer for one slot of a question about time.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SlotAnswer {
    /// Who matches when, sorted by id, then frame.
    pub seen: Vec<Sighting>,
}

/// Whether a change lets a thing into the answer or takes it out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Effect {
    /// It becomes part of the answer.
    Enters,
    /// It is no longer part of the answer.
    Leaves,
}

/// The smallest change of one number that changes the answer for one thing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Change {
    /// Which candidate.
    pub id: EntityId,
    /// What would happen to it.
    pub effect: Effect,
    /// Which condition, in words; empty until `jrdb-render` fills it.
    #[serde(rename = "condition", default)]
    pub words: String,
    /// Which condition.
    #[serde(default)]
    pub criterion: Criterion,
    /// Whose number it is, where it is not the candidate's own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub witness: Option<EntityId>,
    /// The number now, and where it has to go.
    pub measured: Measured,
    /// The bound it would cross.
    pub to: f64,
    /// The change in standard deviations of that number, where a deviation is known; changes are sorted by it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub deviations: Option<f64>,
}

/// The answer to one query, on one frame or a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Answer {
    /// The frame; of a recording, the first.
    pub frame: FrameId,
    /// The question's words.
    pub question: String,
    /// The question's name in its file, where it has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub question_id: Option<String>,
    /// What was asked.
    pub task: Task,
    /// What is to be done with the things meant, which is up to the robot; absent where nothing is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub command: Option<Command>,
    /// How many of the asked attributes were demanded.
    pub policy: MatchPolicy,
    /// Which side "left" named.
    pub lateral: LateralConvention,
    /// Whether the question could be answered.
    #[serde(default)]
    pub status: Status,
    /// Why it could not, sorted; empty when it could.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub because: Vec<Cause>,
    /// The reply.
    pub reply: Reply,
    /// Probability of the reply, in `[0, 1]`; absent when it cannot be stated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub probability: Option<f64>,
    /// The things meant, sorted by id; a guess unless the question was answered.
    pub selection: Vec<EntityId>,
    /// The things that may be meant besides those that certainly are, sorted by id.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub possible: Vec<Possible>,
    /// Every candidate that is not impossible, most probable first; ties by id.
    pub ranking: Vec<Ranked>,
    /// Every candidate of the asked kind, sorted by id.
    pub trace: Vec<CandidateTrace>,
    /// Who matched when, one entry per slot; empty for questions that do not speak of time.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub slots: Vec<SlotAnswer>,
    /// The smallest changes that change the answer; empty unless asked for.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sensitivity: Vec<Change>,
    /// What of the query could not be used.
    #[serde(default)]
    pub issues: Vec<Issue>,
}

impl Answer {
    /// An answer that selects nothing, without reasons; it repeats the question and the question's issues.
    #[must_use]
    pub fn new(
        frame: FrameId,
        query: &Query,
        policy: MatchPolicy,
        lateral: LateralConvention,
    ) -> Self {
        Self {
            frame,
            question: query.text.clone(),
            question_id: None,
            task: query.task.clone(),
            command: query.command.clone(),
            policy,
            lateral,
            status: Status::Answered,
            because: Vec::new(),
            reply: Reply::Things,
            probability: None,
            selection: Vec::new(),
            possible: Vec::new(),
            ranking: Vec::new(),
            trace: Vec::new(),
            slots: Vec::new(),
            sensitivity: Vec::new(),
            issues: query.issues.clone(),
        }
    }

    /// How many there are, when that was the question and the number is known.
    #[must_use]
    pub fn number(&self) -> Option<usize> {
        if let Reply::Number(count) = self.reply { count.exact() } else { None }
    }
}

impl Payload for Answer {
    const SCHEMA: &'static str = "jrdb.answer";
    const VERSION: u32 = 4;
}
