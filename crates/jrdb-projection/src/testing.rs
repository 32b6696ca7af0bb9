//! A rig for unit tests: round numbers, near JRDB's.

use jrdb_types::rig::FORWARD_CAMERA;
use jrdb_types::{Camera, CylindricalPanorama, LensModel, Lidar, Rig, Rotation, Transform};

pub(crate) const PANORAMA: CylindricalPanorama =
    CylindricalPanorama { width_px: 3760, height_px: 480, focal_px: 480.0, horizon_px: 210.0 };

/// One LiDAR, `upper`, and that panorama around the base frame's origin.
pub(crate) fn rig(translation_m: [f64; 3], yaw_rad: f64) -> Rig {
    let place = |child: &str, translation_m, rotation| Transform {
        parent: "base".into(),
        child: child.into(),
        translation_m,
        rotation,
    };
    Rig {
        base: "base".into(),
        transforms: vec![
            place("panorama", [0.0; 3], FORWARD_CAMERA),
            place("upper", translation_m, Rotation::RpyRad([0.0, 0.0, yaw_rad])),
        ],
        cameras: vec![Camera {
            name: "panorama".into(),
            frame: "panorama".into(),
            lens: LensModel::Cylindrical(PANORAMA),
        }],
        lidars: vec![Lidar { name: "upper".into(), frame: "upper".into() }],
    }
}
