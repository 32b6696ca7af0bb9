//! The robot's sensors and how they are mounted.

use serde::{Deserialize, Serialize};

use crate::artefact::Payload;
use crate::lens::LensModel;

/// A rotation as calibration files write it.
///
/// As JSON or YAML: `{"rpy_rad": [0, 0, 0.085]}`, `{"quaternion_wxyz": [1, 0, 0, 0]}` or
/// `{"matrix": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Rotation {
    /// Roll about x, then pitch about y, then yaw about z, all about the parent's fixed axes, radians: URDF's
    /// `rpy`; `R = Rz(yaw) Ry(pitch) Rx(roll)`.
    RpyRad([f64; 3]),
    /// A unit quaternion, real part first: nuScenes' order. (ROS writes the real part last.)
    QuaternionWxyz([f64; 4]),
    /// A rotation matrix, row by row.
    Matrix([[f64; 3]; 3]),
}

impl Default for Rotation {
    /// No rotation.
    fn default() -> Self {
        Self::RpyRad([0.0; 3])
    }
}

/// Where a frame sits in another: `p_parent = R p_child + t`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Transform {
    /// Name of the frame in which the child is placed.
    pub parent: String,
    /// Name of the frame that is placed. Every frame but the base is the child of exactly one transform.
    pub child: String,
    /// t: the child's origin in the parent, metres.
    #[serde(default)]
    pub translation_m: [f64; 3],
    /// R: the child's axes in the parent.
    #[serde(default)]
    pub rotation: Rotation,
}

/// A camera.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// Its name, for example `panorama`.
    pub name: String,
    /// The frame it looks along: x right, y down, z forward.
    pub frame: String,
    /// How it draws.
    pub lens: LensModel,
}

/// A LiDAR.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Lidar {
    /// Its name, for example `upper_velodyne`; clouds are matched by it.
    pub name: String,
    /// The frame of its points.
    pub frame: String,
}

/// A robot's cameras and LiDARs and the tree of frames that they hang on.
///
/// The base frame has x forward, y left, z up (REP-103); the robot is at its origin. Everything that
/// the pipeline computes is in the base frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Rig {
    /// Name of the base frame, the root of the tree.
    pub base: String,
    /// The tree, in any order.
    #[serde(default)]
    pub transforms: Vec<Transform>,
    /// The cameras. The first is the one that detections are made on, unless another is named.
    pub cameras: Vec<Camera>,
    /// The LiDARs.
    pub lidars: Vec<Lidar>,
}

impl Payload for Rig {
    const SCHEMA: &'static str = "jrdb.rig";
    const VERSION: u32 = 2;
}

/// The rotation of a camera frame (x right, y down, z forward) in a base frame (x forward, y left,
/// z up) for a camera that looks straight ahead.
pub const FORWARD_CAMERA: Rotation =
    Rotation::Matrix([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rig_file_names_frames_and_lenses() {
        let text = r#"{
            "base": "base",
            "transforms": [{"parent": "base", "child": "top", "translation_m": [0, 0, 0.3], "rotation": {"rpy_rad": [0, 0, 0.1]}}],
            "cameras": [{"name": "front", "frame": "base", "lens":
                {"model": "pinhole", "width_px": 4, "height_px": 3, "fx": 2, "fy": 2, "cx": 2, "cy": 1.5}}],
            "lidars": [{"name": "top", "frame": "top"}]
        }"#;
        let rig: Rig = serde_json::from_str(text).unwrap();
        assert_eq!(rig.transforms[0].rotation, Rotation::RpyRad([0.0, 0.0, 0.1]));
        let again: Rig = serde_json::from_str(&serde_json::to_string(&rig).unwrap()).unwrap();
        assert_eq!(again, rig);
        let misspelt = text.replace("\"cx\"", "\"c_x\"");
        let error = serde_json::from_str::<Rig>(&misspelt).unwrap_err().to_string();
        assert!(error.contains("unknown field `c_x`"), "{error}");
    }
}
