//! The double sphere fisheye of Usenko, Demmel and Cremers (3DV 2018).

use jrdb_types::ImageGeometry;
use jrdb_types::lens::DoubleSphere;
use nalgebra::{Point3, Unit, Vector3};

use super::lens::{finite_pixel, finite_ray};
use super::{Lens, Pixel};

/// The paper's `w1`: minus the cosine, at the second sphere's centre, of the largest angle seen.
fn w1(alpha: f64) -> f64 {
    let rest = 1.0 - alpha;
    if alpha <= 0.5 { alpha / rest } else { rest / alpha }
}

impl Lens for DoubleSphere {
    fn image(&self) -> ImageGeometry {
        ImageGeometry { width_px: self.width_px, height_px: self.height_px, wraps: false }
    }

    fn pixel_from_camera(&self, point: &Point3<f64>) -> Option<Pixel> {
        let off_axis_m = point.x.hypot(point.y);
        let distance_m = off_axis_m.hypot(point.z);
        let shifted_m = self.xi * distance_m + point.z;
        let second_m = off_axis_m.hypot(shifted_m);
        let grows = distance_m + self.xi * point.z > 0.0 && shifted_m > -w1(self.alpha) * second_m;
        if !grows {
            return None;
        }
        let scale = (self.alpha * second_m + (1.0 - self.alpha) * shifted_m).recip();
        let (u, v) = (self.fx * point.x * scale + self.cx, self.fy * point.y * scale + self.cy);
        finite_pixel(u, v, distance_m)
    }

    /// The paper's closed form.
    fn ray_from_pixel(&self, u: f64, v: f64) -> Option<Unit<Vector3<f64>>> {
        let (x, y) = ((u - self.cx) / self.fx, (v - self.cy) / self.fy);
        let r2 = x * x + y * y;
        let (alpha, xi) = (self.alpha, self.xi);
        // Beyond the image of a lens with α > 1/2 the roots are not real, and the ray not finite.
        let root = (1.0 - (2.0 * alpha - 1.0) * r2).sqrt();
        let z = (1.0 - alpha * alpha * r2) / (alpha * root + 1.0 - alpha);
        let scale = (z * xi + (z * z + (1.0 - xi * xi) * r2).sqrt()) / (z * z + r2);
        finite_ray(Vector3::new(scale * x, scale * y, scale * z - xi))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::check_round_trip;
    use crate::camera::lens::tests::posed;
    use proptest::prelude::*;

    fn lens(xi: f64, alpha: f64) -> DoubleSphere {
        let (width_px, height_px, cx, cy) = (800, 800, 400.0, 400.0);
        DoubleSphere { width_px, height_px, fx: 200.0, fy: 200.0, cx, cy, xi, alpha }
    }

    /// Typical of a 195° lens.
    const XI: f64 = -0.25;
    const ALPHA: f64 = 0.55;

    fn at_angle(lens: &DoubleSphere, angle: f64) -> Option<Pixel> {
        lens.pixel_from_camera(&Point3::new(angle.sin(), 0.0, angle.cos()))
    }

    #[test]
    fn without_spheres_it_is_a_pinhole() {
        let pixel = lens(0.0, 0.0).pixel_from_camera(&Point3::new(1.0, -0.5, 2.0)).unwrap();
        assert!((pixel.u - 500.0).abs() < 1e-12 && (pixel.v - 350.0).abs() < 1e-12);
        assert_eq!(at_angle(&lens(0.0, 0.0), 1.6), None);
    }

    #[test]
    fn known_point_by_hand() {
        // d1 = 5, ζ = 0.2·5 + 4 = 5, d2 = √(9 + 25), denominator (√34 + 5) / 2
        let pixel = lens(0.2, 0.5).pixel_from_camera(&Point3::new(3.0, 0.0, 4.0)).unwrap();
        assert!((pixel.u - (400.0 + 200.0 * 6.0 / (34_f64.sqrt() + 5.0))).abs() < 1e-12);
        assert_eq!((pixel.v, pixel.depth_m), (400.0, 5.0));
    }

    #[test]
    fn what_is_behind_or_nowhere_has_no_pixel() {
        for point in [[0.0; 3], [0.0, 0.0, -1.0], [f64::NAN, 0.0, 1.0], [0.0, f64::INFINITY, 1.0]] {
            assert_eq!(lens(XI, ALPHA).pixel_from_camera(&point.into()), None, "{point:?}");
        }
        let edge_px = 200.0 / (2.0 * ALPHA - 1.0_f64).sqrt();
        assert!(lens(XI, ALPHA).ray_from_pixel(400.0 + edge_px - 1e-6, 400.0).is_some());
        assert_eq!(lens(XI, ALPHA).ray_from_pixel(400.0 + edge_px + 1e-6, 400.0), None);
    }

    #[test]
    fn the_limit_is_where_the_radius_turns_and_the_papers_is_not() {
        let paper_limit = |lens: &DoubleSphere| {
            let (w1, xi) = (w1(lens.alpha), lens.xi);
            (-(w1 + xi) / (2.0 * w1 * xi + xi * xi + 1.0).sqrt()).acos()
        };
        let narrower = lens(XI, ALPHA);
        assert!(at_angle(&narrower, paper_limit(&narrower) + 0.01).is_some());
        let wider = lens(-0.9, 0.91);
        assert_eq!(at_angle(&wider, paper_limit(&wider) - 0.01), None);
    }

    proptest! {
        #[test]
        fn pixels_survive_the_round_trip(u in 0.0..800.0, v in 0.0..800.0) {
            check_round_trip(&posed(lens(XI, ALPHA)), [u, v], 1e-9);
            check_round_trip(&posed(lens(0.3, 0.5)), [u, v], 1e-9);
        }

        #[test]
        fn the_radius_grows_while_there_is_a_pixel_and_turns_after(
            xi in -0.99..0.99,
            alpha in 0.0..1.0,
            angle in 0.0..3.13,
        ) {
            let lens = lens(xi, alpha);
            if let (Some(near), Some(far)) = (at_angle(&lens, angle), at_angle(&lens, angle + 0.01)) {
                prop_assert!(near.u < far.u);
            }
            let monotone = at_angle(&lens, angle).is_some() || at_angle(&lens, angle + 0.01).is_none();
            prop_assert!(monotone, "seen at a larger angle only");
        }

        #[test]
        fn whoever_has_a_ray_has_its_pixel(xi in -0.99..0.99, alpha in 0.0..1.0, u in 0.0..800.0, v in 0.0..800.0) {
            let lens = lens(xi, alpha);
            let near_the_edge = alpha > 0.5 && {
                let r2 = f64::hypot(u - 400.0, v - 400.0).powi(2) / 4e4;
                (r2 * (2.0 * alpha - 1.0) - 1.0).abs() < 1e-3
            };
            if !near_the_edge && lens.ray_from_pixel(u, v).is_some() {
                check_round_trip(&posed(lens), [u, v], 1e-6);
            }
        }

        #[test]
        fn nothing_panics(p in prop::array::uniform3(any::<f64>()), k in prop::array::uniform4(any::<f64>())) {
            let lens = DoubleSphere { fx: k[0], cx: k[1], ..lens(k[2], k[3]) };
            lens.pixel_from_camera(&p.into());
            lens.ray_from_pixel(p[0], p[1]);
        }
    }
}
