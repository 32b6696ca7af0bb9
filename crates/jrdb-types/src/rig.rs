//! The robot's sensors and how they are mounted.

use serde::{Deserialize, Serialize};

use crate::artefact::Payload;
use crate::geometry::ImageGeometry;

/// A 360° cylindrical image around the base frame's origin: JRDB's official model.
///
/// `u = (1/2 - atan2(y, x) / 2π) · W mod W`, `v = c - f · z / hypot(x, y)`: column 0 looks backwards,
/// the middle column forwards, columns grow to the right. Pixels are not square: `f` is vertical only.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CylindricalPanorama {
    /// W, columns, pixels.
    pub width_px: u32,
    /// Rows, pixels.
    pub height_px: u32,
    /// f, rows per unit slope, pixels.
    pub focal_px: f64,
    /// c, the row of the horizon, pixels.
    pub horizon_px: f64,
}

impl CylindricalPanorama {
    /// Size and topology of its images.
    #[must_use]
    pub fn image(&self) -> ImageGeometry {
        ImageGeometry { width_px: self.width_px, height_px: self.height_px, wraps: true }
    }
}

/// Where a LiDAR sits: `p_base = Rz(yaw) · (p_lidar - offset)`.
///
/// The offset is *subtracted*, as in JRDB's `defaults.yaml`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LidarMount {
    /// Sensor name, for example `upper_velodyne`.
    pub name: String,
    /// Offset `[x, y, z]` in the LiDAR's frame, metres.
    pub offset_m: [f64; 3],
    /// Rotation about z, radians, counter-clockwise.
    pub yaw_rad: f64,
}

/// A robot's panorama camera and LiDARs in one base frame (x forward, y left, z up).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Rig {
    /// The camera.
    pub panorama: CylindricalPanorama,
    /// The LiDARs.
    pub lidars: Vec<LidarMount>,
}

impl Payload for Rig {
    const SCHEMA: &'static str = "jrdb.rig";
    const VERSION: u32 = 1;
}
