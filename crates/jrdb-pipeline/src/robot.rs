//! A robot's sensors, resolved once.

use std::fmt;

use jrdb_projection::{CameraModel, Sensors};
use jrdb_types::{ImageGeometry, Rig};

use crate::Error;

/// A rig and the camera in use, checked and resolved into the base frame.
pub struct Robot {
    rig: Rig,
    camera: Option<String>,
    sensors: Sensors,
}

impl Robot {
    /// Checks a rig and resolves its sensors. `camera` names the camera that the images are from; the rig's first when
    /// absent.
    ///
    /// # Errors
    /// [`Error::Rig`] when the rig's frames do not form a tree, or it has no such camera.
    pub fn new(rig: Rig, camera: Option<String>) -> Result<Self, Error> {
        let sensors = Sensors::new(&rig, camera.as_deref()).map_err(Error::Rig)?;
        Ok(Self { rig, camera, sensors })
    }

    /// The description that the robot was made from.
    #[must_use]
    pub fn rig(&self) -> &Rig {
        &self.rig
    }

    /// The camera that was asked for by name; the rig's first is in use when absent.
    #[must_use]
    pub fn camera(&self) -> Option<&str> {
        self.camera.as_deref()
    }

    /// The camera in use and all LiDARs, in the base frame.
    #[must_use]
    pub fn sensors(&self) -> &Sensors {
        &self.sensors
    }

    /// Size of the camera's images and whether they wrap.
    #[must_use]
    pub fn image(&self) -> ImageGeometry {
        self.sensors.camera.image()
    }
}

impl fmt::Debug for Robot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Robot").field("rig", &self.rig).field("camera", &self.camera).finish()
    }
}
