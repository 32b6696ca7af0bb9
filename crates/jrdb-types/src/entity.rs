//! What projection hands on: things with a place in space, and how they lie to each other.

use serde::{Deserialize, Serialize};

use crate::artefact::Payload;
use crate::attribute::Attributes;
use crate::capabilities::Capabilities;
use crate::detection::Interaction;
use crate::geometry::{Box3d, PixelBox};
use crate::id::{EntityId, FrameId};
use crate::issue::Issue;
use crate::vocab::{
    Direction, DistanceWord, HeadingSource, LateralConvention, Occlusion, PairWord,
    PlacementQuality,
};

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
    /// Probability in `[0, 1]` that the sector named by `direction` is the true one, given how well the
    /// reference's heading is known; absent where the direction is, or has no heading in it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction_probability: Option<f64>,
}

/// Which way somebody faces, and how well that is known.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Heading {
    /// Radians counter-clockwise from +x of the base frame, in (-π, π].
    pub angle_rad: f64,
    /// Standard deviation, radians.
    pub std_rad: f64,
    /// What tells it.
    pub source: HeadingSource,
}

/// Where a thing's lowest visible part is over the floor.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FloorContact {
    /// Height of the bottom edge of its image box over the floor, at its range, metres. Negative where the edge
    /// is below the floor.
    pub gap_m: f64,
    /// Whether the gap is small enough for the bottom edge to show the feet on the floor.
    pub touches: bool,
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
    /// Share of the points that could be the thing's, in its box and no farther than it, that are not in front
    /// of it, in `[0, 1]`; absent without points.
    #[serde(default)]
    pub visible_fraction: Option<f64>,
    /// How far the position can be trusted.
    pub quality: PlacementQuality,
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
    /// Number of the social group it belongs to, where the source tells groups.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub group: Option<u32>,
    /// How much of it others hide, where the source says so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub occlusion: Option<Occlusion>,
    /// Where in space; absent when nothing tells.
    #[serde(default)]
    pub position: Option<Position>,
    /// Box in space; absent when the position is, or when its source gives no size.
    #[serde(default)]
    pub box3d: Option<Box3d>,
    /// Direction it faces; absent when nothing tells.
    #[serde(default)]
    pub heading: Option<Heading>,
    /// Velocity along x and y of the base frame, metres per second, over the ground where the robot's own motion
    /// is known and relative to the robot otherwise; absent when only one frame is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity_mps: Option<[f64; 2]>,
    /// Whether its bottom edge shows where it stands; absent without a floor or a position.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub floor: Option<FloorContact>,
    /// Where it is, seen from the robot; absent when the position is.
    #[serde(default)]
    pub from_robot: Option<SpatialRelation>,
}

/// Where `object` is, seen from `subject`: "the object is to the subject's left"; and what else holds between
/// them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PairRelation {
    /// Whose front, left and right are meant; who hides, or faces.
    pub subject: EntityId,
    /// What is located; what is hidden, or faced.
    pub object: EntityId,
    /// Where it is.
    #[serde(flatten)]
    pub relation: SpatialRelation,
    /// Least distance between the two boxes in space, metres; 0 when they touch or overlap.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gap_m: Option<f64>,
    /// Intersection over union of the two boxes in space, in `[0, 1]`; left out when 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub overlap: Option<f64>,
    /// What the subject hides of the object from the robot; left out when nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hides: Option<Hides>,
    /// Angle from the subject's velocity to the object's, radians in (-π, π]; absent unless both are known and
    /// moving.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub motion_angle_rad: Option<f64>,
    /// The relations that hold, in words, in the vocabulary's order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub words: Vec<PairWord>,
}

impl PairRelation {
    /// A relation that says only where the object is.
    #[must_use]
    pub fn of(subject: EntityId, object: EntityId, relation: SpatialRelation) -> Self {
        let (gap_m, overlap, hides, motion_angle_rad) = (None, None, None, None);
        Self {
            subject,
            object,
            relation,
            gap_m,
            overlap,
            hides,
            motion_angle_rad,
            words: Vec::new(),
        }
    }
}

/// How much of a thing a nearer one hides from the robot.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Hides {
    /// Share of the hidden thing's image box that the nearer one's image box covers, in `[0, 1]`.
    pub image_fraction: f64,
    /// Share of the LiDAR points in the hidden thing's box, of those no farther than it, that are on the nearer
    /// one, in `[0, 1]`; absent without points.
    #[serde(default)]
    pub point_fraction: Option<f64>,
}

/// Somebody or something between two others.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Between {
    /// Who is between.
    pub middle: EntityId,
    /// The two others, sorted.
    pub ends: [EntityId; 2],
    /// Distance of the middle one from the straight line between the two, horizontally, metres.
    pub offset_m: f64,
    /// Where along that line, from the first end (0) to the second (1).
    pub fraction: f64,
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
    /// Who is between whom, sorted by the middle one, then the ends.
    #[serde(default)]
    pub between: Vec<Between>,
    /// What could have been seen.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub capabilities: Option<Capabilities>,
    /// What could not be placed, and why.
    #[serde(default)]
    pub issues: Vec<Issue>,
}

impl Entities {
    /// A frame in which nothing was placed.
    #[must_use]
    pub fn new(frame: FrameId, lateral: LateralConvention) -> Self {
        let (entities, relations) = (Vec::new(), Vec::new());
        let (between, issues) = (Vec::new(), Vec::new());
        Self { frame, lateral, entities, relations, between, capabilities: None, issues }
    }
}

impl Payload for Entities {
    const SCHEMA: &'static str = "jrdb.entities";
    const VERSION: u32 = 2;
}
