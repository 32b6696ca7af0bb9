//! Camera calibrations of other programs: ROS's `camera_info`, Kalibr's camchain, OpenCV's `FileStorage`.

use std::path::Path;

use jrdb_types::lens::{DistortionModel, KannalaBrandt, Pinhole};
use jrdb_types::rig::FORWARD_CAMERA;
use jrdb_types::{Camera, LensModel, Rig, Transform};
use serde::Deserialize;
use serde_json::Value;

use super::pinhole::pinhole;
use crate::number::{Reals, exactly_in};
use crate::{Error, file};

/// Name of the base frame of a rig that is made of a lens alone.
const BASE: &str = "base";

/// A rig with one or more cameras whose places are not in the file.
#[derive(Debug, Clone, PartialEq)]
pub struct ForeignCamera {
    /// The rig: every camera at the base's origin, looking ahead, and no LiDAR.
    pub rig: Rig,
    /// What the user must add, in words.
    pub missing: String,
}

/// What a file is, if it is a camera calibration of another program.
pub(super) fn kind(value: &Value) -> Option<&'static str> {
    let has = |key: &str| value.get(key).is_some();
    let of_camera = |key: &str| value.get("cam0").is_some_and(|camera| camera.get(key).is_some());
    if of_camera("intrinsics") {
        Some("a Kalibr camchain: jrdb rig camera PATH reads its lenses")
    } else if has("camera_matrix") && has("distortion_model") {
        Some("a ROS camera_info: jrdb rig camera PATH reads its lens")
    } else if (has("K") || has("k")) && has("distortion_model") {
        Some("a ROS camera_info message: jrdb rig camera PATH reads its lens")
    } else if matrix(value).is_some() {
        Some("an OpenCV calibration: jrdb rig camera PATH reads its lens")
    } else {
        None
    }
}

/// The cameras of a ROS `camera_info` (a file or an echoed message), a Kalibr camchain or an OpenCV calibration.
///
/// The lens is that of `camera_matrix` (or `K`), `distortion_coefficients` (or `D`) and the distortion model: `plumb_bob`, `radtan` and
/// `rational_polynomial` are a distorted pinhole, `equidistant` and `fisheye` a fisheye. None of the files says where the camera is on the
/// robot.
///
/// # Errors
/// [`Error::Read`], [`Error::Yaml`], or [`Error::Content`] for a file without a camera matrix, another lens model, and numbers that are
/// too few, too many or not finite.
pub fn camera_file(path: &Path) -> Result<ForeignCamera, Error> {
    let value: Value = file::read_yaml(path, "a camera calibration")?;
    let chain = (0..).map_while(|index| {
        let name = format!("cam{index}");
        value.get(&name).map(|camera| (name, camera))
    });
    let chain: Vec<(String, &Value)> = chain.collect();
    let cameras = if chain.is_empty() {
        let name = ["camera_name", "name"].iter().find_map(|key| value.get(*key)?.as_str());
        vec![(name.unwrap_or("camera").to_string(), lens(&value, path)?)]
    } else {
        let one = |(name, camera): (String, &Value)| Ok((name, kalibr_lens(camera, path)?));
        chain.into_iter().map(one).collect::<Result<_, Error>>()?
    };
    let missing = "the file does not say where the cameras and LiDARs are: every camera was put at the base's \
                   origin, looking ahead; write the real places under `transforms` and the LiDARs under `lidars`";
    let transform = |(name, _): &(String, LensModel)| Transform {
        parent: BASE.into(),
        child: name.clone(),
        translation_m: [0.0; 3],
        rotation: FORWARD_CAMERA,
    };
    let rig = Rig {
        base: BASE.into(),
        transforms: cameras.iter().map(transform).collect(),
        cameras: cameras
            .into_iter()
            .map(|(name, lens)| Camera { frame: name.clone(), name, lens })
            .collect(),
        lidars: Vec::new(),
    };
    Ok(ForeignCamera { rig, missing: missing.into() })
}

/// Keys of a camera matrix, as ROS and OpenCV programs write them.
const MATRICES: [&str; 5] = ["camera_matrix", "Camera_Matrix", "cameraMatrix", "K", "k"];
/// Keys of distortion coefficients.
const DISTORTIONS: [&str; 7] = [
    "distortion_coefficients",
    "Distortion_Coefficients",
    "distCoeffs",
    "dist_coeffs",
    "distortion",
    "D",
    "d",
];
const WIDTHS: [&str; 4] = ["image_width", "width", "image_Width", "imageWidth"];
const HEIGHTS: [&str; 4] = ["image_height", "height", "image_Height", "imageHeight"];

