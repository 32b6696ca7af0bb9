//! The fisheye of Kannala and Brandt: a polynomial of the incidence angle.

use std::f64::consts::PI;

use jrdb_types::ImageGeometry;
use jrdb_types::lens::KannalaBrandt;
use nalgebra::{Point3, Unit, Vector3};

use super::lens::{finite_pixel, finite_ray};
use super::{Lens, Pixel, monotonic};

/// `θ_d = θ (1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸)`, with the angle up to which it grows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AnglePolynomial {
    k: [f64; 4],
    max_angle_rad: f64,
}

impl From<[f64; 4]> for AnglePolynomial {
    fn from(k: [f64; 4]) -> Self {
        let max_angle_rad = monotonic::positive_up_to(&monotonic::derivative(&in_angle(k)), PI);
        Self { k, max_angle_rad }
    }
}

/// Coefficients of the powers of θ.
fn in_angle([k1, k2, k3, k4]: [f64; 4]) -> [f64; 10] {
    [0.0, 1.0, 0.0, k1, 0.0, k2, 0.0, k3, 0.0, k4]
}

impl AnglePolynomial {
    /// Angle from the optical axis, radians, up to which `θ_d` grows; at most π, straight behind.
    #[must_use]
    pub fn max_angle_rad(&self) -> f64 {
        self.max_angle_rad
    }

    /// `θ_d` and its slope.
    fn value_and_slope(&self, angle_rad: f64) -> (f64, f64) {
        let [k1, k2, k3, k4] = self.k;
        let s = angle_rad * angle_rad;
        let scale = monotonic::evaluate(&[1.0, k1, k2, k3, k4], s);
        let slope = monotonic::evaluate(&[1.0, 3.0 * k1, 5.0 * k2, 7.0 * k3, 9.0 * k4], s);
        (angle_rad * scale, slope)
    }

    fn angle_rad(&self, distorted: f64) -> Option<f64> {
        let angle_rad =
            monotonic::invert(|a| self.value_and_slope(a), distorted, self.max_angle_rad)?;
        (angle_rad < self.max_angle_rad).then_some(angle_rad)
    }
}

/// A [`KannalaBrandt`] fisheye with the angle up to which it is one-to-one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KannalaBrandtLens {
    numbers: KannalaBrandt,
    k: AnglePolynomial,
}

impl From<KannalaBrandt> for KannalaBrandtLens {
    fn from(numbers: KannalaBrandt) -> Self {
        Self { numbers, k: numbers.k.into() }
    }
}

impl Lens for KannalaBrandtLens {
    fn image(&self) -> ImageGeometry {
        ImageGeometry {
            width_px: self.numbers.width_px,
            height_px: self.numbers.height_px,
            wraps: false,
        }
    }

    fn pixel_from_camera(&self, point: &Point3<f64>) -> Option<Pixel> {
        let off_axis_m = point.x.hypot(point.y);
        let distance_m = off_axis_m.hypot(point.z);
        let angle_rad = off_axis_m.atan2(point.z);
        let seen = distance_m > 0.0 && angle_rad < self.k.max_angle_rad;
        if !seen {
            return None;
        }
        let (drawn, _) = self.k.value_and_slope(angle_rad);
        let scale = if off_axis_m > 0.0 { drawn / off_axis_m } else { 0.0 };
        let (u, v) = (
            scale * point.x * self.numbers.fx + self.numbers.cx,
            scale * point.y * self.numbers.fy + self.numbers.cy,
        );
        finite_pixel(u, v, distance_m)
    }

