//! JRDB's official calibration: `cameras.yaml` and `defaults.yaml`, and the rig that they describe.

use std::collections::BTreeMap;
use std::path::Path;

use jrdb_types::rig::FORWARD_CAMERA;
use jrdb_types::{Camera, CylindricalPanorama, LensModel, Lidar, Rig, Rotation, Transform};
use serde::Deserialize;

use crate::number::{Reals, exactly};
use crate::{Error, file, picture_size};

/// The cameras whose medians make the panorama's focal length and horizon.
pub(crate) const PANORAMA_SENSORS: [&str; 5] =
    ["sensor_0", "sensor_2", "sensor_4", "sensor_6", "sensor_8"];

/// LiDARs: name, and key in `defaults.yaml`.
pub(crate) const LIDARS: [(&str, &str); 2] =
    [("upper_velodyne", "lidar_upper_to_rgb"), ("lower_velodyne", "lidar_lower_to_rgb")];

/// Name of the base frame of JRDB's rigs.
pub(crate) const BASE: &str = "base";
/// Name of the panorama, as a camera and as a frame.
pub(crate) const PANORAMA: &str = "panorama";

/// Where a camera's K has f_y and c_y, row by row.
const FOCAL_Y: usize = 4;
const CENTER_Y: usize = 5;

/// What `cameras.yaml` and `defaults.yaml` say by JRDB's official model.
#[derive(Debug, Clone, PartialEq)]
pub struct OfficialCalibration {
    /// The stitched image: a cylinder around the base's origin. Its size is that of `defaults.yaml`; its focal
    /// length and horizon are the medians of K\[1,1\] and K\[1,2\] over the sensors 0, 2, 4, 6 and 8.
    pub panorama: CylindricalPanorama,
    /// Where the LiDARs sit.
    pub lidars: Vec<LidarMount>,
}

/// Where a LiDAR sits, as `defaults.yaml` writes it: `p_base = Rz(yaw) (p_lidar - offset)`.
#[derive(Debug, Clone, PartialEq)]
pub struct LidarMount {
    /// Its name, for example `upper_velodyne`.
    pub name: String,
    /// offset: where the base's origin is in the LiDAR's frame, metres. It is *subtracted*.
    pub offset_m: [f64; 3],
    /// yaw, counter-clockwise from above, radians.
    pub yaw_rad: f64,
}

impl LidarMount {
    /// The same as a transform of the frame of the LiDAR's name: R = Rz(yaw), t = -Rz(yaw) offset.
    fn transform(&self) -> Transform {
        let ([x, y, z], (sin, cos)) = (self.offset_m, self.yaw_rad.sin_cos());
        Transform {
            parent: BASE.into(),
            child: self.name.clone(),
            // Zero is subtracted from, so that it stays 0 and does not become -0.
            translation_m: [0.0 - (cos * x - sin * y), 0.0 - (sin * x + cos * y), 0.0 - z],
            rotation: Rotation::RpyRad([0.0, 0.0, self.yaw_rad]),
        }
    }
}

impl OfficialCalibration {
    /// Reads `cameras.yaml` and `defaults.yaml` of a calibration folder. Of the cameras only K matters.
    ///
    /// # Errors
    /// [`Error::Read`], [`Error::Yaml`], or [`Error::Content`] for missing sensors, wrong counts,
    /// numbers that are not finite, and LiDARs turned about x or y.
    pub fn read(folder: &Path) -> Result<Self, Error> {
        let path = file::named(folder, "cameras.yaml");
        let cameras: CamerasFile = file::read_yaml(&path, "camera calibrations with K")?;
        let focal_px = median(&cameras, FOCAL_Y, &path)?;
        let horizon_px = median(&cameras, CENTER_Y, &path)?;
        if focal_px <= 0.0 {
            return Err(Error::content(&path, "a positive median of K[1,1]", focal_px.to_string()));
        }
        let path = file::named(folder, "defaults.yaml");
        let defaults: DefaultsFile = file::read_yaml(&path, "lidar mounts and an image size")?;
        let ImageEntry { width: width_px, height: height_px } = defaults.image;
        picture_size::check([width_px, height_px], ["image.width", "image.height"], &path)?;
        let lidars = LIDARS
            .iter()
            .map(|(name, key)| mount(name, key, &defaults, &path))
            .collect::<Result<_, _>>()?;
        let panorama = CylindricalPanorama { width_px, height_px, focal_px, horizon_px };
        Ok(Self { panorama, lidars })
    }

    /// The calibration as a rig: base frame `base`, camera `panorama` at its origin, and a frame for each
    /// LiDAR, named as the LiDAR.
    ///
    /// ```
    /// use jrdb_dataset::{LidarMount, OfficialCalibration};
    /// use jrdb_types::CylindricalPanorama;
    ///
    /// let calibration = OfficialCalibration {
    ///     panorama: CylindricalPanorama { width_px: 3760, height_px: 480, focal_px: 482.924, horizon_px: 209.383 },
    ///     lidars: vec![LidarMount { name: "upper_velodyne".into(), offset_m: [0.0, 0.0, -0.33529], yaw_rad: 0.085 }],
    /// };
    /// let upper = &calibration.rig().transforms[1];
    /// assert_eq!((upper.child.as_str(), upper.translation_m), ("upper_velodyne", [0.0, 0.0, 0.33529]));
    /// ```
    #[must_use]
    pub fn rig(&self) -> Rig {
        let panorama = Transform {
            parent: BASE.into(),
            child: PANORAMA.into(),
            translation_m: [0.0; 3],
            rotation: FORWARD_CAMERA,
        };
        self.rig_with(vec![panorama], vec![panorama_camera(LensModel::Cylindrical(self.panorama))])
    }

    /// Other cameras, hung on the base by these transforms, with the official LiDARs.
    pub(crate) fn rig_with(&self, mut transforms: Vec<Transform>, cameras: Vec<Camera>) -> Rig {
        transforms.extend(self.lidars.iter().map(LidarMount::transform));
        let lidar =
            |mount: &LidarMount| Lidar { name: mount.name.clone(), frame: mount.name.clone() };
        Rig {
            base: BASE.into(),
            transforms,
            cameras,
            lidars: self.lidars.iter().map(lidar).collect(),
        }
    }
}

/// The camera `panorama` in the frame of that name.
pub(crate) fn panorama_camera(lens: LensModel) -> Camera {
    Camera { name: PANORAMA.into(), frame: PANORAMA.into(), lens }
}

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_offset_is_subtracted_before_the_turn() {
        let mount = LidarMount {
            name: "top".into(),
            offset_m: [1.0, 0.0, -0.5],
            yaw_rad: std::f64::consts::FRAC_PI_2,
        };
        let Transform { translation_m: [x, y, z], .. } = mount.transform();
        assert!(x.abs() < 1e-15 && (y + 1.0).abs() < 1e-15, "{x} {y}");
        assert_eq!(z, 0.5);
    }
}
