//! Overlap: intersection over union of two upright boxes in space.

use jrdb_types::Box3d;

use super::height;
use super::polygon::Rectangle;

/// What is this near to 0 or to 1 is rounding, and becomes 0 or 1: boxes that touch share nothing, and a box is
/// its own equal, wherever in the room they are.
const ROUNDING: f64 = 1e-12;

/// Intersection over union of two boxes' volumes, in `[0, 1]`.
///
/// Boxes are upright and turned by their headings; the shared volume is the area that the footprints share times
/// the height that they share. Touching boxes give 0, and so does a box without volume or with a number
/// that is not finite. Symmetric.
///
/// ```
/// use jrdb_projection::relation::overlap;
/// use jrdb_types::Box3d;
/// let a = Box3d { center: [0.0; 3], size: [2.0, 1.0, 1.0], heading_rad: 0.0 };
/// let crosswise = Box3d { heading_rad: std::f64::consts::FRAC_PI_2, ..a };
/// assert!((overlap::iou(&a, &crosswise) - 1.0 / 3.0).abs() < 1e-15);
/// assert_eq!(overlap::iou(&a, &a), 1.0);
/// ```
#[must_use]
pub fn iou(a: &Box3d, b: &Box3d) -> f64 {
    // The first in a fixed order, so that (a, b) and (b, a) round alike.
    let (a, b) = if key(a) <= key(b) { (a, b) } else { (b, a) };
    let [volume_a, volume_b]: [f64; 2] =
        [a, b].map(|c| c.size.iter().map(|side| side.max(0.0)).product());
    if apart(a, b) {
        return 0.0;
    }
    let area = Rectangle::footprint(a).shared_area(&Rectangle::footprint(b));
    let shared = area * height::shared_m(a, b);
    let iou: f64 = shared / (volume_a + volume_b - shared);
    match iou {
        iou if iou > ROUNDING => {
            if iou < 1.0 - ROUNDING {
                iou
            } else {
                1.0
            }
        }
        _ => 0.0, // and for what is not a number
    }
}

/// Whether the circles around the footprints are apart: most pairs are.
fn apart(a: &Box3d, b: &Box3d) -> bool {
    // Half the diagonals: of a sum of two, the square is at most twice the sum of the squares.
    let square = |side_a: f64, side_b: f64| side_a * side_a + side_b * side_b;
    let reach = square(a.size[0], a.size[1]) + square(b.size[0], b.size[1]);
    square(a.center[0] - b.center[0], a.center[1] - b.center[1]) > reach / 2.0
}

fn key(b: &Box3d) -> ([f64; 3], [f64; 3], f64) {
    (b.center, b.size, b.heading_rad)
}
