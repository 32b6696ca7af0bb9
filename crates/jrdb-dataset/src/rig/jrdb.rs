//! JRDB's rigs beside the official one: the refined panorama, and the five single cameras.

use std::collections::BTreeMap;
use std::path::Path;

use jrdb_types::lens::{DistortionModel, Pinhole, StitchView, StitchedCylindrical};
use jrdb_types::{Camera, LensModel, Rig, Rotation, Transform};
use serde::Deserialize;
use serde_json::Value;

use super::matrix::{self, Vector, apply, negated, transpose};
use super::pinhole::pinhole;
use crate::calibration::{BASE, OfficialCalibration, PANORAMA, PANORAMA_SENSORS, panorama_camera};
use crate::number::exactly_in;
use crate::{Error, file};

/// ρ0, the radius of the cylinder on which JRDB's pictures were stitched, metres.
const RADIUS_M: f64 = 1.7143;
/// F, rows per unit slope, pixels.
const FOCAL_PX: f64 = 514.24;
/// c, the row of the horizon, pixels.
const HORIZON_PX: f64 = 199.431;
/// u0, how far the forward column is from the middle, pixels.
const COLUMN_OFFSET_PX: f64 = -1.059;
/// How far the cylinder's centre is above the base's origin, metres.
const HEIGHT_M: f64 = 0.095;
/// How far the cameras are turned in the base frame, counter-clockwise from above, radians.
///
/// Measured twice: the reflectance of both sweeps agrees best with the brightness of the picture at -0.005 to -0.01, and
/// the labelled people of 288 frames are drawn in the middle of their boxes at -0.005 (6 px beside it at +0.005).
const YAW_RAD: f64 = -0.005;

/// The cameras whose pictures were stitched: the upper ring, in the order of `cameras.yaml`.
const STITCHED_SENSORS: [&str; 5] = ["sensor_0", "sensor_1", "sensor_2", "sensor_3", "sensor_4"];

const MM_PER_M: f64 = 1000.0;

#[derive(Deserialize)]
struct ViewsFile {
    cameras: BTreeMap<String, Value>,
}

#[derive(Deserialize)]
struct SizesFile {
    cameras: BTreeMap<String, Size>,
}

#[derive(Deserialize)]
struct Size {
    width: u32,
    height: u32,
}

/// JRDB's rig with a refined model of the panorama, from `cameras.yaml` and `defaults.yaml` of a calibration folder.
///
/// The stitched image is not what one camera would see, as the official model has it, but five pictures that were put
/// on a cylinder of finite radius ([`StitchedCylindrical`]). The views are `sensor_0` to `sensor_4` of `cameras.yaml`,
/// by its R and T (`x_camera = R x_rig + T`, T in millimetres). The panorama's frame sits 0.095 m above the base and is
/// turned by 0.005 rad to the right. The LiDARs are those of the official model.
///
/// **To be asked for, not the default:** the cylinder's radius, focal length, horizon and offset, and the frame's height
/// and yaw, are a fit to one frame of bytes-cafe-2019-02-07_0, where it is right to 0.3 px in the median. Check it
/// on the sequence at hand.
///
/// # Errors
/// Those of [`OfficialCalibration::read`], and [`Error::Content`] for a view without 9 finite numbers as R or 3 as T.
pub fn jrdb_refined(calibration_folder: &Path) -> Result<Rig, Error> {
    let official = OfficialCalibration::read(calibration_folder)?;
    let path = file::named(calibration_folder, "cameras.yaml");
    let file: ViewsFile = file::read_yaml(&path, "camera calibrations")?;
    let lens = StitchedCylindrical {
        width_px: official.panorama.width_px,
        height_px: official.panorama.height_px,
        radius_m: RADIUS_M,
        focal_px: FOCAL_PX,
        horizon_px: HORIZON_PX,
        column_offset_px: COLUMN_OFFSET_PX,
        views: STITCHED_SENSORS
            .iter()
            .map(|sensor| view(sensor, &file, &path))
            .collect::<Result<_, _>>()?,
    };
    let (sin, cos) = YAW_RAD.sin_cos();
    let panorama = Transform {
        parent: BASE.into(),
        child: PANORAMA.into(),
        translation_m: [0.0, 0.0, HEIGHT_M],
        // Right, down and forward of the turned camera, as columns.
        rotation: Rotation::Matrix([[sin, 0.0, cos], [-cos, 0.0, sin], [0.0, -1.0, 0.0]]),
    };
    let camera = panorama_camera(LensModel::StitchedCylindrical(lens));
    Ok(official.rig_with(vec![panorama], vec![camera]))
}

