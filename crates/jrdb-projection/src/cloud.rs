//! Sweeps of several LiDARs in one frame, with the pixel of every point.

use jrdb_types::{Issue, PointCloud, issue::IssueKind};
use nalgebra::{Isometry3, Point3};

use crate::camera::{Columns, Lens, PixelColumns};
use crate::sensors::Sensors;
use crate::simd::{Loop, vectorised};

/// All points of a frame in the base frame (x forward, y left, z up), metres, with the pixel each
/// falls on. The columns are equally long.
///
/// Single precision: a LiDAR's ranges are good to millimetres, and at 100 m a step is 8 µm.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BaseCloud {
    /// Forward.
    pub x: Vec<f32>,
    /// Left.
    pub y: Vec<f32>,
    /// Up.
    pub z: Vec<f32>,
    /// Columns, pixels; NaN where the camera does not see the point.
    pub u: Vec<f32>,
    /// Rows, pixels; NaN where the camera does not see the point.
    pub v: Vec<f32>,
}

impl BaseCloud {
    /// Merges sweeps, in the order given, and finds the pixel of every point.
    ///
    /// A sweep without points is named in `issues`; so is one of a LiDAR that the rig does not know, which is left out.
    #[must_use]
    pub fn merge(clouds: &[PointCloud], sensors: &Sensors, issues: &mut Vec<Issue>) -> Self {
        let mut merged = Self::default();
        merged.refill(clouds, sensors, issues);
        merged
    }

    /// [`BaseCloud::merge`] into a cloud whose memory is used again: what a stream of frames wants.
    pub fn refill(&mut self, clouds: &[PointCloud], sensors: &Sensors, issues: &mut Vec<Issue>) {
        tracing::trace!(target: "jrdb::merge", sweeps = clouds.len());
        let empty = clouds.iter().filter(|cloud| cloud.is_empty());
        let message = |cloud: &PointCloud| format!("the sweep of {:?} has no points", cloud.sensor);
        issues.extend(empty.map(|cloud| Issue::new(IssueKind::MissingInput, message(cloud))));
        let placed: Vec<(&PointCloud, &Isometry3<f64>)> =
            clouds.iter().filter_map(|cloud| place(cloud, sensors, issues)).collect();
        let total = placed.iter().map(|(cloud, _)| cloud.len()).sum();
        for column in [&mut self.x, &mut self.y, &mut self.z, &mut self.u, &mut self.v] {
            column.resize(total, 0.0);
        }
        let mut start = 0;
        for (cloud, base_from_lidar) in placed {
            self.write(start, cloud, base_from_lidar, sensors);
            start += cloud.len();
        }
    }

    /// Writes a sweep's points from `start` on.
    fn write(
        &mut self,
        start: usize,
        cloud: &PointCloud,
        base_from_lidar: &Isometry3<f64>,
        sensors: &Sensors,
    ) {
        let camera_from_lidar = sensors.camera.camera_from_base * base_from_lidar;
        let [to_base, to_camera] = &[base_from_lidar, &camera_from_lidar].map(Affine::of);
        let lens: &dyn Lens = &sensors.camera.lens;
        let mut camera = [[0.0; BLOCK]; 3];
        for first in (0..cloud.len()).step_by(BLOCK) {
            let from = first..(first + BLOCK).min(cloud.len());
            let count = from.len();
            let place = start + from.start..start + from.end;
            let lidar = [&cloud.x, &cloud.y, &cloud.z].map(|column| &column[from.clone()]);
            let base = [&mut self.x, &mut self.y, &mut self.z];
            let base = base.map(|column| &mut column[place.clone()]);
            let in_camera = camera.each_mut().map(|column| &mut column[..count]);
            vectorised(Transform { to_base, to_camera, lidar, base, camera: in_camera });
            let [x, y, z] = camera.each_ref().map(|column| &column[..count]);
            let pixels = &mut PixelColumns { u: &mut self.u[place.clone()], v: &mut self.v[place] };
            lens.pixels_from_camera(&Columns { x, y, z }, pixels);
        }
    }

    /// Number of points.
    #[must_use]
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// Whether there is no point.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// One point, metres.
    ///
    /// # Panics
    /// When there is no such point.
    #[must_use]
    pub fn point(&self, index: usize) -> Point3<f64> {
        Point3::new(self.x[index], self.y[index], self.z[index]).cast()
    }
}

/// Points in a block: their coordinates stay in the first-level cache.
const BLOCK: usize = 512;

/// A sweep with the place of its LiDAR; an issue when the rig does not know it.
fn place<'a>(
    cloud: &'a PointCloud,
    sensors: &'a Sensors,
    issues: &mut Vec<Issue>,
) -> Option<(&'a PointCloud, &'a Isometry3<f64>)> {
    let found = sensors.lidars.get(&cloud.sensor);
    if found.is_none() {
        let known: Vec<&String> = sensors.lidars.keys().collect();
        let message = format!("the rig has no lidar {:?}, only {known:?}", cloud.sensor);
        issues.push(Issue::new(IssueKind::MissingInput, message));
    }
    found.map(|base_from_lidar| (cloud, base_from_lidar))
}