    fn ray_from_pixel(&self, u: f64, v: f64) -> Option<Unit<Vector3<f64>>> {
        let (x, y) =
            ((u - self.numbers.cx) / self.numbers.fx, (v - self.numbers.cy) / self.numbers.fy);
        let drawn = x.hypot(y);
        let (sin, cos) = self.k.angle_rad(drawn)?.sin_cos();
        let scale = if drawn > 0.0 { sin / drawn } else { 0.0 };
        finite_ray(Vector3::new(scale * x, scale * y, cos))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::check_round_trip;
    use crate::camera::lens::tests::posed;
    use proptest::prelude::*;

    fn lens(k: [f64; 4]) -> KannalaBrandtLens {
        numbers(k).into()
    }

    fn numbers(k: [f64; 4]) -> KannalaBrandt {
        KannalaBrandt {
            width_px: 800,
            height_px: 800,
            fx: 250.0,
            fy: 250.0,
            cx: 400.0,
            cy: 400.0,
            k,
        }
    }

    /// Typical of a 195° lens.
    const FISHEYE: [f64; 4] = [-0.02, 0.01, -0.008, 0.0015];

    #[test]
    fn an_equidistant_fisheye_draws_angles() {
        let pixel = |x, y, z| lens([0.0; 4]).pixel_from_camera(&Point3::new(x, y, z)).unwrap();
        assert_eq!((pixel(0.0, 0.0, 3.0).u, pixel(0.0, 0.0, 3.0).v), (400.0, 400.0));
        assert!((pixel(2.0, 0.0, 0.0).u - (400.0 + 250.0 * PI / 2.0)).abs() < 1e-9);
        assert!((pixel(0.0, 1.0, -1.0).v - (400.0 + 250.0 * 0.75 * PI)).abs() < 1e-9);
        assert!((pixel(0.0, 3.0, -4.0).depth_m - 5.0).abs() < 1e-15);
    }

    #[test]
    fn known_point_by_hand() {
        // θ = atan(1) = π/4, θ² = 0.6168502751, θ_d = θ (1 + 0.1 θ²)
        let pixel =
            lens([0.1, 0.0, 0.0, 0.0]).pixel_from_camera(&Point3::new(3.0, 4.0, 5.0)).unwrap();
        let drawn = PI / 4.0 * 1.061_685_027_506_808;
        assert!((pixel.u - (400.0 + 250.0 * drawn * 0.6)).abs() < 1e-9);
        assert!((pixel.v - (400.0 + 250.0 * drawn * 0.8)).abs() < 1e-9);
    }

    #[test]
    fn the_limit_is_the_turning_point() {
        // θ - θ³/3 turns at θ = 1, where it is 2/3.
        let lens = lens([-1.0 / 3.0, 0.0, 0.0, 0.0]);
        assert!((lens.k.max_angle_rad() - 1.0).abs() < 1e-12);
        let at = |angle: f64| lens.pixel_from_camera(&Point3::new(angle.sin(), 0.0, angle.cos()));
        assert!(at(0.999).is_some() && at(1.001).is_none());
        assert_eq!(lens.ray_from_pixel(400.0 + 250.0 * 0.667, 400.0), None);
    }

    #[test]
    fn what_is_straight_behind_or_nowhere_has_no_pixel() {
        for point in [[0.0; 3], [0.0, 0.0, -1.0], [f64::NAN, 0.0, 1.0], [0.0, f64::INFINITY, 1.0]] {
            assert_eq!(lens([0.0; 4]).pixel_from_camera(&point.into()), None, "{point:?}");
        }
    }

    proptest! {
        #[test]
        fn pixels_survive_the_round_trip(u in 0.0..800.0, v in 0.0..800.0) {
            check_round_trip(&posed(lens([0.0; 4])), [u, v], 1e-9);
            check_round_trip(&posed(lens(FISHEYE)), [u, v], 1e-9);
        }

        #[test]
        fn the_radius_grows_up_to_the_limit(k in prop::array::uniform4(-0.2..0.2), at in 0.0..0.998) {
            let lens = lens(k);
            let reach = |share: f64| {
                let angle = share * lens.k.max_angle_rad();
                let pixel = lens.pixel_from_camera(&Point3::new(0.0, angle.sin(), angle.cos()));
                pixel.unwrap().v
            };
            prop_assert!(reach(at) < reach(at + 0.001));
        }

        #[test]
        fn whoever_has_a_ray_has_its_pixel(k in prop::array::uniform4(-0.2..0.2), u in 0.0..800.0, v in 0.0..800.0) {
            if lens(k).ray_from_pixel(u, v).is_some() {
                check_round_trip(&posed(lens(k)), [u, v], 1e-6);
            }
        }

        #[test]
        fn nothing_panics(p in prop::array::uniform3(any::<f64>()), k in prop::array::uniform4(any::<f64>())) {
            let lens = KannalaBrandtLens::from(KannalaBrandt { fx: k[0], cx: k[1], ..numbers(k) });
            lens.pixel_from_camera(&p.into());
            lens.ray_from_pixel(p[0], p[1]);
        }
    }
}
