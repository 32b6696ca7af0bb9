//! Every number that shapes the search stage.

use jrdb_types::vocab::MatchPolicy;
use serde::{Deserialize, Serialize};

/// Configuration of [`crate::search`]. It is written into the artefact.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SearchConfig {
    /// How many of the asked attributes a candidate must have.
    pub policy: MatchPolicy,
    /// Standard deviation of a position, metres. It turns a distance or direction near a bound into a
    /// probability; what holds is decided by the words alone.
    pub position_sigma_m: f64,
    /// Standard deviation of a person's heading, radians.
    pub heading_sigma_rad: f64,
}

impl Default for SearchConfig {
    /// The deviations are the median errors of the default localiser (0.14 m) and of JRDB's heading labels
    /// (8.6°) on real frames of JRDB's sequence bytes-cafe-2019-02-07_0.
    fn default() -> Self {
        Self { policy: MatchPolicy::Ranked, position_sigma_m: 0.14, heading_sigma_rad: 0.15 }
    }
}