/// Where a camera looks and sits in the frame of the rig.
fn view(sensor: &str, file: &ViewsFile, path: &Path) -> Result<StitchView, Error> {
    let key = format!("cameras.{sensor}");
    let entry = find(sensor, &file.cameras, &key, path)?;
    let r = matrix::rows(exactly_in(entry.get("R"), &format!("{key}.R"), path)?);
    let t_mm: Vector = exactly_in(entry.get("T"), &format!("{key}.T"), path)?;
    let rig_from_camera = transpose(&r);
    let [x, _, z] = apply(&rig_from_camera, &[0.0, 0.0, 1.0]);
    let center_m = negated(&apply(&rig_from_camera, &t_mm)).map(|mm| mm / MM_PER_M);
    Ok(StitchView { azimuth_rad: x.atan2(z), center_m })
}

fn find<'a, T>(
    sensor: &str,
    sensors: &'a BTreeMap<String, T>,
    key: &str,
    path: &Path,
) -> Result<&'a T, Error> {
    sensors.get(sensor).ok_or_else(|| Error::content(path, key, "no such camera"))
}

/// JRDB's five single cameras as distorted pinholes, from `lidars.yaml`, `cameras.yaml` and `defaults.yaml` of a calibration
/// folder.
///
/// The cameras are `image_0`, `image_2`, `image_4`, `image_6` and `image_8`, each with D, `distorted_img_K` and `cam2ego` of
/// the sensor of its number in `lidars.yaml`, and the size that `cameras.yaml` gives for that sensor. The LiDARs are those of
/// the official model.
///
/// This is JRDB's own pairing of pictures and sensors. The pictures themselves say that `image_2k` was taken by `sensor_k`;
/// `lidars.yaml` makes up for it by yaws and heights adjusted by hand. Expect an error of a few pixels.
///
/// # Errors
/// Those of [`OfficialCalibration::read`], and [`Error::Content`] for a sensor that is absent or whose numbers are too few, too
/// many or not finite, and for a K or `cam2ego` of another form.
pub fn jrdb_cameras(calibration_folder: &Path) -> Result<Rig, Error> {
    let official = OfficialCalibration::read(calibration_folder)?;
    let sizes_path = file::named(calibration_folder, "cameras.yaml");
    let sizes: SizesFile = file::read_yaml(&sizes_path, "cameras with width and height")?;
    let path = file::named(calibration_folder, "lidars.yaml");
    let sensors: BTreeMap<String, Value> = file::read_yaml(&path, "sensors with D and cam2ego")?;
    let (mut transforms, mut cameras) = (Vec::new(), Vec::new());
    for sensor in PANORAMA_SENSORS {
        let size = find(sensor, &sizes.cameras, &format!("cameras.{sensor}"), &sizes_path)?;
        let values = find(sensor, &sensors, sensor, &path)?;
        let name = sensor.replace("sensor", "image");
        transforms.push(transform(&name, values, sensor, &path)?);
        let lens = lens([size.width, size.height], values, sensor, &path)?;
        cameras.push(Camera { frame: name.clone(), name, lens: LensModel::Pinhole(lens) });
    }
    Ok(official.rig_with(transforms, cameras))
}

/// Where a camera is: `cam2ego`, a 4 x 4 matrix `[R t; 0 1]` in metres.
fn transform(name: &str, values: &Value, sensor: &str, path: &Path) -> Result<Transform, Error> {
    let key = format!("{sensor}.cam2ego");
    let [a, b, c, x, d, e, f, y, g, h, i, z, bottom @ ..]: [f64; 16] =
        exactly_in(values.get("cam2ego"), &key, path)?;
    if bottom != [0.0, 0.0, 0.0, 1.0] {
        let expected = format!("0 0 0 1 as last row of {key}");
        return Err(Error::content(path, expected, format!("{bottom:?}")));
    }
    Ok(Transform {
        parent: BASE.into(),
        child: name.into(),
        translation_m: [x, y, z],
        rotation: Rotation::Matrix([[a, b, c], [d, e, f], [g, h, i]]),
    })
}

fn lens(size_px: [u32; 2], values: &Value, sensor: &str, path: &Path) -> Result<Pinhole, Error> {
    let key = format!("{sensor}.distorted_img_K");
    let k = exactly_in(values.get("distorted_img_K"), &key, path)?;
    let d: [f64; 5] = exactly_in(values.get("D"), &format!("{sensor}.D"), path)?;
    let [k1, k2, p1, p2, k3] = d;
    let distortion = DistortionModel::BrownConrady { k1, k2, p1, p2, k3 };
    Ok(Pinhole { distortion, ..pinhole(k, size_px, &key, path)? })
}
