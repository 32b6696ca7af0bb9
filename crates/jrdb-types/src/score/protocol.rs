//! By which rules answers are judged.

use serde::{Deserialize, Serialize};

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

/// By which rules answers are judged. Only scores of the same protocol can be merged or compared.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Protocol {
    /// [`Protocol::VERSION`] of the program that judged.
    pub version: u32,
    /// Which IoU was used throughout.
    pub iou: IouKind,
    /// Circumference of the circle that IoU is taken on, pixels; absent on the plane.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub period_px: Option<f64>,
    /// Least IoU of a match between a selected and a true box.
    pub match_iou: f64,
    /// A digest of the whole set of questions, as the caller gave it; absent when it gave none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub questions_digest: Option<String>,
}

impl Protocol {
    /// Raised when the same answer would be judged differently.
    pub const VERSION: u32 = 1;
}
