//! The full sphere on a rectangle: what most 360° consumer cameras write.

use std::f64::consts::{PI, TAU};

use jrdb_types::ImageGeometry;
use jrdb_types::lens::Equirectangular;
use nalgebra::{Point3, Unit, Vector3};

use super::lens::{finite_pixel, finite_ray, wrapped};
use super::{Lens, Pixel};

impl Lens for Equirectangular {
    fn image(&self) -> ImageGeometry {
        ImageGeometry { width_px: self.width_px, height_px: self.height_px, wraps: true }
    }

    fn pixel_from_camera(&self, point: &Point3<f64>) -> Option<Pixel> {
        let range_m = point.x.hypot(point.z);
        let distance_m = range_m.hypot(point.y);
        if distance_m == 0.0 {
            return None;
        }
        let (width, height) = (f64::from(self.width_px), f64::from(self.height_px));
        // At a pole the signs of two zeros would choose the column.
        let azimuth = if range_m > 0.0 { point.x.atan2(point.z) } else { 0.0 };
        let u = wrapped((0.5 + azimuth / TAU) * width, width);
        finite_pixel(u, (0.5 + point.y.atan2(range_m) / PI) * height, distance_m)
    }

    fn ray_from_pixel(&self, u: f64, v: f64) -> Option<Unit<Vector3<f64>>> {
        let latitude = PI * (v / f64::from(self.height_px) - 0.5);
        if latitude.abs() > PI / 2.0 {
            return None;
        }
        let (sin, cos) = (TAU * (u / f64::from(self.width_px) - 0.5)).sin_cos();
        finite_ray(Vector3::new(latitude.cos() * sin, latitude.sin(), latitude.cos() * cos))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::check_round_trip;
    use crate::camera::lens::tests::posed;
    use proptest::prelude::*;

    const LENS: Equirectangular = Equirectangular { width_px: 1920, height_px: 960 };

    fn uv(x: f64, y: f64, z: f64) -> (f64, f64) {
        let pixel = LENS.pixel_from_camera(&Point3::new(x, y, z)).unwrap();
        (pixel.u, pixel.v)
    }

    #[test]
    fn the_six_directions() {
        assert_eq!(uv(0.0, 0.0, 3.0), (960.0, 480.0), "forward");
        assert_eq!(uv(3.0, 0.0, 0.0), (1440.0, 480.0), "right");
        assert_eq!(uv(-3.0, 0.0, 0.0), (480.0, 480.0), "left");
        assert_eq!(uv(0.0, 0.0, -3.0), (0.0, 480.0), "behind");
        assert_eq!(uv(0.0, -3.0, 0.0), (960.0, 0.0), "up");
        assert_eq!(uv(-0.0, 3.0, -0.0), (960.0, 960.0), "down");
        assert_eq!(uv(0.0, 3.0, 3.0), (960.0, 720.0), "halfway down");
    }

    #[test]
    fn the_seam_is_on_the_left() {
        assert!(uv(-1e-18, 0.0, -5.0).0 < 1920.0);
        assert!(uv(1e-3, 0.0, -5.0).0 > 1919.0);
    }

    #[test]
    fn what_is_nowhere_has_no_pixel_and_no_ray() {
        for point in [[0.0; 3], [f64::NAN, 0.0, 1.0], [0.0, f64::INFINITY, 1.0]] {
            assert_eq!(LENS.pixel_from_camera(&point.into()), None, "{point:?}");
        }
        for v in [-0.1, 960.1, f64::NAN] {
            assert_eq!(LENS.ray_from_pixel(5.0, v), None, "{v}");
        }
    }

    proptest! {
        #[test]
        fn pixels_survive_the_round_trip(u in 0.0..1920.0, v in 0.01..959.99) {
            check_round_trip(&posed(LENS), [u, v], 1e-7);
        }

        #[test]
        fn rows_grow_downwards(x in -9.0..9.0, z in 0.1..9.0, y in -9.0..9.0, step in 0.001..1.0) {
            prop_assert!(uv(x, y, z).1 < uv(x, y + step, z).1);
            prop_assert_eq!(uv(x, y, z).0, uv(x, y + step, z).0);
        }

        #[test]
        fn nothing_panics(width_px: u32, height_px: u32, p in prop::array::uniform3(any::<f64>())) {
            let lens = Equirectangular { width_px, height_px };
            lens.pixel_from_camera(&p.into());
            lens.ray_from_pixel(p[0], p[1]);
        }
    }
}
