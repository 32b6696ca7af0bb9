//! Frames of a dataset as the calibration check wants them.

use std::collections::BTreeMap;
use std::sync::Arc;

use jrdb_calibration::{Sweep, View};
use jrdb_pipeline::Robot;
use jrdb_projection::nalgebra::{Isometry3, Point3};
use jrdb_projection::sensors::RigCamera;
use jrdb_types::{Image, PointCloud, with_causes};

use crate::Error;
use crate::source::FrameSource;

/// Where each LiDAR sits, by name: `base_from_lidar`.
pub type Mounts = BTreeMap<String, Isometry3<f64>>;

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
