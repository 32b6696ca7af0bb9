//! The robot in the scenes: JRDB's sensors, with the numbers of its official model.

use jrdb_dataset::{LidarMount, OfficialCalibration};
use jrdb_projection::Sensors;
use jrdb_projection::camera::PosedCamera;
use jrdb_types::CylindricalPanorama;

/// The camera of the scenes.
pub(super) type Panorama = PosedCamera<CylindricalPanorama>;

/// The calibration of the scenes.
#[must_use]
pub fn calibration() -> OfficialCalibration {
    let mount = |name: &str, up_m: f64, yaw_rad: f64| LidarMount {
        name: name.into(),
        offset_m: [0.0, 0.0, up_m],
        yaw_rad,
    };
    OfficialCalibration {
        panorama: CylindricalPanorama {
            width_px: 3760,
            height_px: 480,
            focal_px: 482.924,
            horizon_px: 209.383,
        },
        lidars: vec![
            mount("upper_velodyne", -0.33529, 0.085),
            mount("lower_velodyne", 0.13511, 0.0),
        ],
    }
}

/// The panorama around the base frame's origin.
pub(super) fn panorama() -> Panorama {
    PosedCamera::ahead(calibration().panorama)
}

/// The sensors in the base frame.
pub(super) fn sensors() -> Sensors {
    Sensors::new(&calibration().rig(), None).expect("the scenes' own rig is sound")
}
