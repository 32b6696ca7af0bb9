//! Every number that shapes headings.

use serde::{Deserialize, Serialize};

/// Every number that shapes headings.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct HeadingConfig {
    /// Standard deviation of a labelled heading, radians: 1.48 times the 8.6° that JRDB's labels of walking
    /// people differ from the way they walk in the median (720 samples of bytes-cafe-2019-02-07_0).
    pub label_std_rad: f64,
    /// Standard deviation of a heading by the attribute "facing" that is certain of its word, radians: that of an angle
    /// evenly spread over 45°, and half a sector for a word next to the right one.
    pub facing_std_rad: f64,
    /// A belief in facings that is spread wider than this tells nothing, radians.
    pub facing_max_std_rad: f64,
    /// Slower than this, motion tells no heading, metres per second.
    pub motion_min_mps: f64,
    /// Standard deviation of a position against those of the same thing in neighbouring frames, metres: half the
    /// median error of the default localiser on one real frame. Assumed: no labelled sequence of clouds was at hand.
    pub motion_position_std_m: f64,
    /// Standard deviation of the body's heading around the way it walks, radians: measured as `label_std_rad`.
    pub motion_body_std_rad: f64,
    /// Fewer points do not show the line of the shoulders: on the real frame the lines from fewer were of no use.
    pub shape_min_points: usize,
    /// The body must be this many times as wide as what is seen of its depth.
    pub shape_min_elongation: f64,
    /// Standard deviation of the line of the shoulders, radians: root mean square over 12 people of one real
    /// frame, of whom two were seen as something else (median 12°).
    pub shape_std_rad: f64,
}

impl Default for HeadingConfig {
    /// Measured where each field says so, reasoned elsewhere.
    fn default() -> Self {
        Self {
            label_std_rad: 0.22,
            facing_std_rad: 0.4,
            facing_max_std_rad: 1.0,
            motion_min_mps: 0.5,
            motion_position_std_m: 0.07,
            motion_body_std_rad: 0.22,
            shape_min_points: 100,
            shape_min_elongation: 1.3,
            shape_std_rad: 0.43,
        }
    }
}
