//! A rig for unit tests: round numbers, near JRDB's.

use jrdb_types::rig::{CylindricalPanorama, LidarMount, Rig};

pub(crate) const PANORAMA: CylindricalPanorama =
    CylindricalPanorama { width_px: 3760, height_px: 480, focal_px: 480.0, horizon_px: 210.0 };

/// One LiDAR, `upper`, under that panorama.
pub(crate) fn rig(offset_m: [f64; 3], yaw_rad: f64) -> Rig {
    let mount = LidarMount { name: "upper".into(), offset_m, yaw_rad };
    Rig { panorama: PANORAMA, lidars: vec![mount] }
}
