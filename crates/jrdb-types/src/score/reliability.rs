//! Whether probabilities are what they say, and what is taken for what.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// The candidates whose probability lies in `(from, to]`; the first bin includes 0.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ReliabilityBin {
    /// Lower end.
    pub from: f64,
    /// Upper end.
    pub to: f64,
    /// How many candidates.
    pub count: usize,
    /// Mean of their probabilities; 0 without candidates.
    pub probability: f64,
    /// Share of them that is right; 0 without candidates.
    pub right: f64,
}

/// Stated probabilities beside the share that is right.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Reliability {
    /// Expected calibration error: the mean over candidates of |right - probability| of their bin.
    pub calibration_error: f64,
    /// The bins, ascending, of equal width.
    pub bins: Vec<ReliabilityBin>,
}

/// How often each word was said of what another is true of: left for right, for example.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Confusion {
    /// Counts by the true word, then by the word said.
    pub counts: BTreeMap<String, BTreeMap<String, usize>>,
}

impl Confusion {
    /// How often `said` was said of what `truth` is true of.
    #[must_use]
    pub fn count(&self, truth: &str, said: &str) -> usize {
        self.counts.get(truth).and_then(|row| row.get(said)).copied().unwrap_or(0)
    }
}
