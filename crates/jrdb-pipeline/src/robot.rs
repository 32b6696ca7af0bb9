//! A robot's sensors.

use jrdb_projection::{CameraModel, Sensors};
use jrdb_types::{ImageGeometry, Rig};

use crate::Error;

/// A rig, checked, and the camera in use.
#[derive(Debug, Clone, PartialEq)]
pub struct Robot {
    /// The sensors.
    pub rig: Rig,
    /// The camera that the images are from; the rig's first when absent.
    pub camera: Option<String>,
    /// Size of its images and whether they wrap.
    pub image: ImageGeometry,
}

impl Robot {
    /// Checks a rig and finds its camera.
    ///
    /// # Errors
    /// When the rig is no tree of frames, or has no such camera.
    pub fn new(rig: Rig, camera: Option<String>) -> Result<Self, Error> {
        let sensors = Sensors::new(&rig, camera.as_deref()).map_err(Error::Rig)?;
        let image = sensors.camera.image();
        Ok(Self { rig, camera, image })
    }
}
