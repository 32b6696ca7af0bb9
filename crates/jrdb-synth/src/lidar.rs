//! What the two LiDARs see: 16 rings each, cast against floor, walls and solids.

use std::f64::consts::TAU;

use jrdb_projection::Sensors;
use jrdb_projection::nalgebra::{Point3, Vector3};
use jrdb_types::PointCloud;

use super::random::Random;
use super::room::{Above, FLOOR_M, Room};
use super::solid::{Ray, Solid};

/// Rings of a VLP-16: -15° to 15° in steps of 2°.
const RINGS: i32 = 16;
const LOWEST_DEG: f64 = -15.0;
const RING_STEP_DEG: f64 = 2.0;
/// Columns of one turn, 0.4° apart.
const COLUMNS: i32 = 900;
/// Deviation of a range, metres.
const NOISE_M: f64 = 0.01;
/// Nothing nearer than this is seen, metres (the nearest return of the lower sensor in real
/// sweeps).
const NEAREST_M: f64 = 0.7;

/// Returns of the surfaces, in the sensor's scale of 0 to 255.
const FLOOR_RETURN: f32 = 9.0;
const WALL_RETURN: f32 = 34.0;

/// Solids that belong together, with the strength of their returns.
pub(super) struct Target {
    solids: Vec<Solid>,
    intensity: f32,
    /// A ball around all of them, so that most rays need no closer look.
    middle: Point3<f64>,
    radius_m: f64,
}

impl Target {
    /// `solids` are not empty.
    pub(super) fn new(solids: Vec<Solid>, intensity: f32) -> Self {
        let sum: Vector3<f64> = solids.iter().map(|solid| solid.center.coords).sum();
        let middle = Point3::from(sum / solids.len() as f64);
        let reach = |solid: &Solid| (solid.center - middle).norm() + solid.half.norm();
        let radius_m = solids.iter().map(reach).fold(0.0, f64::max);
        Self { solids, intensity, middle, radius_m }
    }

    fn hit_m(&self, ray: &Ray) -> Option<f64> {
        let to_middle = self.middle - ray.from;
        let along = to_middle.dot(&ray.along);
        if to_middle.norm_squared() - along * along > self.radius_m * self.radius_m {
            return None;
        }
        self.solids.iter().filter_map(|solid| solid.hit_m(ray)).reduce(f64::min)
    }
}

/// One turn of a LiDAR in its own frame, columns counter-clockwise, rings from below; metres,
/// rounded to millimetres.
pub(super) fn sweep(
    name: &str,
    sensors: &Sensors,
    room: &Room,
    targets: &[Target],
    random: &mut Random,
) -> PointCloud {
    let base_from_lidar = sensors.lidars[name];
    let from = base_from_lidar * Point3::origin();
    let mut cloud = PointCloud { sensor: name.into(), ..PointCloud::default() };
    for column in 0..COLUMNS {
        let azimuth_rad = TAU * f64::from(column) / f64::from(COLUMNS);
        for ring in 0..RINGS {
            let elevation_rad = (LOWEST_DEG + RING_STEP_DEG * f64::from(ring)).to_radians();
            let (rise, level) = elevation_rad.sin_cos();
            let own = Vector3::new(level * azimuth_rad.cos(), level * azimuth_rad.sin(), rise);
            let ray = Ray { from, along: base_from_lidar * own };
            let noise_m = NOISE_M * random.normal();
            if let Some((range_m, intensity)) = first_return(&ray, room, targets) {
                push(&mut cloud, own * (range_m + noise_m), intensity);
            }
        }
    }
    cloud
}

fn push(cloud: &mut PointCloud, point: Vector3<f64>, intensity: f32) {
    let millimetres = |metres: f64| ((metres * 1000.0).round() / 1000.0) as f32;
    cloud.x.push(millimetres(point.x));
    cloud.y.push(millimetres(point.y));
    cloud.z.push(millimetres(point.z));
    cloud.intensity.push(intensity);
}

/// Range and strength of the nearest return; none from the sky.
fn first_return(ray: &Ray, room: &Room, targets: &[Target]) -> Option<(f64, f32)> {
    let things = targets.iter().filter_map(|target| Some((target.hit_m(ray)?, target.intensity)));
    let nearest = |a: (f64, f32), b: (f64, f32)| if b.0 < a.0 { b } else { a };
    things.chain(shell(ray, room)).filter(|(range_m, _)| *range_m >= NEAREST_M).reduce(nearest)
}

/// Floor, wall or ceiling. The sensors sit on the base frame's z axis, so a ray's azimuth tells its
/// wall.
fn shell(ray: &Ray, room: &Room) -> Option<(f64, f32)> {
    let level = ray.along.xy().norm();
    let wall_m = room.wall_at(ray.along.y.atan2(ray.along.x)).range_m / level;
    let height_m = ray.from.z + wall_m * ray.along.z - FLOOR_M;
    if height_m < 0.0 {
        return Some(((FLOOR_M - ray.from.z) / ray.along.z, FLOOR_RETURN));
    }
    if height_m <= room.wall_m {
        return Some((wall_m, WALL_RETURN));
    }
    let ceiling_m = (FLOOR_M + room.wall_m - ray.from.z) / ray.along.z;
    (room.paint.above != Above::Sky).then_some((ceiling_m, WALL_RETURN))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::person::tests::walker;
    use crate::robot;
    use crate::room::Setting;

    fn points(targets: &[Target], setting: Setting) -> Vec<Point3<f64>> {
        let room = Room::new(setting, &mut Random::stream(1, 1));
        let (name, sensors) = ("lower_velodyne", robot::sensors());
        let cloud = sweep(name, &sensors, &room, targets, &mut Random::stream(1, 9));
        let from_sensor = sensors.lidars[name];
        (0..cloud.len())
            .map(|i| from_sensor * Point3::new(cloud.x[i], cloud.y[i], cloud.z[i]).cast::<f64>())
            .collect()
    }

    #[test]
    fn an_empty_room_returns_its_floor_and_walls() {
        let points = points(&[], Setting::Cafe);
        assert_eq!(points.len(), 16 * 900);
        let on = |value: f64, wanted: f64| (value - wanted).abs() < 0.08;
        for p in points {
            let wall = on(p.x, 9.0) || on(p.x, -5.0) || on(p.y, 5.2) || on(p.y, -5.8);
            assert!(wall || on(p.z, FLOOR_M) || on(p.z, FLOOR_M + 2.9), "{p}");
        }
    }

    #[test]
    fn a_person_returns_their_near_side_and_hides_the_wall() {
        let walker = walker();
        let target = Target::new(walker.solids(&walker.pose(0.0)), 20.0);
        let points = points(&[target], Setting::Cafe);
        let ahead: Vec<_> = points.iter().filter(|p| p.x > 0.0 && p.y.abs() < 0.1).collect();
        let on_body = ahead.iter().filter(|p| (3.5..4.2).contains(&p.x) && p.z > FLOOR_M + 0.1);
        assert!(on_body.count() > 20);
        assert!(!ahead.iter().any(|p| p.x > 8.0 && (-0.2..0.4).contains(&p.z)));
    }

    #[test]
    fn the_sky_returns_nothing() {
        assert!(points(&[], Setting::Plaza).len() < 16 * 900);
    }
}
