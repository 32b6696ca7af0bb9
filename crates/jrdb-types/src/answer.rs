//! What search hands on: the reply, who was meant, how probable each candidate is, and why.

use serde::{Deserialize, Serialize};

use crate::artefact::Payload;
use crate::geometry::PixelBox;
use crate::id::{EntityId, FrameId};
use crate::issue::Issue;
use crate::query::{Interval, Property, Task};
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

/// One condition, checked on one candidate.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Check {
    /// What was asked, in words.
    pub asked: String,
    /// What was found, in words; absent when nothing is known.
    #[serde(default)]
    pub found: Option<String>,
    /// Whether it holds.
    pub holds: bool,
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

/// What is told of one thing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Told {
    /// Of which thing.
    pub id: EntityId,
    /// Which property; absent for a place.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub property: Option<Property>,
    /// Its values in words, most probable or nearest first; empty when unknown.
    pub words: Vec<String>,
}

/// The answer to what was asked.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Reply {
    /// The selection itself.
    Things,
    /// How many.
    Number(usize),
    /// Yes or no.
    YesNo(bool),
    /// Values or places, sorted by thing, then as asked.
    Told(Vec<Told>),
}

/// Somebody at one moment of a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Seen {
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
    pub seen: Vec<Seen>,
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
    /// Which condition, in words.
    pub condition: String,
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
    /// What was asked.
    pub task: Task,
    /// How many of the asked attributes were demanded.
    pub policy: MatchPolicy,
    /// Which side "left" named.
    pub lateral: LateralConvention,
    /// The reply.
    pub reply: Reply,
    /// The things meant, sorted by id.
    pub selection: Vec<EntityId>,
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
    /// How many there are, when that was the question.
    #[must_use]
    pub fn number(&self) -> Option<usize> {
        if let Reply::Number(number) = self.reply { Some(number) } else { None }
    }
}

impl Payload for Answer {
    const SCHEMA: &'static str = "jrdb.answer";
    const VERSION: u32 = 2;
}
