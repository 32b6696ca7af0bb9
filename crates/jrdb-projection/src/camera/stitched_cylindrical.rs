//! A panorama stitched from several viewpoints on a cylinder of finite radius: what JRDB's really is.

use std::f64::consts::{PI, TAU};

use jrdb_types::ImageGeometry;
use jrdb_types::lens::{StitchView, StitchedCylindrical};
use nalgebra::{Point3, Unit, Vector2, Vector3};

use super::lens::{finite_pixel, finite_ray, wrapped};
use super::{Lens, Pixel};

/// The pixel of a point in the picture of one view, whether or not that view is the nearest: within the
/// stripes where two views are blended, both pixels show the point.
#[must_use]
pub fn pixel_through_view(
    lens: &StitchedCylindrical,
    view: &StitchView,
    point: &Point3<f64>,
) -> Option<Pixel> {
    let center = Point3::from(view.center_m);
    let ray = point - center;
    let hit = center + ray * reach(lens.radius_m, &center, &ray)?;
    let width = f64::from(lens.width_px);
    let u = (0.5 + azimuth_rad(&hit) / TAU) * width + lens.column_offset_px;
    let v = lens.focal_px * hit.y / lens.radius_m + lens.horizon_px;
    finite_pixel(wrapped(u, width), v, ray.xz().norm())
}

/// How many times the ray must be taken to get from a centre inside the cylinder to its wall.
fn reach(radius_m: f64, center: &Point3<f64>, ray: &Vector3<f64>) -> Option<f64> {
    let (start, step) = (Vector2::new(center.x, center.z), ray.xz());
    let a = step.norm_squared();
    let b = start.dot(&step);
    let c = start.norm_squared() - radius_m * radius_m;
    // c < 0: the centre is inside, and of the two meetings exactly one lies ahead.
    let ahead = a > 0.0 && c < 0.0;
    ahead.then(|| ((b * b - a * c).sqrt() - b) / a).filter(|reach| reach.is_finite())
}

/// The point of the cylinder that is drawn at a pixel.
fn wall(lens: &StitchedCylindrical, u: f64, v: f64) -> Point3<f64> {
    let turn = (u - lens.column_offset_px) / f64::from(lens.width_px) - 0.5;
    let (sin, cos) = (TAU * turn).sin_cos();
    let y = (v - lens.horizon_px) / lens.focal_px;
    Point3::new(sin, y, cos) * lens.radius_m
}

fn nearest_view(lens: &StitchedCylindrical, azimuth_rad: f64) -> Option<&StitchView> {
    let apart =
        |view: &StitchView| ((azimuth_rad - view.azimuth_rad + PI).rem_euclid(TAU) - PI).abs();
    lens.views.iter().min_by(|a, b| apart(a).total_cmp(&apart(b)))
}

fn azimuth_rad(point: &Point3<f64>) -> f64 {
    point.x.atan2(point.z)
}

impl Lens for StitchedCylindrical {
    fn image(&self) -> ImageGeometry {
        ImageGeometry { width_px: self.width_px, height_px: self.height_px, wraps: true }
    }

    fn pixel_from_camera(&self, point: &Point3<f64>) -> Option<Pixel> {
        let on_axis = point.x.hypot(point.z) == 0.0;
        if on_axis {
            return None;
        }
        pixel_through_view(self, nearest_view(self, azimuth_rad(point))?, point)
    }

    fn ray_from_pixel(&self, u: f64, v: f64) -> Option<Unit<Vector3<f64>>> {
        let wall = wall(self, u, v);
        let center = Point3::from(nearest_view(self, azimuth_rad(&wall))?.center_m);
        finite_ray(wall - center)
    }

