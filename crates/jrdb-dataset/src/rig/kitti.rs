//! KITTI's object calibration: rectified pinholes beside each other, and where the LiDAR is.

use std::collections::BTreeMap;
use std::path::Path;

use jrdb_types::{Camera, LensModel, Lidar, Rig, Rotation, Transform};
use serde_json::Value;

use super::matrix::{
    Matrix, Vector, add, apply, deviation, negated, orthonormal, product, transpose,
};
use super::pinhole::pinhole;
use crate::number::exactly_in;
use crate::{Error, file};

/// The cameras and their keys. The left colour camera, on whose pictures the labels are, is the first.
const CAMERAS: [(&str, &str); 4] =
    [("image_2", "P2"), ("image_3", "P3"), ("image_0", "P0"), ("image_1", "P1")];

/// Name of the LiDAR and of the base frame, which are the same.
const VELODYNE: &str = "velodyne";

/// Largest accepted entry of `|R Rᵀ - 1|`: a rotation printed with three digits.
const MAX_DEVIATION: f64 = 1e-3;

/// The rig of a KITTI object calibration file (`training/calib/000000.txt`); the size of the pictures, `[width, height]` in
/// pixels, is not in the file.
///
/// The base frame is the LiDAR's, `velodyne`: x forward, y left, z up. The cameras are the rectified `image_2`, `image_3`,
/// `image_0` and `image_1`, as far as the file has their P. With `P = K [1 | b]`, a point in a camera is
/// `R0_rect (R p + t) + b`, where `[R | t]` is `Tr_velo_to_cam`.
///
/// R0_rect and R are printed with few digits: their product is off orthonormal by that much and is replaced by the
/// nearest rotation. With KITTI's seven digits that moves a pixel by less than 1e-3.
///
/// # Errors
/// [`Error::Read`], or [`Error::Content`] for a key that is absent or has another number of numbers, a P of another form, and
/// a rotation that is off orthonormal by more than 1e-3.
pub fn kitti(calib_file: &Path, image_size_px: [u32; 2]) -> Result<Rig, Error> {
    let text = file::read_text(calib_file)?;
    let file = KittiFile { path: calib_file, lines: lines(&text) };
    let (rotation, translation_m) = file.rectified_from_velodyne()?;
    let (mut transforms, mut cameras) = (Vec::new(), Vec::new());
    for (name, key) in CAMERAS.into_iter().filter(|(_, key)| file.lines.contains_key(key)) {
        let [fx, a, cx, px, b, fy, cy, py, c, d, e, pz] = file.numbers(key)?;
        let lens = pinhole([fx, a, cx, b, fy, cy, c, d, e], image_size_px, key, calib_file)?;
        let baseline_m = [(px - cx * pz) / fx, (py - cy * pz) / fy, pz];
        let velodyne_from_camera = transpose(&rotation);
        let in_camera = add(&translation_m, &baseline_m);
        transforms.push(Transform {
            parent: VELODYNE.into(),
            child: name.into(),
            translation_m: negated(&apply(&velodyne_from_camera, &in_camera)),
            rotation: Rotation::Matrix(velodyne_from_camera),
        });
        let lens = LensModel::Pinhole(lens);
        cameras.push(Camera { name: name.into(), frame: name.into(), lens });
    }
    if cameras.is_empty() {
        return Err(Error::content(calib_file, "P0, P1, P2 or P3", "none of them"));
    }
    let lidars = vec![Lidar { name: VELODYNE.into(), frame: VELODYNE.into() }];
    Ok(Rig { base: VELODYNE.into(), transforms, cameras, lidars })
}

/// The file's lines: key, and the text of the numbers.
struct KittiFile<'a> {
    path: &'a Path,
    lines: BTreeMap<&'a str, Value>,
}

fn lines(text: &str) -> BTreeMap<&str, Value> {
    let named = text.lines().filter_map(|line| line.split_once(':'));
    named.map(|(key, numbers)| (key.trim(), numbers.into())).collect()
}

impl KittiFile<'_> {
    fn numbers<const N: usize>(&self, key: &str) -> Result<[f64; N], Error> {
        exactly_in(self.lines.get(key), key, self.path)
    }

    /// R and t of `p_rectified = R p_velodyne + t`; R is a rotation.
    fn rectified_from_velodyne(&self) -> Result<(Matrix, Vector), Error> {
        let rectification = super::matrix::rows(self.numbers("R0_rect")?);
        let [a, b, c, x, d, e, f, y, g, h, i, z] = self.numbers("Tr_velo_to_cam")?;
        let camera_from_velodyne = [[a, b, c], [d, e, f], [g, h, i]];
        self.check_rotation(&rectification, "R0_rect")?;
        self.check_rotation(&camera_from_velodyne, "Tr_velo_to_cam")?;
        let rotation = orthonormal(&product(&rectification, &camera_from_velodyne));
        Ok((rotation, apply(&rectification, &[x, y, z])))
    }

    fn check_rotation(&self, rotation: &Matrix, key: &str) -> Result<(), Error> {
        let deviation = deviation(rotation);
        if deviation <= MAX_DEVIATION {
            return Ok(());
        }
        let expected = format!("a rotation in {key}, orthonormal to {MAX_DEVIATION:.0e}");
        Err(Error::content(self.path, expected, format!("one that is off by {deviation:.1e}")))
    }
}
