//! A panorama on a vertical cylinder around the camera: JRDB's official model.

use std::f32::consts::{FRAC_PI_2 as FRAC_PI_2_F32, PI as PI_F32};
use std::f64::consts::TAU;

use jrdb_types::{CylindricalPanorama, ImageGeometry};
use nalgebra::{Point3, Unit, Vector3};

use super::lens::{finite_pixel, finite_ray, wrapped};
use super::{Columns, Lens, Pixel, PixelColumns};
use crate::simd::{Loop, vectorised};

/// Below this horizontal range, metres, a point is on the cylinder's axis and has no column.
const AXIS_RADIUS_M: f64 = 1e-9;

impl Lens for CylindricalPanorama {
    fn image(&self) -> ImageGeometry {
        ImageGeometry { width_px: self.width_px, height_px: self.height_px, wraps: true }
    }

    /// `u = (1/2 + atan2(x, z) / 2π) · W mod W`, `v = c + f · y / hypot(x, z)`.
    ///
    /// JRDB's own code writes `v` with `cos θ / z`, which is the same number except straight to the left
    /// and right, where it divides zero by zero and this form does not.
    fn pixel_from_camera(&self, point: &Point3<f64>) -> Option<Pixel> {
        let range_m = point.x.hypot(point.z);
        if range_m.is_nan() || range_m < AXIS_RADIUS_M {
            return None;
        }
        let width = f64::from(self.width_px);
        let u = (0.5 + point.x.atan2(point.z) / TAU) * width;
        let v = self.horizon_px + self.focal_px * point.y / range_m;
        finite_pixel(wrapped(u, width), v, range_m)
    }

    fn ray_from_pixel(&self, u: f64, v: f64) -> Option<Unit<Vector3<f64>>> {
        let azimuth = TAU * (u / f64::from(self.width_px) - 0.5);
        let slope = (v - self.horizon_px) / self.focal_px;
        finite_ray(Vector3::new(azimuth.sin(), slope, azimuth.cos()))
    }

    /// Within 1e-3 px of [`Lens::pixel_from_camera`] for images up to 4096 columns: single precision, and an
    /// angle by polynomial. Branch-free, so that the compiler vectorises it.
    fn pixels_from_camera(&self, points: &Columns<'_>, pixels: &mut PixelColumns<'_>) {
        vectorised(Draw {
            width: self.width_px as f32,
            px_per_rad: (f64::from(self.width_px) / TAU) as f32,
            focal: self.focal_px as f32,
            horizon: self.horizon_px as f32,
            points,
            pixels,
        });
    }
}

/// The panorama's numbers in single precision, what to draw, and where the pixels go.
struct Draw<'a, 'b> {
    width: f32,
    px_per_rad: f32,
    focal: f32,
    horizon: f32,
    points: &'a Columns<'a>,
    pixels: &'a mut PixelColumns<'b>,
}

impl Loop for Draw<'_, '_> {
    #[inline(always)]
    fn run(self) {
        let points = self.points.x.iter().zip(self.points.y).zip(self.points.z);
        let pixels = self.pixels.u.iter_mut().zip(&mut *self.pixels.v);
        for (((&x, &y), &z), (u, v)) in points.zip(pixels) {
            let inverse_range = 1.0 / x.mul_add(x, z * z).sqrt();
            let column = azimuth(x, z, inverse_range).mul_add(self.px_per_rad, 0.5 * self.width);
            let row = self.focal.mul_add(y * inverse_range, self.horizon);
            // On the axis, and for what is not finite, the row is not finite.
            let seen = row.abs() <= f32::MAX;
            let column = if column < self.width { column.max(0.0) } else { 0.0 };
            *u = if seen { column } else { f32::NAN };
            *v = if seen { row } else { f32::NAN };
        }
    }
}

/// Coefficients of `asin(s) / s` in powers of `s²`: the minimax polynomial for `s` up to `√½`.
const ASIN: [f32; 8] = [
    0.999_999_9,
    0.166_679_81,
    0.074_655_01,
    0.048_669_24,
    0.005_888_27,
    0.104_253_575,
    -0.128_746_84,
    0.130_468_34,
];

