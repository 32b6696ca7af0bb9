//! How good answers are: judgements of questions, what they sum up to, and how sure that is.

mod budget;
mod comparison;
mod interval;
mod judgement;
mod metric;
mod protocol;
mod reliability;
mod summary;

pub use budget::{Budget, Share};
pub use comparison::{Comparison, Difference, QuestionName};
pub use interval::{Estimate, Interval, IntervalMethod, IntervalWarning, Intervals};
pub use judgement::{Candidate, CountJudged, MatchMask, QuestionScore, ReplyKind, YesNoJudged};
pub use metric::Metric;
pub use protocol::{IouKind, Protocol};
pub use reliability::{Confusion, Reliability, ReliabilityBin};
pub use summary::{CountSummary, Summary, WordSummary, YesNoSummary};

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::artefact::Payload;
use crate::geometry::PixelBox;
use crate::id::EntityId;

/// One difference between an answer and the truth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Miss {
    /// Nothing was detected where the truth has this box, pixels.
    NotDetected(PixelBox),
    /// It was detected and is meant, but not selected.
    NotSelected(EntityId),
    /// It is selected and not meant.
    NotMeant(EntityId),
}

/// Scores of a run: the judgement of each question, and what they sum up to.
///
/// The sums follow from the judgements alone, so that scores of parts can be merged.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Scores {
    /// By which rules answers were judged.
    pub protocol: Protocol,
    /// Every question's judgement, in the order asked.
    pub questions: Vec<QuestionScore>,
    /// By category.
    pub categories: BTreeMap<String, Summary>,
    /// All questions.
    pub overall: Summary,
    /// How sure the sums are, where that was computed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub intervals: Option<Intervals>,
}

impl Payload for Scores {
    const SCHEMA: &'static str = "jrdb.scores";
    const VERSION: u32 = 2;
}
