//! A calibration as JRDB's `cameras.yaml` and `defaults.yaml`.

use std::fmt::Write;

use crate::calibration::{LIDARS, OfficialCalibration, PANORAMA_SENSORS};

/// Azimuths of the panorama's cameras, degrees clockwise from straight ahead: a ring of five.
const AZIMUTHS_DEG: [f64; 5] = [0.0, 144.0, -72.0, 72.0, -144.0];

/// Size of a single camera's picture, pixels.
const CAMERA_WIDTH_PX: u32 = 752;
const CAMERA_HEIGHT_PX: u32 = 480;

/// `cameras.yaml`: five ideal pinholes in a ring. All have the panorama's f and c, so that the medians
/// of the official model are exactly these.
pub(super) fn cameras(calibration: &OfficialCalibration) -> String {
    let mut text = String::from(
        "stitching:\n  radius: 3360000\n  rotation: 0\n  scalewidth: 1831\n  crop: 1\ncameras:\n",
    );
    let (focal, horizon) = (calibration.panorama.focal_px, calibration.panorama.horizon_px);
    for (sensor, azimuth_deg) in PANORAMA_SENSORS.iter().zip(AZIMUTHS_DEG) {
        let (sin, cos) = azimuth_deg.to_radians().sin_cos();
        let center = CAMERA_WIDTH_PX / 2;
        write!(
            text,
            "  {sensor}:\n    width: {CAMERA_WIDTH_PX}\n    height: {CAMERA_HEIGHT_PX}\n    \
             D: 0 0 0 0 0\n    \
             K: >\n      {focal} 0 {center}\n      0 {focal} {horizon}\n      0 0 1\n    \
             R: >\n      {cos:.6} 0 {:.6}\n      0 1 0\n      {sin:.6} 0 {cos:.6}\n    \
             T: 0 0 0\n",
            -sin,
        )
        .expect("writing to memory does not fail");
    }
    text
}

/// `defaults.yaml`: where the LiDARs sit, and the panorama's size.
pub(super) fn defaults(calibration: &OfficialCalibration) -> String {
    let mut text = String::from("calibrated:\n");
    for ((_, key), lidar) in LIDARS.iter().zip(&calibration.lidars) {
        let ([x, y, z], yaw) = (lidar.offset_m, lidar.yaw_rad);
        write!(text, "  {key}:\n    translation: [{x}, {y}, {z}]\n    rotation: [0, 0, {yaw}]\n")
            .expect("writing to memory does not fail");
    }
    let (width, height) = (calibration.panorama.width_px, calibration.panorama.height_px);
    let forward = width / 2;
    write!(
        text,
        "image:\n  width: {width}\n  height: {height}\n  stitched_image_offset: {forward}\n\
         frames:\n  global: base_link\n  rgb360: occam\n"
    )
    .expect("writing to memory does not fail");
    text
}
