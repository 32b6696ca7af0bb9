//! What the rows of an image box say of heights: how high a thing in it is at a range.

use jrdb_types::PixelBox;
use nalgebra::Point3;

use crate::CameraModel;

/// A box that comes this near to the top or bottom row, pixels, is taken to be cut off by the image.
const EDGE_PX: f64 = 2.0;

/// The lines of sight through the middle of a box's top and bottom edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoxView {
    /// Where the lines start, metres, base frame. Ranges are horizontal distances from here.
    pub origin: Point3<f64>,
    /// Rise of the top and the bottom line per metre of horizontal range.
    pub slopes: [f64; 2],
    /// Whether the image cuts off the box at the top, and at the bottom.
    pub cut_off: [bool; 2],
}

impl BoxView {
    /// The view of a box; `None` where the lens has no line of sight through its edges or the upper line is
    /// not above the lower one.
    #[must_use]
    pub fn new(bbox: &PixelBox, camera: &dyn CameraModel) -> Option<Self> {
        let image = camera.image();
        let middle = bbox.x + bbox.w / 2.0;
        let column = image.period_px().map_or(middle, |period| middle.rem_euclid(period));
        let slope = |row: f64| {
            let ray = camera.ray_from_pixel(column, row)?;
            Some(ray.z / ray.x.hypot(ray.y)).filter(|slope| slope.is_finite())
        };
        let bottom_row = bbox.y + bbox.h;
        let slopes = [slope(bbox.y)?, slope(bottom_row)?];
        let cut_off = [bbox.y < EDGE_PX, bottom_row > f64::from(image.height_px) - EDGE_PX];
        let origin = camera.ray_origin(column, bottom_row);
        (slopes[0] > slopes[1]).then_some(Self { origin, slopes, cut_off })
    }

    /// Horizontal range of a point from where the lines of sight start, metres.
    #[must_use]
    pub fn range_m(&self, point: &Point3<f64>) -> f64 {
        (point.x - self.origin.x).hypot(point.y - self.origin.y)
    }

    /// Heights over the base frame's origin of the top and the bottom edge at a range, metres.
    #[must_use]
    pub fn heights_m(&self, range_m: f64) -> [f64; 2] {
        self.slopes.map(|slope| self.origin.z + slope * range_m)
    }

    /// The range at which the box is this high, metres.
    #[must_use]
    pub fn range_at_height_m(&self, height_m: f64) -> f64 {
        height_m / (self.slopes[0] - self.slopes[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Sensors, testing};

    fn view(bbox: [f64; 4]) -> Option<BoxView> {
        let sensors = Sensors::new(&testing::rig([0.0; 3], 0.0), None).unwrap();
        BoxView::new(&PixelBox::from(bbox), &sensors.camera)
    }

    #[test]
    fn rows_are_heights_at_a_range() {
        let view = view([1850.0, 130.0, 60.0, 204.0]).unwrap();
        let [top, bottom] = view.heights_m(4.0);
        assert!((top - 80.0 * 4.0 / 480.0).abs() < 1e-12);
        assert!((bottom + 124.0 * 4.0 / 480.0).abs() < 1e-12);
        assert!((view.range_at_height_m(1.7) - 4.0).abs() < 1e-12);
        assert_eq!(view.cut_off, [false, false]);
    }

    #[test]
    fn a_box_across_the_seam_is_seen_behind_and_one_at_the_edges_is_cut_off() {
        let view = view([3700.0, 0.0, 120.0, 479.0]).unwrap();
        assert_eq!(view.cut_off, [true, true]);
    }

    #[test]
    fn a_box_upside_down_has_no_view() {
        assert_eq!(view([0.0, 300.0, 60.0, -10.0]), None);
    }
}
