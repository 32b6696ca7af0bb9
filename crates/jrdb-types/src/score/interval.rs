//! How far a metric may be from the truth, because only so many recordings were seen.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::Metric;

/// How an interval was made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum IntervalMethod {
    /// Studentised bootstrap over recordings.
    BootstrapT,
    /// Standard error over recordings times Student's quantile: for few recordings, and where
    /// almost none of them differs.
    StudentT,
    /// Standard error by leaving out one recording at a time, times Student's quantile.
    JackknifeT,
}

/// What to know before an interval is trusted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum IntervalWarning {
    /// One recording tells the metric: no interval.
    OneRecording,
    /// Nothing tells the metric in a run, or in all but one of its recordings: no interval.
    NoValue,
    /// There are fewer than ten recordings: the interval may be too narrow.
    FewRecordings,
}

/// A 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Interval {
    /// Its lower end.
    pub low: f64,
    /// Its upper end.
    pub high: f64,
    /// How it was made.
    pub method: IntervalMethod,
}

impl Interval {
    /// Whether a value lies in it, ends included.
    #[must_use]
    pub fn contains(&self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }

    /// Half its width.
    #[must_use]
    pub fn half_width(&self) -> f64 {
        (self.high - self.low) / 2.0
    }
}

/// A metric with its interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Estimate {
    /// Which metric.
    pub metric: Metric,
    /// Its value.
    pub value: f64,
    /// Where it may be; absent when that cannot be told.
    #[serde(default)]
    pub interval: Option<Interval>,
    /// How many recordings tell it.
    pub recordings: usize,
    /// What to know before the interval is trusted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub warning: Option<IntervalWarning>,
}

/// Scores with their intervals; metrics that nothing tells are left out.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Intervals {
    /// By category.
    pub categories: BTreeMap<String, Vec<Estimate>>,
    /// All questions.
    pub overall: Vec<Estimate>,
}
