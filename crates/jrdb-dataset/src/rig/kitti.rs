//! KITTI's calibrations: rectified pinholes beside each other, and where the LiDAR is.

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

/// Keys of the numbers that are needed, as the object, tracking, odometry and raw files name them.
const RECTIFICATION: [&str; 4] = ["R0_rect", "R_rect", "R_rect_00", "R_rect_0"];
const VELODYNE_TO_CAMERA: [&str; 3] = ["Tr_velo_to_cam", "Tr_velo_cam", "Tr_velo_to_cam_0"];
/// The odometry file's transform, which goes to the rectified camera.
const VELODYNE_TO_RECTIFIED: &str = "Tr";
/// The raw file beside `calib_cam_to_cam.txt` with R and T from the LiDAR to the camera.
const RAW_VELODYNE: &str = "calib_velo_to_cam.txt";

/// The rig of a KITTI calibration file; the size of the pictures, `[width, height]` in pixels, is not in the file.
///
/// Read are the files of the object benchmark (`training/calib/000000.txt`), of tracking (`R_rect`, `Tr_velo_cam`, with and without
/// colons), of odometry (`Tr`, without a rectification), and raw `calib_cam_to_cam.txt` with `calib_velo_to_cam.txt` beside it.
///
/// The base frame is the LiDAR's, `velodyne`: x forward, y left, z up. The cameras are the rectified `image_2`, `image_3`,
/// `image_0` and `image_1`, as far as the file has their P. With `P = K [1 | b]`, a point in a camera is
/// `R0_rect (R p + t) + b`, where `[R | t]` is `Tr_velo_to_cam`.
///
/// R0_rect and R are printed with few digits: their product is off orthonormal by that much and is replaced by the
/// nearest rotation. With KITTI's seven digits that moves a pixel by less than 1e-3.
///
/// # Errors
/// [`Error::Read`], or [`Error::Content`] for a key that is absent or given twice or has another number of numbers, a P of another
/// form, and a rotation that is off orthonormal by more than 1e-3.
pub fn kitti(calib_file: &Path, image_size_px: [u32; 2]) -> Result<Rig, Error> {
    let text = file::read_text(calib_file)?;
    let file = KittiFile { path: calib_file, lines: lines(&text, calib_file)? };
    let (rotation, translation_m) = file.rectified_from_velodyne()?;
    let (mut transforms, mut cameras) = (Vec::new(), Vec::new());
    for (name, key) in CAMERAS {
        let Some(key) = file.projection_key(key) else { continue };
        let [fx, a, cx, px, b, fy, cy, py, c, d, e, pz] = file.numbers(&key)?;
        let size_px = file.size_px(&key)?.unwrap_or(image_size_px);
        let lens = pinhole([fx, a, cx, b, fy, cy, c, d, e], size_px, &key, calib_file)?;
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
        return Err(file.absent("P0, P1, P2 or P3"));
    }
    let lidars = vec![Lidar { name: VELODYNE.into(), frame: VELODYNE.into() }];
    Ok(Rig { base: VELODYNE.into(), transforms, cameras, lidars })
}

/// The file's lines: key, and the text of the numbers.
struct KittiFile<'a> {
    path: &'a Path,
    lines: BTreeMap<String, Value>,
}

/// Every line is a key, perhaps a colon, and numbers.
fn lines(text: &str, path: &Path) -> Result<BTreeMap<String, Value>, Error> {
    let mut lines = BTreeMap::new();
    for line in text.lines().map(str::trim).filter(|line| !line.is_empty()) {
        let end = line.find([':', ' ', '\t']).unwrap_or(line.len());
        let (key, numbers) = line.split_at(end);
        let numbers = numbers.trim_start_matches([':', ' ', '\t']);
        if lines.insert(key.to_string(), Value::from(numbers)).is_some() {
            return Err(Error::content(path, format!("one line {key}"), "two"));
        }
    }
    Ok(lines)
}

