//! Every number that shapes the projection stage.

use jrdb_types::{LateralConvention, Localizer};
use serde::{Deserialize, Serialize};

use crate::heading::HeadingConfig;
use crate::relation::RelationConfig;

/// Configuration of [`crate::project`]. It is written into the artefact.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ProjectionConfig {
    /// How positions are found.
    pub localizer: Localizer,
    /// Which side "left" names.
    pub lateral: LateralConvention,
    /// Columns of the box that `densest-range` looks at, as fractions of its width: away from the sides,
    /// where the background shows.
    pub core_columns: [f64; 2],
    /// Rows of the box that `densest-range` looks at, as fractions of its height from the top: head to
    /// thigh, above tables and the floor.
    pub core_rows: [f64; 2],
    /// Length of the range bin of `densest-range`, metres: a body with its arms and legs. From
    /// measurements on a real JRDB frame.
    pub bin_m: f64,
    /// How far the middle of a person lies behind the surface that the LiDAR sees, metres: half the depth
    /// of a torso.
    pub surface_to_center_m: f64,
    /// Heights a person may have, metres: from a small or seated child to a tall adult. Ranges at which the
    /// image box would be smaller or taller than this are not the person's.
    pub person_height_m: [f64; 2],
    /// Length along the heading and width across it of a person's 3D box, metres: medians of the labels of
    /// JRDB's sequence bytes-cafe-2019-02-07_0.
    pub person_footprint_m: [f64; 2],
    /// A position from fewer points than this is poor and carries an issue; fewer points of a thing of unknown
    /// size make no box.
    pub few_points: usize,
    /// A position from fewer points than this is doubtful.
    pub good_points: usize,
    /// A position of which less is visible than this is doubtful.
    pub good_visible_fraction: f64,
    /// The bottom edge of a box shows the feet on the floor when it is at most this far over or under it, metres. JRDB's
    /// official panorama model draws feet 0.1 m too low at 3 m.
    pub floor_tolerance_m: f64,
    /// Headings.
    pub heading: HeadingConfig,
    /// Relations.
    pub relation: RelationConfig,
}

impl Default for ProjectionConfig {
    /// Values chosen on one real JRDB frame of 20 people; see each field.
    fn default() -> Self {
        Self {
            localizer: Localizer::default(),
            lateral: LateralConvention::default(),
            core_columns: [0.2, 0.8],
            core_rows: [0.1, 0.7],
            bin_m: 0.5,
            surface_to_center_m: 0.1,
            person_height_m: [1.0, 2.2],
            person_footprint_m: [0.95, 0.52],
            few_points: 5,
            good_points: 20,
            good_visible_fraction: 0.5,
            floor_tolerance_m: 0.25,
            heading: HeadingConfig::default(),
            relation: RelationConfig::default(),
        }
    }
}
