//! JRDB's calibration files to a rig, by the official panorama model.

use std::collections::BTreeMap;
use std::path::Path;

use jrdb_types::{CylindricalPanorama, LidarMount, Rig};
use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::number::Reals;
use crate::{Error, file};

/// The cameras whose medians make the panorama's focal length and horizon.
pub(crate) const PANORAMA_SENSORS: [&str; 5] =
    ["sensor_0", "sensor_2", "sensor_4", "sensor_6", "sensor_8"];

/// LiDARs: name, and key in `defaults.yaml`.
pub(crate) const LIDARS: [(&str, &str); 2] =
    [("upper_velodyne", "lidar_upper_to_rgb"), ("lower_velodyne", "lidar_lower_to_rgb")];

/// Where a camera's K has f_y and c_y, row by row.
const FOCAL_Y: usize = 4;
const CENTER_Y: usize = 5;

#[derive(Deserialize)]
struct CamerasFile {
    cameras: BTreeMap<String, CameraEntry>,
}

#[derive(Deserialize)]
struct CameraEntry {
    #[serde(rename = "K")]
    k: Reals,
}

#[derive(Deserialize)]
struct DefaultsFile {
    calibrated: BTreeMap<String, LidarEntry>,
    image: ImageEntry,
}

#[derive(Deserialize)]
struct LidarEntry {
    translation: Reals,
    rotation: Reals,
}

#[derive(Deserialize)]
struct ImageEntry {
    width: u32,
    height: u32,
}

/// Reads `cameras.yaml` and `defaults.yaml` of a calibration folder.
pub(crate) fn read_rig(folder: &Path) -> Result<Rig, Error> {
    let path = folder.join("cameras.yaml");
    let cameras: CamerasFile = read_yaml(&path, "camera calibrations with K")?;
    let focal_px = median(&cameras, FOCAL_Y, &path)?;
    let horizon_px = median(&cameras, CENTER_Y, &path)?;
    if focal_px <= 0.0 {
        return Err(Error::content(&path, "a positive median of K[1,1]", focal_px.to_string()));
    }
    let path = folder.join("defaults.yaml");
    let defaults: DefaultsFile = read_yaml(&path, "lidar mounts and an image size")?;
    let ImageEntry { width: width_px, height: height_px } = defaults.image;
    if width_px == 0 || height_px == 0 {
        let found = format!("{width_px} x {height_px}");
        return Err(Error::content(&path, "an image with pixels", found));
    }
    let lidars = LIDARS
        .iter()
        .map(|(name, key)| mount(name, key, &defaults, &path))
        .collect::<Result<_, _>>()?;
    Ok(Rig { panorama: CylindricalPanorama { width_px, height_px, focal_px, horizon_px }, lidars })
}

fn read_yaml<T: DeserializeOwned>(path: &Path, expected: &'static str) -> Result<T, Error> {
    serde_saphyr::from_str(&file::read_text(path)?).map_err(|source| Error::Yaml {
        expected,
        path: path.into(),
        source: Box::new(source),
    })
}

/// Median over the panorama's cameras of one number of K.
fn median(cameras: &CamerasFile, index: usize, path: &Path) -> Result<f64, Error> {
    let value = |sensor: &str| {
        let Some(camera) = cameras.cameras.get(sensor) else {
            return Err(Error::content(path, format!("cameras.{sensor}"), "no such camera"));
        };
        let k: [f64; 9] = exactly(&camera.k, &format!("cameras.{sensor}.K"), path)?;
        Ok(k[index])
    };
    let mut values = PANORAMA_SENSORS.map(value).into_iter().collect::<Result<Vec<_>, _>>()?;
    values.sort_by(f64::total_cmp);
    Ok(values[values.len() / 2])
}

fn mount(name: &str, key: &str, file: &DefaultsFile, path: &Path) -> Result<LidarMount, Error> {
    let Some(entry) = file.calibrated.get(key) else {
        return Err(Error::content(path, format!("calibrated.{key}"), "no such lidar"));
    };
    let offset_m = exactly(&entry.translation, &format!("calibrated.{key}.translation"), path)?;
    let rotation: [f64; 3] = exactly(&entry.rotation, &format!("calibrated.{key}.rotation"), path)?;
    let [0.0, 0.0, yaw_rad] = rotation else {
        let expected = format!("calibrated.{key}.rotation about z only");
        return Err(Error::content(path, expected, format!("{rotation:?}")));
    };
    Ok(LidarMount { name: name.into(), offset_m, yaw_rad })
}

fn exactly<const N: usize>(reals: &Reals, key: &str, path: &Path) -> Result<[f64; N], Error> {
    let numbers = reals.0.as_slice();
    <[f64; N]>::try_from(numbers)
        .ok()
        .filter(|numbers| numbers.iter().all(|n| n.is_finite()))
        .ok_or_else(|| {
            let expected = format!("{N} finite numbers as {key}");
            Error::content(path, expected, format!("{numbers:?}"))
        })
}
