//! Frames of a dataset as the calibration check wants them, and its report in words.

mod floors;

use std::collections::BTreeMap;
use std::sync::Arc;

use jrdb_calibration::{Sweep, View};
use jrdb_pipeline::Robot;
use jrdb_projection::nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use jrdb_projection::sensors::RigCamera;
use jrdb_types::{Image, PointCloud, with_causes};
use serde::Serialize;

use crate::Error;
use crate::source::FrameSource;

pub use floors::{floor_lines, tilted_more};

/// Where each LiDAR sits, by name: `base_from_lidar`.
pub type Mounts = BTreeMap<String, Isometry3<f64>>;

/// An error added to mounts, to see what the check makes of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Plant {
    /// Added to the yaw, degrees, counter-clockwise from above.
    pub yaw_deg: f64,
    /// Added to the height, metres.
    pub height_m: f64,
    /// LiDARs that get it; all when empty.
    pub lidars: Vec<String>,
}

impl Plant {
    /// Whether nothing is added.
    #[must_use]
    pub fn is_nothing(&self) -> bool {
        self.yaw_deg == 0.0 && self.height_m == 0.0
    }

    /// Whether a LiDAR gets it.
    #[must_use]
    pub fn concerns(&self, lidar: &str) -> bool {
        self.lidars.is_empty() || self.lidars.iter().any(|name| name == lidar)
    }

    /// The mounts with the error: each LiDAR turned about its own origin, and raised.
    ///
    /// # Errors
    /// When the error is not finite or there is no LiDAR that should get it.
    pub fn apply(&self, mounts: &Mounts) -> Result<Mounts, Error> {
        let known: Vec<&String> = mounts.keys().collect();
        if let Some(name) = self.lidars.iter().find(|name| !known.contains(name)) {
            return Err(Error::Usage(format!("expected a LiDAR of {known:?}, found {name:?}")));
        }
        if !(self.yaw_deg.is_finite() && self.height_m.is_finite()) {
            let found = format!("{}° and {} m", self.yaw_deg, self.height_m);
            return Err(Error::Usage(format!("expected a finite error to plant, found {found}")));
        }
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), self.yaw_deg.to_radians());
        let mut mounts = mounts.clone();
        for (_, mount) in mounts.iter_mut().filter(|(name, _)| self.concerns(name)) {
            mount.rotation = turn * mount.rotation;
            mount.translation.vector.z += self.height_m;
        }
        Ok(mounts)
    }
}

/// A sweep in the base frame.
#[derive(Debug, Clone)]
pub struct BaseSweep {
    /// Name of the LiDAR.
    pub sensor: String,
    /// Where its beams start, metres.
    pub origin: Point3<f64>,
    /// Its points, metres.
    pub points: Vec<Point3<f64>>,
}

impl BaseSweep {
    fn as_sweep(&self) -> Sweep<'_> {
        Sweep { sensor: &self.sensor, origin: self.origin, points: &self.points }
    }
}

/// Brings the sweeps of the LiDARs that have a mount into the base frame.
#[must_use]
pub fn base_sweeps(clouds: &[PointCloud], mounts: &Mounts) -> Vec<BaseSweep> {
    let known = clouds.iter().filter_map(|cloud| {
        let base_from_lidar = mounts.get(&cloud.sensor)?;
        let at = |i: usize| Point3::new(cloud.x[i], cloud.y[i], cloud.z[i]).cast();
        let points = (0..cloud.len()).map(|i| base_from_lidar * at(i)).collect();
        let origin = base_from_lidar * Point3::origin();
        Some(BaseSweep { sensor: cloud.sensor.clone(), origin, points })
    });
    known.collect()
}

/// One frame's image and clouds.
pub struct CalibFrame {
    /// Name of the frame.
    pub name: String,
    /// The sensors as calibrated.
    pub robot: Arc<Robot>,
    /// The image.
    pub image: Image,
    /// One sweep per LiDAR, in the sensors' frames.
    pub clouds: Vec<PointCloud>,
    /// The LiDARs as calibrated.
    pub mounts: Mounts,
    /// What could not be read.
    pub notes: Vec<String>,
}

impl CalibFrame {
    /// Reads a frame.
    ///
    /// # Errors
    /// When there is no image or no cloud, or the rig is unusable.
    pub fn read(frame: &FrameSource) -> Result<Self, Error> {
        let name = frame.id.to_string();
        let fail = |message: &str| Error::Usage(format!("{name}: {message}"));
        let image = frame.image().map_err(|issue| fail(&issue.message))?;
        let (clouds, issues) = frame.clouds();
        let notes: Vec<String> = issues.into_iter().map(|issue| issue.message).collect();
        if clouds.is_empty() {
            return Err(fail(&format!("expected a cloud, found none: {}", notes.join("; "))));
        }
        let robot = frame.robot.clone();
        let mounts = robot.sensors().lidars.clone();
        Ok(Self { name, robot, image, clouds, mounts, notes })
    }

    /// The camera in use.
    #[must_use]
    pub fn camera(&self) -> &RigCamera {
        &self.robot.sensors().camera
    }
}

/// Calls `work` with the frames as views, their sweeps mounted as in `mounts`.
///
/// # Errors
/// Those of `work`.
pub fn with_views<T>(
    frames: &[CalibFrame],
    mounts: &[Mounts],
    work: impl FnOnce(&[View<'_>]) -> Result<T, jrdb_calibration::Error>,
) -> Result<T, Error> {
    let base: Vec<Vec<BaseSweep>> =
        frames.iter().zip(mounts).map(|(frame, m)| base_sweeps(&frame.clouds, m)).collect();
    let sweeps: Vec<Vec<Sweep<'_>>> =
        base.iter().map(|all| all.iter().map(BaseSweep::as_sweep).collect()).collect();
    let views: Vec<View<'_>> = frames
        .iter()
        .zip(&sweeps)
        .map(|(frame, sweeps)| View { camera: frame.camera(), image: &frame.image, sweeps })
        .collect();
    work(&views).map_err(|error| Error::Usage(with_causes(&error)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_planted_error_moves_the_points_by_itself() {
        let at = Isometry3::from_parts(
            Vector3::new(0.0, 0.0, 0.3).into(),
            UnitQuaternion::from_euler_angles(0.0, 0.0, 0.1),
        );
        let mounts = Mounts::from([("a".into(), at), ("b".into(), at)]);
        let plant = Plant { yaw_deg: 90.0, height_m: 0.2, lidars: vec!["b".into()] };
        let planted = plant.apply(&mounts).unwrap();
        assert_eq!(planted["a"], mounts["a"]);
        let [before, after] =
            [&mounts, &planted].map(|mounts| mounts["b"] * Point3::new(1.0, 0.0, 0.0));
        assert!((after - Point3::new(-before.y, before.x, before.z + 0.2)).norm() < 1e-12);
        let stranger = Plant { lidars: vec!["c".into()], ..plant };
        let error = stranger.apply(&mounts).unwrap_err().to_string();
        assert_eq!(error, r#"expected a LiDAR of ["a", "b"], found "c""#);
    }
}
