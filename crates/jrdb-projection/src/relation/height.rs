//! Heights of upright boxes: what they share, and how far one is over the other.

use jrdb_types::Box3d;

/// Height that two boxes share, metres; 0 when one is over the other.
#[must_use]
pub fn shared_m(a: &Box3d, b: &Box3d) -> f64 {
    between_faces(a, b).max(0.0)
}

/// Height of the free space between two boxes, one over the other, metres; 0 when they share any height.
#[must_use]
pub fn gap_m(a: &Box3d, b: &Box3d) -> f64 {
    (-between_faces(a, b)).max(0.0)
}

/// The lower top less the higher bottom, relative to the centre of `b`, where equal boxes come out without rounding.
fn between_faces(a: &Box3d, b: &Box3d) -> f64 {
    let rise = a.center[2] - b.center[2];
    let [half_a, half_b] = [a, b].map(|c| c.size[2].max(0.0) / 2.0);
    (rise + half_a).min(half_b) - (rise - half_a).max(-half_b)
}
