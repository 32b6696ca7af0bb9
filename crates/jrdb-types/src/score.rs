//! How good answers are.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::artefact::Payload;
use crate::geometry::PixelBox;
use crate::id::{EntityId, FrameId};

/// Which intersection over union was used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum IouKind {
    /// On the plane, as the official evaluators do: a box across the seam is a box that sticks out.
    #[default]
    Planar,
    /// On the circle: shifting a box by a whole turn changes nothing.
    Circular,
}

/// One question's score.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct QuestionScore {
    /// The frame.
    pub frame: FrameId,
    /// The question's words.
    pub question: String,
    /// The question's category.
    pub category: String,
    /// Whether the selection is exactly the truth: ids as sets; the number, in counting questions.
    /// Absent where the truth gives boxes only.
    #[serde(default)]
    pub exact: Option<bool>,
    /// Ground-truth boxes with a selected box of IoU at least 0.5.
    pub true_positives: usize,
    /// Selected boxes without a ground-truth box.
    pub false_positives: usize,
    /// Ground-truth boxes without a selected box.
    pub false_negatives: usize,
    /// Sum of the IoU of the matched boxes.
    pub matched_iou: f64,
}

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

/// Scores of a set of questions.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Summary {
    /// Questions scored.
    pub questions: usize,
    /// Questions answered exactly.
    pub exact: usize,
    /// Mean over questions of (sum of matched IoU / number of ground-truth boxes): the headline.
    pub miou_gt: f64,
    /// Sum of matched IoU over all questions / number of matches.
    pub miou_matched: f64,
    /// Mean over questions of (sum of matched IoU / number of matches, 0 without a match).
    pub miou_query: f64,
    /// True positives / selected boxes, over all questions, at IoU 0.5.
    pub precision: f64,
    /// True positives / ground-truth boxes, over all questions, at IoU 0.5.
    pub recall: f64,
    /// Average precision at IoU 0.5, ranking pooled over all questions, COCO's 101 points.
    pub ap50: f64,
    /// Mean of the average precision over IoU 0.50, 0.55 … 0.95.
    pub map: f64,
}

/// Scores of a run: each question, each category, all.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Scores {
    /// Which IoU was used throughout.
    pub iou: IouKind,
    /// Every question, in the order asked.
    pub questions: Vec<QuestionScore>,
    /// By category.
    pub categories: BTreeMap<String, Summary>,
    /// All questions.
    pub overall: Summary,
}

impl Payload for Scores {
    const SCHEMA: &'static str = "jrdb.scores";
    const VERSION: u32 = 1;
}
