//! JRDB's official stitched panorama: a cylinder around the base frame's origin.

use std::f64::consts::TAU;

use jrdb_types::{ImageGeometry, rig::CylindricalPanorama};
use nalgebra::{Point3, Unit, Vector3};

use super::{CameraModel, Pixel};

/// Below this horizontal range, metres, a point is on the cylinder's axis and has no column.
const AXIS_RADIUS_M: f64 = 1e-9;

impl CameraModel for CylindricalPanorama {
    fn image(&self) -> ImageGeometry {
        CylindricalPanorama::image(self)
    }

    /// `u = (1/2 - atan2(y, x) / 2π) · W mod W`, `v = c - f · z / hypot(x, y)`.
    ///
    /// The dataset's own code writes `v` with `cos θ / z_ref`, which is the same number except on the
    /// left-right axis, where it divides zero by zero and this form does not.
    fn pixel_from_base(&self, point: &Point3<f64>) -> Option<Pixel> {
        let range_m = point.x.hypot(point.y);
        let finite = range_m.is_finite() && point.z.is_finite();
        if !finite || range_m < AXIS_RADIUS_M {
            return None;
        }
        let width = f64::from(self.width_px);
        let u = ((0.5 - point.y.atan2(point.x) / TAU) * width).rem_euclid(width);
        let v = self.horizon_px - self.focal_px * point.z / range_m;
        // Rounding can push a column just left of the seam onto W itself.
        Some(Pixel { u: if u < width { u } else { 0.0 }, v, depth_m: range_m })
    }

    fn ray_from_pixel(&self, u: f64, v: f64) -> Option<Unit<Vector3<f64>>> {
        let azimuth = TAU * (0.5 - u / f64::from(self.width_px));
        let slope = (self.horizon_px - v) / self.focal_px;
        let ray = Vector3::new(azimuth.cos(), azimuth.sin(), slope);
        ray.iter().all(|c| c.is_finite()).then(|| Unit::new_normalize(ray))
    }

    fn center(&self) -> Point3<f64> {
        Point3::origin()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::check_round_trip;
    use crate::testing::PANORAMA;
    use proptest::prelude::*;

    fn pixel(x: f64, y: f64, z: f64) -> Pixel {
        PANORAMA.pixel_from_base(&Point3::new(x, y, z)).unwrap()
    }

    #[test]
    fn forward_is_the_middle_column_and_left_is_the_left_half() {
        assert_eq!(pixel(5.0, 0.0, 0.0).u, 1880.0);
        assert_eq!(pixel(0.0, 5.0, 0.0).u, 940.0);
        assert_eq!(pixel(0.0, -5.0, 0.0).u, 2820.0);
    }

    #[test]
    fn behind_is_the_seam() {
        assert_eq!(pixel(-5.0, 0.0, 0.0).u, 0.0);
        assert!(pixel(-5.0, -1e-18, 0.0).u < 3760.0);
        assert!(pixel(-5.0, -1e-3, 0.0).u > 3759.0);
    }

    #[test]
    fn straight_left_has_a_finite_row() {
        assert_eq!(pixel(0.0, 4.0, 1.0).v, 210.0 - 120.0);
    }

    #[test]
    fn points_on_the_axis_or_nowhere_have_no_pixel() {
        for (x, z) in [(0.0, 1.0), (f64::NAN, 0.0), (1.0, f64::INFINITY)] {
            assert_eq!(PANORAMA.pixel_from_base(&Point3::new(x, 0.0, z)), None);
        }
    }

    proptest! {
        #[test]
        fn pixels_survive_the_round_trip(u in 0.0..3760.0, v in 0.0..480.0) {
            check_round_trip(&PANORAMA, [u, v], 1e-9);
        }

        #[test]
        fn points_on_one_ray_share_a_pixel(x in -9.0..9.0, y in 0.1..9.0, z in -1.0..1.0, k in 0.1..9.0) {
            let (near, far) = (pixel(x, y, z), pixel(k * x, k * y, k * z));
            prop_assert!((near.u - far.u).abs() < 1e-9 && (near.v - far.v).abs() < 1e-9);
        }
    }
}
