//! Motion: who moves the same way as whom.

/// Angle from one horizontal velocity to another, radians counter-clockwise in (-π, π]; `None` when either is
/// slower than `min_mps`.
///
/// "Moving with" holds within [`super::RelationConfig::same_direction_rad`] either way, for two who both move at
/// [`super::RelationConfig::moving_min_mps`] or more.
///
/// ```
/// use jrdb_projection::relation::motion;
/// let quarter = motion::angle_rad([1.0, 0.0], [0.0, 1.0], 0.3).unwrap();
/// assert_eq!(quarter, std::f64::consts::FRAC_PI_2);
/// assert_eq!(motion::angle_rad([1.0, 0.0], [0.1, 0.0], 0.3), None);
/// ```
#[must_use]
pub fn angle_rad(from: [f64; 2], to: [f64; 2], min_mps: f64) -> Option<f64> {
    let moves = |v: [f64; 2]| v[0].hypot(v[1]) >= min_mps;
    let cross = from[0] * to[1] - from[1] * to[0];
    let dot = from[0] * to[0] + from[1] * to[1];
    (moves(from) && moves(to)).then(|| super::wrap_rad(cross.atan2(dot)))
}