/// The angle of `(x, z)` from +z towards +x, radians in `[-π, π]`, within 5e-7 of the true one; without branches.
///
/// The sine of the angle from the nearest axis costs no division beside the one that the row needs.
#[inline(always)]
fn azimuth(x: f32, z: f32, inverse_range: f32) -> f32 {
    let (ax, az) = (x.abs(), z.abs());
    let is_aside = ax > az;
    let sine = if is_aside { az } else { ax } * inverse_range;
    let square = sine * sine;
    let octant = ASIN.iter().rev().fold(0.0_f32, |sum, &c| sum.mul_add(square, c)) * sine;
    let quadrant = if is_aside { FRAC_PI_2_F32 - octant } else { octant };
    let half = if z < 0.0 { PI_F32 - quadrant } else { quadrant };
    half.copysign(x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::check_round_trip;
    use crate::camera::lens::tests::posed;
    use crate::testing::PANORAMA;
    use proptest::prelude::*;

    /// The pixel of a point of a base frame: x forward, y left, z up.
    fn pixel(x: f64, y: f64, z: f64) -> Pixel {
        PANORAMA.pixel_from_camera(&Point3::new(-y, -z, x)).unwrap()
    }

    fn at_once(points: &[[f32; 3]]) -> Vec<[f32; 2]> {
        let [x, y, z] = [0, 1, 2].map(|axis| points.iter().map(|p| p[axis]).collect::<Vec<_>>());
        let (mut u, mut v) = (vec![0.0; points.len()], vec![0.0; points.len()]);
        let pixels = &mut PixelColumns { u: &mut u, v: &mut v };
        PANORAMA.pixels_from_camera(&Columns { x: &x, y: &y, z: &z }, pixels);
        u.into_iter().zip(v).map(|(u, v)| [u, v]).collect()
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
        let nowhere = [[0.0, 1.0, 0.0], [f32::NAN, 0.0, 1.0], [0.0, f32::INFINITY, 1.0], [0.0; 3]];
        for point in nowhere {
            let point = Point3::from(point.map(f64::from));
            assert_eq!(PANORAMA.pixel_from_camera(&point), None);
        }
        assert!(at_once(&nowhere).iter().flatten().all(|n| n.is_nan()));
    }

    #[test]
    fn the_polynomial_is_an_angle() {
        let angles = (-314..=314).map(|i| f64::from(i) / 100.0);
        for angle in angles.chain([0.0, std::f64::consts::FRAC_PI_4, 1e-6, std::f64::consts::PI]) {
            let (x, z) = ((3.0 * angle.sin()) as f32, (3.0 * angle.cos()) as f32);
            let error =
                f64::from(azimuth(x, z, 1.0 / x.hypot(z))) - f64::from(x).atan2(f64::from(z));
            assert!(error.abs() < 5e-7, "{error} at {angle}");
        }
        assert_eq!(azimuth(0.0, 1.0, 1.0), 0.0);
    }

    proptest! {
        #[test]
        fn pixels_survive_the_round_trip(u in 0.0..3760.0, v in 0.0..480.0) {
            check_round_trip(&posed(PANORAMA), [u, v], 1e-9);
        }

        #[test]
        fn many_points_at_once_are_the_same_pixels(p in prop::array::uniform3(-60.0..60.0_f32)) {
            prop_assume!(p[0].hypot(p[2]) > 0.1 && p[1].abs() < p[0].hypot(p[2]));
            let one = PANORAMA.pixel_from_camera(&Point3::from(p.map(f64::from))).unwrap();
            let [u, v] = at_once(&[p])[0].map(f64::from);
            let du = (u - one.u).abs();
            prop_assert!((0.0..3760.0).contains(&u));
            prop_assert!(du.min(3760.0 - du) < 1e-3 && (v - one.v).abs() < 1e-3, "{u} {v} {one:?}");
        }

        #[test]
        fn points_on_one_ray_share_a_pixel(x in -9.0..9.0, y in 0.1..9.0, z in -1.0..1.0, k in 0.1..9.0) {
            let (near, far) = (pixel(x, y, z), pixel(k * x, k * y, k * z));
            prop_assert!((near.u - far.u).abs() < 1e-9 && (near.v - far.v).abs() < 1e-9);
        }
    }
}
