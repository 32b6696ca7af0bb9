//! Sweeps of several LiDARs in one frame, with the pixel of every point.

use jrdb_types::{Issue, PointCloud, Rig, issue::IssueKind, rig::LidarMount};
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};

use crate::camera::CameraModel;

/// All points of a frame in the base frame (x forward, y left, z up), metres, with the pixel each
/// falls on. The arrays are equally long; points without a pixel are left out.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BaseCloud {
    /// Positions.
    pub points: Vec<Point3<f64>>,
    /// Columns, pixels.
    pub u: Vec<f64>,
    /// Rows, pixels.
    pub v: Vec<f64>,
}

/// The transform `base_from_lidar`: a rotation about z after the offset is subtracted.
#[must_use]
pub fn base_from_lidar(mount: &LidarMount) -> Isometry3<f64> {
    let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), mount.yaw_rad);
    let translation = -(yaw * Vector3::from(mount.offset_m));
    Isometry3::from_parts(translation.into(), yaw)
}

impl BaseCloud {
    /// Merges sweeps, in the order given, and finds the pixel of every point.
    ///
    /// A sweep of a LiDAR that the rig does not know is left out and pushed to `issues`.
    #[must_use]
    pub fn merge(clouds: &[PointCloud], rig: &Rig, issues: &mut Vec<Issue>) -> Self {
        let mut merged = Self::default();
        for cloud in clouds {
            match rig.lidars.iter().find(|mount| mount.name == cloud.sensor) {
                Some(mount) => merged.push(cloud, &base_from_lidar(mount), &rig.panorama),
                None => {
                    let known: Vec<&str> = rig.lidars.iter().map(|m| m.name.as_str()).collect();
                    let message =
                        format!("the rig has no lidar {:?}, only {known:?}", cloud.sensor);
                    issues.push(Issue::new(IssueKind::MissingInput, message));
                }
            }
        }
        merged
    }

    fn push(
        &mut self,
        cloud: &PointCloud,
        base_from_lidar: &Isometry3<f64>,
        camera: &dyn CameraModel,
    ) {
        for ((&x, &y), &z) in cloud.x.iter().zip(&cloud.y).zip(&cloud.z) {
            let point = base_from_lidar * Point3::new(x, y, z);
            if let Some(pixel) = camera.pixel_from_base(&point) {
                self.points.push(point);
                self.u.push(pixel.u);
                self.v.push(pixel.v);
            }
        }
    }

    /// Number of points.
    #[must_use]
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether there is no point.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing;

    fn rig() -> Rig {
        testing::rig([0.0, 0.0, -0.3], 0.1)
    }

    fn sweep(sensor: &str) -> PointCloud {
        let (x, y, z) = (vec![1.0, 0.0], vec![0.0, 0.0], vec![0.0, 1.0]);
        PointCloud { sensor: sensor.into(), x, y, z, ..PointCloud::default() }
    }

    #[test]
    fn the_offset_is_subtracted_and_the_yaw_turns_left() {
        let cloud = BaseCloud::merge(&[sweep("upper")], &rig(), &mut Vec::new());
        let expected = Point3::new(0.1_f64.cos(), 0.1_f64.sin(), 0.3);
        assert!((cloud.points[0] - expected).norm() < 1e-12);
    }

    #[test]
    fn points_without_a_pixel_are_left_out() {
        assert_eq!(BaseCloud::merge(&[sweep("upper")], &rig(), &mut Vec::new()).len(), 1);
    }

    #[test]
    fn an_unknown_lidar_is_an_issue() {
        let mut issues = Vec::new();
        assert!(BaseCloud::merge(&[sweep("rear")], &rig(), &mut issues).is_empty());
        assert_eq!(issues[0].message, r#"the rig has no lidar "rear", only ["upper"]"#);
    }
}
