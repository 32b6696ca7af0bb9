//! Questions with their known answers, for scoring.

use serde::{Deserialize, Serialize};

use crate::artefact::Payload;
use crate::geometry::PixelBox;
use crate::id::{EntityId, FrameId};

/// The known answer.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Truth {
    /// Who is meant, sorted; empty where the source gives boxes only.
    #[serde(default)]
    pub ids: Vec<EntityId>,
    /// Their boxes, pixels.
    pub boxes: Vec<PixelBox>,
    /// The number asked for, in counting questions.
    #[serde(default)]
    pub count: Option<usize>,
    /// Yes or no, in questions that ask so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub yes_no: Option<bool>,
    /// The words asked for: values of attributes, actions or places, in the vocabulary's spelling; neither their
    /// case nor their order matters.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub words: Vec<String>,
}

/// One question about one frame, or about a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Question {
    /// Its name in its file, by which answers of other programs refer to it, where it has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub id: Option<String>,
    /// The words.
    pub text: String,
    /// What the words mean, in the notation of queries, where its author says so. It is not what is
    /// asked: it tells what a misreading costs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub query: Option<String>,
    /// The benchmark's category, for example `gender-age-race-HHG`; scores are averaged by it.
    pub category: String,
    /// The frame; of a recording, the first that is asked about.
    pub frame: FrameId,
    /// For a question about a recording, the numbers of the frames of each of its slots, one after the other in time;
    /// empty for a question about one frame, and where the question's own words say when.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub slots: Vec<Vec<u32>>,
    /// The known answer, where there is one.
    #[serde(default)]
    pub truth: Option<Truth>,
}

impl Question {
    /// A question that somebody typed: without a category and without a known answer.
    #[must_use]
    pub fn typed(text: impl Into<String>, frame: FrameId) -> Self {
        let (category, slots) = (String::new(), Vec::new());
        let (id, query, truth) = (None, None, None);
        Self { id, text: text.into(), query, category, frame, slots, truth }
    }
}

/// A list of questions, in the order of their file.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Questions {
    /// The questions.
    pub questions: Vec<Question>,
}

impl Payload for Questions {
    const SCHEMA: &'static str = "jrdb.questions";
    const VERSION: u32 = 1;
}
