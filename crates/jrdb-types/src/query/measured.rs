//! Conditions on what can be measured.

use serde::{Deserialize, Serialize};

use super::{Interval, Measure, Pattern};

/// A measure within bounds: "at least 1.8 m tall".
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Measures {
    /// What is measured: height in metres, speed in metres per second.
    pub measure: Measure,
    /// The bounds.
    pub within: Interval,
}

/// Nearer to one thing than to another.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Nearer {
    /// To the nearest of these.
    pub to: Box<Pattern>,
    /// Than to the nearest of these.
    pub than: Box<Pattern>,
}