    /// The centre of the view that shows the pixel.
    fn ray_origin(&self, u: f64, v: f64) -> Point3<f64> {
        let view = nearest_view(self, azimuth_rad(&wall(self, u, v)));
        view.map_or_else(Point3::origin, |view| view.center_m.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::lens::tests::posed;
    use crate::camera::{CameraModel, PosedCamera, check_round_trip};
    use proptest::prelude::*;

    /// Five views, 0.06 m before the axis, 72° apart.
    fn lens() -> StitchedCylindrical {
        let view = |k: f64| {
            let azimuth_rad: f64 = k * TAU / 5.0;
            let (sin, cos) = azimuth_rad.sin_cos();
            StitchView { azimuth_rad, center_m: [0.06 * sin, 0.0, 0.06 * cos] }
        };
        StitchedCylindrical {
            width_px: 3600,
            height_px: 480,
            radius_m: 1.7,
            focal_px: 510.0,
            horizon_px: 200.0,
            column_offset_px: 0.0,
            views: [0.0, 1.0, 2.0, -2.0, -1.0].map(view).to_vec(),
        }
    }

    fn pixel(x: f64, y: f64, z: f64) -> Pixel {
        lens().pixel_from_camera(&Point3::new(x, y, z)).unwrap()
    }

    /// Columns between the pixel and the nearest border between two views.
    fn from_border_px(u: f64) -> f64 {
        let sector = u.rem_euclid(720.0);
        sector.min(720.0 - sector)
    }

    #[test]
    fn on_the_cylinder_it_is_a_plain_panorama() {
        let at = |x: f64, z: f64| pixel(x * 1.7, 0.17, z * 1.7);
        assert!((at(0.0, 1.0).u - 1800.0).abs() < 1e-9);
        assert!((at(1.0, 0.0).u - 2700.0).abs() < 1e-9);
        assert!((at(-1.0, 0.0).u - 900.0).abs() < 1e-9);
        assert!((at(-0.6, 0.8).v - 251.0).abs() < 1e-9);
    }

    #[test]
    fn parallax_by_hand() {
        // From 0.06 m ahead of the axis: slope 1 / 3.94 over the remaining 1.64 m to the wall.
        let far = pixel(0.0, 1.0, 4.0);
        assert!((far.v - (200.0 + 510.0 * (1.64 / 3.94) / 1.7)).abs() < 1e-9);
        assert!((far.depth_m - 3.94).abs() < 1e-12);
        // A point far to the side of the axis moves towards the view's own axis.
        let x = pixel(1000.0, 0.0, 2000.0).u - 1800.0;
        assert!(x < 0.5_f64.atan() / TAU * 3600.0 - 5.0);
    }

    #[test]
    fn the_offset_moves_columns_round_the_circle() {
        let moved = StitchedCylindrical { column_offset_px: -1.0, ..lens() };
        let behind = moved.pixel_from_camera(&Point3::new(0.0, 0.0, -1.7)).unwrap();
        assert!((behind.u - 3599.0).abs() < 1e-9);
    }

    #[test]
    fn each_ray_starts_at_its_view() {
        let camera = posed(lens());
        let PosedCamera { lens, camera_from_base } = &camera;
        assert_eq!(lens.ray_origin(1800.0, 200.0), Point3::new(0.0, 0.0, 0.06));
        let right = camera.ray_origin(1800.0 + 720.0, 200.0);
        assert!((camera_from_base * right - Point3::from(lens.views[1].center_m)).norm() < 1e-12);
    }

    #[test]
    fn what_is_on_the_axis_or_nowhere_has_no_pixel() {
        for point in [[0.0; 3], [0.0, 1.0, 0.0], [f64::NAN, 0.0, 1.0], [0.0, f64::INFINITY, 1.0]] {
            assert_eq!(lens().pixel_from_camera(&point.into()), None, "{point:?}");
        }
        let blind = StitchedCylindrical { views: Vec::new(), ..lens() };
        assert_eq!(blind.pixel_from_camera(&Point3::new(0.0, 0.0, 1.0)), None);
        let outside = StitchedCylindrical { radius_m: 0.05, ..lens() };
        assert_eq!(outside.pixel_from_camera(&Point3::new(0.0, 0.0, 1.0)), None);
    }

    proptest! {
        #[test]
        fn pixels_survive_the_round_trip(u in 0.0..3600.0, v in 0.0..480.0) {
            let tolerance_px = if from_border_px(u) > 15.0 { 1e-9 } else { 30.0 };
            check_round_trip(&posed(lens()), [u, v], tolerance_px);
        }

        #[test]
        fn columns_grow_to_the_right_within_a_view(azimuth in -0.62..0.61, range in 0.2..50.0) {
            let u = |azimuth: f64| pixel(range * azimuth.sin(), 0.0, range * azimuth.cos()).u;
            prop_assert!(u(azimuth) < u(azimuth + 0.01));
        }

        #[test]
        fn nothing_panics(p in prop::array::uniform3(any::<f64>()), k in prop::array::uniform6(any::<f64>())) {
            let view = StitchView { azimuth_rad: k[0], center_m: [k[1], k[2], k[3]] };
            let lens = StitchedCylindrical { radius_m: k[4], focal_px: k[5], views: vec![view; 2], ..lens() };
            lens.pixel_from_camera(&p.into());
            lens.ray_from_pixel(p[0], p[1]);
        }
    }
}
