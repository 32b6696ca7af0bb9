//! What projection hands on: things with a place in space, and how they lie to each other.

use serde::{Deserialize, Serialize};

use crate::artefact::Payload;
use crate::detection::{Attributes, Interaction};
use crate::geometry::{Box3d, PixelBox};
use crate::id::{EntityId, FrameId};
use crate::issue::Issue;
use crate::vocab::{Direction, DistanceWord, LateralConvention, Occlusion};

/// How a position is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Localizer {
    /// Densest range bin of the LiDAR points in the core of the box. Default: background and occluders
    /// dominate boxes.
    #[default]
    DensestRange,
    /// Mean of all LiDAR points in the box (the paper's definition).
    Mean,
    /// The 3D box that came with the detection: labels or a 3D detector.
    Given,
}

/// Where one thing is, seen from another: numbers, and the words for them.
///
/// The numbers are absent when the source had only words (a scene graph of the benchmark).
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SpatialRelation {
    /// Distance in words.
    #[serde(default)]
    pub distance: Option<DistanceWord>,
    /// Direction in words under the artefact's lateral convention; absent when the reference's heading is
    /// unknown.
    #[serde(default)]
    pub direction: Option<Direction>,
    /// Distance between the centres in 3D, metres.
    #[serde(default)]
    pub distance_m: Option<f64>,
    /// Bearing in the reference's own frame, radians counter-clockwise from its front, in (-π, π].
    #[serde(default)]
    pub bearing_rad: Option<f64>,
    /// Height of the thing's centre over the reference's centre, metres.
    #[serde(default)]
    pub rise_m: Option<f64>,
}

/// Where a thing is in the base frame (x forward, y left, z up), and how well that is known.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Position {
    /// Centre `[x, y, z]`, metres.
    pub center: [f64; 3],
    /// Which rule found it.
    pub localizer: Localizer,
    /// LiDAR points inside the image box.
    pub points_in_box: usize,
    /// Points that the rule used.
    pub points_used: usize,
    /// Nearest and farthest horizontal range of the used points, metres.
    pub range_m: [f64; 2],
}

/// A detection with its place in space.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Entity {
    /// Identity, as in the detection.
    pub id: EntityId,
    /// Class name, as in the detection.
    pub category: String,
    /// Confidence of the detection in `[0, 1]`.
    pub score: f64,
    /// Where in the image, pixels.
    #[serde(rename = "box")]
    pub bbox: PixelBox,
    /// What is believed of it.
    #[serde(default)]
    pub attributes: Attributes,
    /// With whom it does what.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub interactions: Vec<Interaction>,
    /// How much of it others hide, where the source says so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub occlusion: Option<Occlusion>,
    /// Where in space; absent when nothing tells.
    #[serde(default)]
    pub position: Option<Position>,
    /// Box in space; absent when the position is, or when its source gives no size.
    #[serde(default)]
    pub box3d: Option<Box3d>,
    /// Direction it faces, radians counter-clockwise from +x of the base frame, in (-π, π].
    #[serde(default)]
    pub heading_rad: Option<f64>,
    /// Where it is, seen from the robot; absent when the position is.
    #[serde(default)]
    pub from_robot: Option<SpatialRelation>,
}

/// Where `object` is, seen from `subject`: "the object is to the subject's left".
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PairRelation {
    /// Whose front, left and right are meant.
    pub subject: EntityId,
    /// What is located.
    pub object: EntityId,
    /// Where it is.
    #[serde(flatten)]
    pub relation: SpatialRelation,
}

/// Things of one frame in space, sorted by id, and every ordered pair of those that have a position.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Entities {
    /// The frame.
    pub frame: FrameId,
    /// Which side "left" names in the words below.
    pub lateral: LateralConvention,
    /// The things.
    pub entities: Vec<Entity>,
    /// Their relations, sorted by subject, then object.
    pub relations: Vec<PairRelation>,
    /// What could not be placed, and why.
    #[serde(default)]
    pub issues: Vec<Issue>,
}

impl Payload for Entities {
    const SCHEMA: &'static str = "jrdb.entities";
    const VERSION: u32 = 1;
}