/// A rigid transform as twelve single-precision numbers.
struct Affine([[f32; 4]; 3]);

impl Affine {
    fn of(isometry: &Isometry3<f64>) -> Self {
        let matrix = isometry.to_homogeneous();
        Self([0, 1, 2].map(|row| [0, 1, 2, 3].map(|column| matrix[(row, column)] as f32)))
    }

    #[inline(always)]
    fn apply(&self, x: f32, y: f32, z: f32) -> [f32; 3] {
        self.0.map(|[a, b, c, t]| a.mul_add(x, b.mul_add(y, c.mul_add(z, t))))
    }
}

/// Points of a LiDAR to the base frame and to the camera's at once; the columns are equally long.
struct Transform<'a> {
    to_base: &'a Affine,
    to_camera: &'a Affine,
    lidar: [&'a [f32]; 3],
    base: [&'a mut [f32]; 3],
    camera: [&'a mut [f32]; 3],
}

impl Loop for Transform<'_> {
    #[inline(always)]
    fn run(self) {
        let [x, y, z] = self.lidar;
        let [bx, by, bz] = self.base;
        let [cx, cy, cz] = self.camera;
        let base = bx.iter_mut().zip(by).zip(bz);
        let camera = cx.iter_mut().zip(cy).zip(cz);
        let lidar = x.iter().zip(y).zip(z);
        for ((((&x, &y), &z), ((bx, by), bz)), ((cx, cy), cz)) in lidar.zip(base).zip(camera) {
            [*bx, *by, *bz] = self.to_base.apply(x, y, z);
            [*cx, *cy, *cz] = self.to_camera.apply(x, y, z);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing;

    fn sensors() -> Sensors {
        Sensors::new(&testing::rig([0.0, 0.0, 0.3], 0.1), None).unwrap()
    }

    fn sweep(sensor: &str) -> PointCloud {
        let (x, y, z) = (vec![1.0, 0.0], vec![0.0, 0.0], vec![0.0, 1.0]);
        PointCloud { sensor: sensor.into(), x, y, z, ..PointCloud::default() }
    }

    #[test]
    fn points_are_moved_up_and_turned_to_the_left_as_their_lidar_is() {
        let cloud = BaseCloud::merge(&[sweep("upper")], &sensors(), &mut Vec::new());
        let expected = Point3::new(0.1_f64.cos(), 0.1_f64.sin(), 0.3);
        assert!((cloud.point(0) - expected).norm() < 1e-6);
        assert!(
            (f64::from(cloud.u[0]) - (1880.0 - 0.1 * 3760.0 / std::f64::consts::TAU)).abs() < 1e-3
        );
    }

    #[test]
    fn points_that_the_camera_does_not_see_have_no_pixel() {
        let mut cloud = BaseCloud::merge(&[sweep("upper")], &sensors(), &mut Vec::new());
        cloud.refill(&[sweep("upper")], &sensors(), &mut Vec::new());
        assert_eq!(cloud.len(), 2);
        assert!(cloud.u[1].is_nan() && cloud.v[1].is_nan());
    }

    #[test]
    fn blocks_do_not_show() {
        let count = 2 * BLOCK + 7;
        let x: Vec<f32> = (0..count).map(|i| 1.0 + i as f32 * 0.01).collect();
        let (y, z) = (vec![0.5; count], vec![0.25; count]);
        let cloud = PointCloud { sensor: "upper".into(), x, y, z, ..PointCloud::default() };
        let merged = BaseCloud::merge(&[cloud.clone(), cloud], &sensors(), &mut Vec::new());
        assert_eq!(merged.len(), 2 * count);
        for i in [0, 1, BLOCK - 1, BLOCK, 2 * BLOCK, count - 1] {
            assert_eq!(merged.point(i), merged.point(count + i));
            assert_eq!(merged.u[i], merged.u[count + i]);
            let at = nalgebra::Rotation3::from_euler_angles(0.0, 0.0, 0.1)
                * Point3::new(1.0 + i as f64 * 0.01, 0.5, 0.25);
            assert!((merged.point(i) - at - nalgebra::Vector3::new(0.0, 0.0, 0.3)).norm() < 1e-5);
        }
    }

    #[test]
    fn an_unknown_lidar_is_an_issue() {
        let mut issues = Vec::new();
        assert!(BaseCloud::merge(&[sweep("rear")], &sensors(), &mut issues).is_empty());
        assert_eq!(issues[0].message, r#"the rig has no lidar "rear", only ["upper"]"#);
    }
}
