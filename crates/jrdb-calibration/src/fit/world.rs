//! A small world for the tests: upright blocks around the robot, before a round wall, on a floor.

use std::f64::consts::{PI, TAU};

use jrdb_projection::CameraModel;
use jrdb_projection::camera::PosedCamera;
use jrdb_types::CylindricalPanorama;
use jrdb_types::Image;
use nalgebra::{Point3, Vector3};

/// The world's panorama.
pub(super) fn camera() -> PosedCamera<CylindricalPanorama> {
    PosedCamera::ahead(CylindricalPanorama {
        width_px: 1880,
        height_px: 240,
        focal_px: 240.0,
        horizon_px: 105.0,
    })
}

/// A block whose face is at one horizontal range from the z axis.
struct Block {
    azimuth_rad: f64,
    half_width_rad: f64,
    range_m: f64,
    bottom_m: f64,
    top_m: f64,
    gray: u8,
}

const FLOOR_M: f64 = -0.9;
const WALL_M: f64 = 7.0;
const FLOOR_GRAY: u8 = 90;
const WALL_GRAY: u8 = 150;

/// Blocks all around, no two alike.
fn blocks() -> impl Iterator<Item = Block> {
    (0..24).map(|i| {
        let vary = |period: i32| f64::from(i % period) / f64::from(period);
        Block {
            azimuth_rad: -PI + TAU * (f64::from(i) + 0.3 + 0.4 * vary(5)) / 24.0,
            half_width_rad: 0.04 + 0.05 * vary(4),
            range_m: 1.6 + 2.5 * vary(7),
            bottom_m: if i % 3 == 0 { -0.4 } else { FLOOR_M },
            top_m: -0.2 + 0.6 * vary(6),
            gray: if i % 2 == 0 { 30 } else { 230 },
        }
    })
}

/// Range and grey of what a ray that rises by `slope` meets.
fn hit(blocks: &[Block], from_m: f64, azimuth_rad: f64, slope: f64) -> (f64, u8) {
    let floor = (slope < 0.0).then(|| ((FLOOR_M - from_m) / slope, FLOOR_GRAY));
    let faces = blocks.iter().filter_map(|block| {
        let off = (azimuth_rad - block.azimuth_rad + PI).rem_euclid(TAU) - PI;
        let height_m = from_m + block.range_m * slope;
        let meets =
            off.abs() < block.half_width_rad && (block.bottom_m..block.top_m).contains(&height_m);
        meets.then_some((block.range_m, block.gray))
    });
    let all = faces.chain(floor).chain([(WALL_M, WALL_GRAY)]);
    all.reduce(|a, b| if b.0 < a.0 { b } else { a }).expect("there is a wall")
}

/// What [`camera`] sees.
pub(super) fn picture() -> Image {
    let blocks: Vec<Block> = blocks().collect();
    let mut image = Image::filled(1880, 240, [0; 3]);
    for (at, pixel) in image.rgb.chunks_exact_mut(3).enumerate() {
        let [u, v] = [at % 1880, at / 1880].map(|i| i as f64 + 0.5);
        let ray = camera().ray_from_pixel(u, v).unwrap();
        let slope = ray.z / ray.x.hypot(ray.y);
        pixel.fill(hit(&blocks, 0.0, ray.y.atan2(ray.x), slope).1);
    }
    image
}

/// What a LiDAR of 32 rings at a height sees, base frame.
pub(super) fn sweep(height_m: f64) -> (Point3<f64>, Vec<Point3<f64>>) {
    let blocks: Vec<Block> = blocks().collect();
    let origin = Point3::new(0.0, 0.0, height_m);
    let beams = (0..32).flat_map(|ring| (0..900).map(move |column| (ring, column)));
    let point = |(ring, column): (i32, i32)| {
        let slope = (f64::from(ring) - 20.0).to_radians().tan();
        let azimuth = TAU * (f64::from(column) + 0.5) / 900.0 - PI;
        let (range, _) = hit(&blocks, height_m, azimuth, slope);
        origin + Vector3::new(azimuth.cos(), azimuth.sin(), slope) * range
    };
    (origin, beams.map(point).collect())
}
