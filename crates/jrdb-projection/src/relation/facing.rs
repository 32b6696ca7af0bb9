//! Facing: who looks at whom.

/// Half the angle within which somebody looks at a thing, radians: the benchmark's sector "front".
pub const FRONT_HALF_ANGLE_RAD: f64 = std::f64::consts::FRAC_PI_6;

/// Whether somebody who sees a thing at this bearing, radians from the front, and this distance, metres, faces it.
///
/// Holds within [`FRONT_HALF_ANGLE_RAD`] either way and up to `max_m`
/// ([`super::RelationConfig::facing_max_m`]). "Facing each other" holds when it holds both ways. A heading is the body's,
/// not the eyes'.
///
/// ```
/// use jrdb_projection::relation::facing;
/// assert!(facing::holds(0.2, 1.5, 5.0));
/// assert!(!facing::holds(0.6, 1.5, 5.0));
/// ```
#[must_use]
pub fn holds(bearing_rad: f64, distance_m: f64, max_m: f64) -> bool {
    bearing_rad.abs() <= FRONT_HALF_ANGLE_RAD && distance_m <= max_m
}