/// The first of some keys, with its value.
fn first<'v>(value: &'v Value, keys: &[&'static str]) -> Option<(&'static str, &'v Value)> {
    keys.iter().find_map(|key| Some((*key, value.get(*key)?)))
}

/// The numbers of a matrix: a list, or `data` of an object with rows and columns.
fn matrix(value: &Value) -> Option<(&'static str, &Value)> {
    let (key, found) = first(value, &MATRICES)?;
    let data = found.get("data").unwrap_or(found);
    data.is_array().then_some((key, data))
}

fn lens(value: &Value, path: &Path) -> Result<LensModel, Error> {
    let (key, k) = matrix(value).ok_or_else(|| {
        let keys = value.as_object().into_iter().flatten().map(|(key, _)| key.as_str());
        let keys: Vec<&str> = keys.collect();
        let expected =
            "camera_matrix or K of a ROS camera_info or an OpenCV calibration, or cam0 of Kalibr";
        Error::content(path, expected, format!("only the keys {}", keys.join(" ")))
    })?;
    let k: [f64; 9] = exactly_in(Some(k), key, path)?;
    let side = |keys: &[&'static str]| {
        let found = first(value, keys).and_then(|(_, side)| side.as_u64());
        let side = found.and_then(|side| u32::try_from(side).ok());
        side.ok_or_else(|| {
            Error::content(path, format!("the picture's size as {}", keys[0]), "none")
        })
    };
    let size_px = [side(&WIDTHS)?, side(&HEIGHTS)?];
    let pinhole = pinhole(k, size_px, key, path)?;
    let coefficients = coefficients(first(value, &DISTORTIONS), path)?;
    let model =
        ["distortion_model", "camera_model"].iter().find_map(|key| value.get(*key)?.as_str());
    distorted(pinhole, model.unwrap_or_default(), &coefficients, path)
}

fn kalibr_lens(camera: &Value, path: &Path) -> Result<LensModel, Error> {
    let model = camera.get("camera_model").and_then(Value::as_str).unwrap_or("pinhole");
    if model != "pinhole" {
        return Err(Error::content(path, "camera_model pinhole", format!("{model:?}")));
    }
    let [fx, fy, cx, cy]: [f64; 4] = exactly_in(camera.get("intrinsics"), "intrinsics", path)?;
    let size: [f64; 2] = exactly_in(camera.get("resolution"), "resolution", path)?;
    let k = [fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0];
    let pinhole = pinhole(k, size.map(|side| side as u32), "intrinsics", path)?;
    let given = camera.get("distortion_coeffs").map(|value| ("distortion_coeffs", value));
    let coefficients = coefficients(given, path)?;
    let model = camera.get("distortion_model").and_then(Value::as_str).unwrap_or_default();
    distorted(pinhole, model, &coefficients, path)
}

