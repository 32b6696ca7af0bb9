//! Where things are, seen from the robot and from each other, and what else holds between them: the paper's
//! f_geo. One file per relation, with its exact definition.

pub mod adjacency;
pub mod between;
pub mod certainty;
pub mod direction;
pub mod distance;
pub mod facing;
pub mod height;
pub mod motion;
pub mod occlusion;
pub mod overlap;
pub mod pairwise;
mod polygon;
mod relate;
#[cfg(test)]
mod tests;

use jrdb_types::{LateralConvention, SpatialRelation};
use nalgebra::{Point3, Vector3};
use serde::{Deserialize, Serialize};

pub use pairwise::Pairwise;
pub use relate::{Thing, between_all, relate};

/// Every threshold of the relations that the benchmark does not define.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RelationConfig {
    /// "Next to" holds up to this gap between the boxes, metres: within an arm's reach.
    pub adjacent_max_m: f64,
    /// Somebody in front must be nearer to the robot than whom they hide by this much, metres: half a person's
    /// depth, so that neighbours at one range hide nothing of each other.
    pub hides_clearance_m: f64,
    /// "In front of" (as hiding) holds from this share of the hidden image box. People fill about half of
    /// their boxes, so less than a tenth is often nothing.
    pub hides_min_fraction: f64,
    /// Nobody "faces" what is farther than this, metres: the end of the word "moderate".
    pub facing_max_m: f64,
    /// "Between" holds up to this distance from the straight line, metres: half a person's width and a step.
    pub between_max_offset_m: f64,
    /// Whoever is "between" is at least this far along the line from either end, metres: not beside one of them.
    pub between_min_inside_m: f64,
    /// The two ends of "between" are at most this far apart, metres: the end of the word "moderate".
    pub between_max_apart_m: f64,
    /// Slower than this is standing, metres per second: a third of a slow walk.
    pub moving_min_mps: f64,
    /// "Moving with" holds up to this angle between the velocities, radians.
    pub same_direction_rad: f64,
}

impl Default for RelationConfig {
    /// Lengths of a person's body and reach, and the benchmark's word bounds; see each field.
    fn default() -> Self {
        Self {
            adjacent_max_m: 0.5,
            hides_clearance_m: 0.3,
            hides_min_fraction: 0.1,
            facing_max_m: 5.0,
            between_max_offset_m: 0.5,
            between_min_inside_m: 0.3,
            between_max_apart_m: 5.0,
            moving_min_mps: 0.3,
            same_direction_rad: std::f64::consts::FRAC_PI_6,
        }
    }
}

/// Wraps an angle into (-π, π], radians.
#[must_use]
pub fn wrap_rad(angle: f64) -> f64 {
    let turned = angle.rem_euclid(std::f64::consts::TAU);
    if turned > std::f64::consts::PI { turned - std::f64::consts::TAU } else { turned }
}

/// Where a thing at `center` is, seen from the robot at the base frame's origin, facing +x.
#[must_use]
pub fn from_robot(center: &Point3<f64>, lateral: LateralConvention) -> SpatialRelation {
    let direction = direction::of_vector(&center.coords, lateral);
    SpatialRelation {
        direction: Some(direction),
        bearing_rad: Some(wrap_rad(center.y.atan2(center.x))),
        ..apart(&center.coords)
    }
}

/// Where a thing at `center` is, seen from a person at `reference` who faces `heading_rad`.
///
/// Without a heading there is no bearing and no direction. Under
/// [`LateralConvention::BenchmarkMirrored`] up and down are exchanged, as in the benchmark's engine.
#[must_use]
pub fn from_person(
    reference: &Point3<f64>,
    heading_rad: Option<f64>,
    center: &Point3<f64>,
    lateral: LateralConvention,
) -> SpatialRelation {
    let offset = center - reference;
    let Some(heading_rad) = heading_rad else { return apart(&offset) };
    let (sin, cos) = heading_rad.sin_cos();
    let ahead = cos * offset.x + sin * offset.y;
    let left = cos * offset.y - sin * offset.x;
    let rise = match lateral {
        LateralConvention::Physical => offset.z,
        LateralConvention::BenchmarkMirrored => -offset.z,
    };
    SpatialRelation {
        direction: Some(direction::of_vector(&Vector3::new(ahead, left, rise), lateral)),
        bearing_rad: Some(wrap_rad(left.atan2(ahead))),
        ..apart(&offset)
    }
}

/// What does not depend on a heading: distance and height difference.
fn apart(offset: &Vector3<f64>) -> SpatialRelation {
    let distance_m = offset.norm();
    SpatialRelation {
        distance: distance::word(distance_m),
        distance_m: Some(distance_m),
        rise_m: Some(offset.z),
        ..SpatialRelation::default()
    }
}
