//! Two runs over the same questions.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::{Interval, IntervalWarning, Metric, Protocol, QuestionScore};
use crate::artefact::Payload;
use crate::id::FrameId;

/// A metric of two runs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Difference {
    /// Which metric.
    pub metric: Metric,
    /// Its value in the first run.
    pub a: f64,
    /// Its value in the second run.
    pub b: f64,
    /// `b - a`.
    pub difference: f64,
    /// Where the difference may be; absent when that cannot be told.
    #[serde(default)]
    pub interval: Option<Interval>,
    /// Whether the interval contains zero: the difference is not distinguishable from none. Absent
    /// without an interval.
    #[serde(default)]
    pub contains_zero: Option<bool>,
    /// How many recordings tell it.
    pub recordings: usize,
    /// What to know before the interval is trusted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub warning: Option<IntervalWarning>,
}

/// Which question.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct QuestionName {
    /// The frame.
    pub frame: FrameId,
    /// The question's name in its file, where it has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub question_id: Option<String>,
    /// The question's words.
    pub question: String,
    /// The question's category.
    pub category: String,
}

impl From<&QuestionScore> for QuestionName {
    fn from(score: &QuestionScore) -> Self {
        Self {
            frame: score.frame.clone(),
            question_id: score.question_id.clone(),
            question: score.question.clone(),
            category: score.category.clone(),
        }
    }
}

/// How a second run differs from a first one, over the same questions by the same protocol.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Comparison {
    /// By which rules both were judged.
    pub protocol: Protocol,
    /// How many questions were asked.
    pub questions: usize,
    /// How many recordings they are about.
    pub recordings: usize,
    /// By category; metrics that nothing tells are left out.
    pub categories: BTreeMap<String, Vec<Difference>>,
    /// All questions.
    pub overall: Vec<Difference>,
    /// Questions that the second run answers exactly and the first does not, by frame and name.
    pub fixed: Vec<QuestionName>,
    /// Questions that the first run answers exactly and the second does not, by frame and name.
    pub broken: Vec<QuestionName>,
}

impl Payload for Comparison {
    const SCHEMA: &'static str = "jrdb.comparison";
    const VERSION: u32 = 1;
}