/// Distortion coefficients without the zeros of models that are not used: OpenCV writes up to 14.
fn coefficients(given: Option<(&'static str, &Value)>, path: &Path) -> Result<Vec<f64>, Error> {
    const LENGTHS: [usize; 4] = [0, 4, 5, 8];
    let Some((key, value)) = given else { return Ok(Vec::new()) };
    let data = value.get("data").unwrap_or(value);
    let numbers = Reals::deserialize(data).map(|reals| reals.0).unwrap_or_default();
    let used = numbers.iter().rposition(|number| *number != 0.0).map_or(0, |last| last + 1);
    let length = LENGTHS.into_iter().find(|length| *length >= used);
    match length {
        Some(length) if numbers.iter().all(|number| number.is_finite()) => {
            Ok((0..length).map(|index| numbers.get(index).copied().unwrap_or(0.0)).collect())
        }
        _ => {
            let expected = format!("up to 8 finite distortion coefficients as {key}");
            Err(Error::content(path, expected, value.to_string()))
        }
    }
}

fn distorted(
    lens: Pinhole,
    model: &str,
    coefficients: &[f64],
    path: &Path,
) -> Result<LensModel, Error> {
    match model {
        "equidistant" | "fisheye" | "kannala_brandt" => {
            let mut k = [0.0; 4];
            if coefficients.len() > k.len() {
                let found = format!("{}", coefficients.len());
                return Err(Error::content(path, "4 coefficients of a fisheye", found));
            }
            k.iter_mut().zip(coefficients).for_each(|(k, number)| *k = *number);
            let Pinhole { width_px, height_px, fx, fy, cx, cy, .. } = lens;
            let fisheye = KannalaBrandt { width_px, height_px, fx, fy, cx, cy, k };
            Ok(LensModel::KannalaBrandt(fisheye))
        }
        ""
        | "none"
        | "pinhole"
        | "plumb_bob"
        | "radtan"
        | "rational_polynomial"
        | "radial-tangential" => {
            let distortion = DistortionModel::from_opencv(coefficients).map_err(|error| {
                Error::content(path, "distortion coefficients of OpenCV", error.to_string())
            })?;
            Ok(LensModel::Pinhole(Pinhole { distortion, ..lens }))
        }
        _ => {
            let expected = "distortion_model plumb_bob, rational_polynomial, radtan or equidistant";
            Err(Error::content(path, expected, format!("{model:?}")))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<ForeignCamera, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("camera.yaml");
        std::fs::write(&path, text).unwrap();
        camera_file(&path).map_err(|error| error.to_string())
    }

    const ROS: &str = "image_width: 1280\nimage_height: 720\ncamera_name: front\ncamera_matrix:\n  rows: 3\n  cols: 3\n  \
        data: [700, 0, 640, 0, 710, 360, 0, 0, 1]\ndistortion_model: plumb_bob\ndistortion_coefficients:\n  rows: 1\n  \
        cols: 5\n  data: [-0.1, 0.01, 0.001, 0.002, 0]\n";

    #[test]
    fn a_camera_info_is_a_lens() {
        let found = read(ROS).unwrap();
        let LensModel::Pinhole(lens) = &found.rig.cameras[0].lens else { panic!("{found:?}") };
        assert_eq!((found.rig.cameras[0].name.as_str(), lens.fy, lens.cx), ("front", 710.0, 640.0));
        let DistortionModel::BrownConrady { k1, p2, .. } = lens.distortion else {
            panic!("{lens:?}")
        };
        assert_eq!((k1, p2), (-0.1, 0.002));
        assert!(found.missing.contains("does not say where"), "{}", found.missing);
        let message = "height: 720\nwidth: 1280\ndistortion_model: equidistant\nD: [0.1, 0.2, 0, 0]\nK: [700, 0, 640, 0, 700, 360, 0, 0, 1]\n";
        assert!(matches!(read(message).unwrap().rig.cameras[0].lens, LensModel::KannalaBrandt(_)));
    }

    #[test]
    fn opencv_s_and_kalibr_s_files_are_lenses() {
        let opencv = "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\nCamera_Matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   \
            dt: d\n   data: [ 500., 0., 320., 0., 500., 240., 0., 0., 1. ]\ndistortion_coefficients: !!opencv-matrix\n   rows: 5\n   \
            cols: 1\n   dt: d\n   data: [ 0.1, 0., 0., 0., 0. ]\n";
        assert_eq!(read(opencv).unwrap().rig.cameras[0].lens.image().width_px, 640);
        let kalibr = "cam0:\n  camera_model: pinhole\n  distortion_coeffs: [0.1, 0.0, 0.0, 0.0]\n  distortion_model: radtan\n  \
            intrinsics: [500, 500, 320, 240]\n  resolution: [640, 480]\ncam1:\n  camera_model: omni\n";
        let error = read(kalibr).unwrap_err();
        assert!(error.contains("camera_model pinhole"), "{error}");
        let found = read(kalibr.split("cam1").next().unwrap()).unwrap();
        assert_eq!(found.rig.cameras[0].name, "cam0");
    }

    #[test]
    fn trouble_names_the_keys() {
        assert!(read("focal: 3\n").unwrap_err().contains("only the keys focal"));
        let error = read(&ROS.replace("plumb_bob", "thin_prism")).unwrap_err();
        assert!(error.contains("found \"thin_prism\""), "{error}");
        let kind = kind(&serde_json::json!({"camera_matrix": {}, "distortion_model": "plumb_bob"}));
        assert!(kind.unwrap().contains("camera_info"));
    }
}