impl KittiFile<'_> {
    fn numbers<const N: usize>(&self, key: &str) -> Result<[f64; N], Error> {
        exactly_in(self.lines.get(key), key, self.path)
    }

    /// The error that none of some keys is there, with those that are.
    fn absent(&self, expected: &str) -> Error {
        let keys: Vec<&str> = self.lines.keys().map(String::as_str).collect();
        let found =
            format!("only {}", if keys.is_empty() { "no keys".into() } else { keys.join(" ") });
        let expected =
            format!("{expected} of a KITTI object, tracking, odometry or raw calibration");
        Error::content(self.path, expected, found)
    }

    fn first_of<'k>(&self, keys: &[&'k str]) -> Option<&'k str> {
        keys.iter().find(|key| self.lines.contains_key(**key)).copied()
    }

    /// The key of a projection: `P2`, or `P_rect_02` of raw files.
    fn projection_key(&self, key: &str) -> Option<String> {
        let raw = key.replace('P', "P_rect_0");
        [key.to_string(), raw].into_iter().find(|key| self.lines.contains_key(key))
    }

    /// The size of rectified pictures, which raw files say.
    fn size_px(&self, projection: &str) -> Result<Option<[u32; 2]>, Error> {
        let key = projection.replace("P_rect", "S_rect");
        if key == projection || !self.lines.contains_key(&key) {
            return Ok(None);
        }
        let size: [f64; 2] = self.numbers(&key)?;
        Ok(Some(size.map(|side| side as u32)))
    }

    /// R and t of `p_rectified = R p_velodyne + t`; R is a rotation.
    fn rectified_from_velodyne(&self) -> Result<(Matrix, Vector), Error> {
        if let Some(key) = self.first_of(&[VELODYNE_TO_RECTIFIED]) {
            let (rotation, translation_m) = self.transform(key)?;
            return Ok((orthonormal(&rotation), translation_m));
        }
        let key = self.first_of(&RECTIFICATION).ok_or_else(|| self.absent("R0_rect or R_rect"))?;
        let rectification = super::matrix::rows(self.numbers(key)?);
        self.check_rotation(&rectification, key)?;
        let (camera_from_velodyne, translation_m) = self.camera_from_velodyne()?;
        let rotation = orthonormal(&product(&rectification, &camera_from_velodyne));
        Ok((rotation, apply(&rectification, &translation_m)))
    }

    /// R and t of a key, or of the raw file beside.
    fn camera_from_velodyne(&self) -> Result<(Matrix, Vector), Error> {
        if let Some(key) = self.first_of(&VELODYNE_TO_CAMERA) {
            return self.transform(key);
        }
        let beside = self.path.with_file_name(RAW_VELODYNE);
        if !beside.is_file() || beside == self.path {
            let expected =
                format!("Tr_velo_to_cam or Tr_velo_cam, or {RAW_VELODYNE} beside the file,");
            return Err(self.absent(&expected));
        }
        let text = file::read_text(&beside)?;
        let raw = KittiFile { path: &beside, lines: lines(&text, &beside)? };
        let rotation = super::matrix::rows(raw.numbers("R")?);
        raw.check_rotation(&rotation, "R")?;
        Ok((rotation, raw.numbers("T")?))
    }

    fn transform(&self, key: &str) -> Result<(Matrix, Vector), Error> {
        let [a, b, c, x, d, e, f, y, g, h, i, z] = self.numbers(key)?;
        let rotation = [[a, b, c], [d, e, f], [g, h, i]];
        self.check_rotation(&rotation, key)?;
        Ok((rotation, [x, y, z]))
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

#[cfg(test)]
mod tests {
    use super::*;

    const OBJECT: &str = "P2: 700 0 600 45 0 700 180 0.2 0 0 1 0.003\nR0_rect: 1 0 0 0 1 0 0 0 1\n\
        Tr_velo_to_cam: 0 -1 0 0 0 0 -1 -0.08 1 0 0 -0.27\n";

    fn read(text: &str) -> Result<Rig, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("calib.txt");
        std::fs::write(&path, text).unwrap();
        kitti(&path, [1242, 375]).map_err(|error| error.to_string())
    }

    #[test]
    fn files_of_all_of_kitti_s_benchmarks_are_read() {
        let object = read(OBJECT).unwrap();
        let tracking = OBJECT.replace("R0_rect", "R_rect").replace("velo_to_cam", "velo_cam");
        assert_eq!(read(&tracking).unwrap(), object);
        assert_eq!(read(&tracking.replace(':', "")).unwrap(), object, "without colons");
        let odometry =
            OBJECT.replace("R0_rect: 1 0 0 0 1 0 0 0 1\n", "").replace("Tr_velo_to_cam", "Tr");
        assert_eq!(read(&odometry).unwrap(), object);
        assert_eq!(read(&format!("\u{feff}{OBJECT}")).unwrap(), object, "with a byte order mark");
    }

    #[test]
    fn raw_files_are_read_together() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("calib_cam_to_cam.txt");
        let raw = "calib_time: 09-Jan-2012 13:57:47\nS_rect_02: 1240 376\n\
            P_rect_02: 700 0 600 45 0 700 180 0.2 0 0 1 0.003\nR_rect_00: 1 0 0 0 1 0 0 0 1\n";
        std::fs::write(&path, raw).unwrap();
        let error = kitti(&path, [1, 1]).unwrap_err().to_string();
        assert!(error.contains("calib_velo_to_cam.txt beside"), "{error}");
        let beside = "R: 0 -1 0 0 0 -1 1 0 0\nT: 0 -0.08 -0.27\n";
        std::fs::write(folder.path().join(RAW_VELODYNE), beside).unwrap();
        let rig = kitti(&path, [1, 1]).unwrap();
        assert_eq!(rig.cameras[0].lens.image().width_px, 1240);
        assert_eq!(rig.transforms, read(OBJECT).unwrap().transforms);
    }

    #[test]
    fn trouble_names_the_keys() {
        let twice = format!("{OBJECT}R0_rect: 1 0 0 0 1 0 0 0 1\n");
        assert!(read(&twice).unwrap_err().starts_with("expected one line R0_rect, found two"));
        let error = read(&OBJECT.replace("R0_rect", "R_0")).unwrap_err();
        assert!(error.contains("found only P2 R_0 Tr_velo_to_cam"), "{error}");
    }
}
