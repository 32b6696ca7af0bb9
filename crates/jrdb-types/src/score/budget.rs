//! What each kind of error costs.

use serde::{Deserialize, Serialize};

/// What it is worth to know one part of the truth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Share {
    /// Which part of the truth, for example `attributes`.
    pub truth: String,
    /// The gain of this part alone.
    pub alone: f64,
    /// The gain of this part after all parts before it.
    pub cumulative: f64,
    /// Its Shapley value: its gain, averaged over all orders of the parts. Those of all parts add
    /// up to the gap.
    pub shapley: f64,
}

/// How the gap between a run and one that is given the truth splits into parts of the truth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Budget {
    /// The metric with nothing given.
    pub without: f64,
    /// The metric with everything given.
    pub with_all: f64,
    /// The parts of the truth, in the order given.
    pub shares: Vec<Share>,
}

impl Budget {
    /// What knowing everything is worth.
    #[must_use]
    pub fn gap(&self) -> f64 {
        self.with_all - self.without
    }
}
