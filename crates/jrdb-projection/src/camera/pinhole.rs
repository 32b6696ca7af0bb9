//! The pinhole with OpenCV's distortion.

use jrdb_types::ImageGeometry;
use jrdb_types::lens::Pinhole;
use nalgebra::{Point2, Point3, Unit, Vector3};

use super::lens::{finite_pixel, finite_ray};
use super::{Distortion, Lens, Pixel};

/// A [`Pinhole`] with the radius up to which its distortion is one-to-one.
///
/// Points behind the camera (`Z ≤ 0`) and beyond [`Distortion::max_radius`] have no pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PinholeLens {
    numbers: Pinhole,
    distortion: Distortion,
}

impl From<Pinhole> for PinholeLens {
    fn from(numbers: Pinhole) -> Self {
        Self { numbers, distortion: numbers.distortion.into() }
    }
}

impl PinholeLens {
    /// The distortion, with the radius up to which it is one-to-one.
    #[must_use]
    pub fn distortion(&self) -> &Distortion {
        &self.distortion
    }
}

impl Lens for PinholeLens {
    fn image(&self) -> ImageGeometry {
        ImageGeometry {
            width_px: self.numbers.width_px,
            height_px: self.numbers.height_px,
            wraps: false,
        }
    }

    fn pixel_from_camera(&self, point: &Point3<f64>) -> Option<Pixel> {
        if point.z.is_nan() || point.z <= 0.0 {
            return None;
        }
        let drawn = self.distortion.distort(&Point2::new(point.x / point.z, point.y / point.z))?;
        finite_pixel(
            self.numbers.fx * drawn.x + self.numbers.cx,
            self.numbers.fy * drawn.y + self.numbers.cy,
            point.z,
        )
    }

    fn ray_from_pixel(&self, u: f64, v: f64) -> Option<Unit<Vector3<f64>>> {
        let drawn = Point2::new(
            (u - self.numbers.cx) / self.numbers.fx,
            (v - self.numbers.cy) / self.numbers.fy,
        );
        let ideal = self.distortion.undistort(&drawn)?;
        finite_ray(Vector3::new(ideal.x, ideal.y, 1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::check_round_trip;
    use crate::camera::distortion::tests::{BARREL, models};
    use crate::camera::lens::tests::posed;
    use jrdb_types::lens::DistortionModel;
    use proptest::prelude::*;

    fn numbers(distortion: DistortionModel) -> Pinhole {
        Pinhole {
            width_px: 640,
            height_px: 400,
            fx: 476.0,
            fy: 480.0,
            cx: 318.0,
            cy: 206.0,
            distortion,
        }
    }

    fn lens(distortion: DistortionModel) -> PinholeLens {
        numbers(distortion).into()
    }

    #[test]
    fn right_is_right_and_down_is_down() {
        let pixel = lens(DistortionModel::None).pixel_from_camera(&Point3::new(1.0, 0.5, 2.0));
        assert_eq!(pixel, Some(Pixel { u: 318.0 + 238.0, v: 206.0 + 120.0, depth_m: 2.0 }));
    }

    #[test]
    fn what_is_behind_or_nowhere_has_no_pixel() {
        for model in [DistortionModel::None, BARREL] {
            for point in [
                [0.0, 0.0, 0.0],
                [0.1, 0.1, -1.0],
                [1.0, 0.0, 0.0],
                [f64::NAN, 0.0, 1.0],
                [0.0, f64::INFINITY, 1.0],
                [0.0, 0.0, f64::NAN],
                [0.0, 0.0, f64::INFINITY],
            ] {
                assert_eq!(lens(model).pixel_from_camera(&point.into()), None, "{point:?}");
            }
        }
    }

    #[test]
    fn a_point_beyond_the_turning_point_is_not_folded_back_into_the_image() {
        let (x, s) = (1.6, 1.6 * 1.6); // 58°
        let bare = 476.0 * x * (1.0 - 0.34 * s + 0.16 * s * s - 0.05 * s * s * s) + 318.0;
        assert!((0.0..640.0).contains(&bare), "the polynomial draws it at column {bare}");
        assert_eq!(lens(BARREL).pixel_from_camera(&Point3::new(x, 0.0, 1.0)), None);
        assert!(lens(BARREL).pixel_from_camera(&Point3::new(1.0, 0.0, 1.0)).is_some());
    }

    proptest! {
        #[test]
        fn pixels_survive_the_round_trip(u in 0.0..640.0, v in 0.0..400.0) {
            check_round_trip(&posed(lens(DistortionModel::None)), [u, v], 1e-9);
            check_round_trip(&posed(lens(BARREL)), [u, v], 1e-9);
        }

        #[test]
        fn points_on_one_ray_share_a_pixel(x in -1.0..1.0, y in -1.0..1.0, z in 0.1..9.0, k in 0.1..9.0) {
            let pixel = |k: f64| lens(BARREL).pixel_from_camera(&Point3::new(k * x * z, k * y * z, k * z));
            if let (Some(near), Some(far)) = (pixel(1.0), pixel(k)) {
                prop_assert!((near.u - far.u).abs() < 1e-9 && (near.v - far.v).abs() < 1e-9);
            }
        }

        #[test]
        fn whoever_has_a_ray_has_its_pixel(model in models(), u in 0.0..640.0, v in 0.0..400.0) {
            let lens = lens(model);
            if lens.ray_from_pixel(u, v).is_some() {
                check_round_trip(&posed(lens), [u, v], 1e-6);
            }
        }

        #[test]
        fn nothing_panics(p in prop::array::uniform3(any::<f64>()), k in prop::array::uniform4(any::<f64>())) {
            let [fx, fy, cx, cy] = k;
            let lens = PinholeLens::from(Pinhole { fx, fy, cx, cy, ..numbers(BARREL) });
            lens.pixel_from_camera(&p.into());
            lens.ray_from_pixel(p[0], p[1]);
        }
    }
}
