//! Adjacency: how far two boxes in space are apart.

use jrdb_types::Box3d;

use super::height;
use super::polygon::Rectangle;

/// Least distance between the surfaces of two upright boxes, metres; 0 when they touch or overlap.
///
/// `hypot` of the horizontal distance between the footprints and the vertical gap, which is exact for upright
/// boxes. "Next to" holds up to [`super::RelationConfig::adjacent_max_m`].
///
/// ```
/// use jrdb_projection::relation::adjacency;
/// use jrdb_types::Box3d;
/// let a = Box3d { center: [0.0; 3], size: [1.0, 1.0, 2.0], heading_rad: 0.0 };
/// let b = Box3d { center: [3.0, 0.0, 0.5], ..a };
/// assert_eq!(adjacency::gap_m(&a, &b), 2.0);
/// ```
#[must_use]
pub fn gap_m(a: &Box3d, b: &Box3d) -> f64 {
    let apart_m = Rectangle::footprint(a).distance(&Rectangle::footprint(b));
    apart_m.hypot(height::gap_m(a, b))
}
