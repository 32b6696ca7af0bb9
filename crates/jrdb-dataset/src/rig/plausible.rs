//! Numbers of a rig that are well-formed, but of another unit or order.

use std::path::Path;

use jrdb_types::{LensModel, Rig, Rotation, Transform};

use super::matrix::{Matrix, Vector, transpose};
use crate::Error;

/// Largest angle in radians: a full turn.
const MAX_ANGLE_RAD: f64 = std::f64::consts::TAU;
/// Farthest mount of a sensor, metres.
const MAX_MOUNT_M: f64 = 10.0;
/// Shortest focal length, pixels: with it, half of the sphere is in 30 pixels.
const MIN_FOCAL_PX: f64 = 10.0;
/// Cosine of the largest tilt of a sensor that is mounted upright, and of the least of one that lies on its side.
const UPRIGHT: f64 = 0.87;
const LYING: f64 = 0.5;
/// Quaternions of half a turn about z, which in the other order are hardly a turn at all: the largest real part, and the least last
/// number.
const TURNED_W: f64 = 0.1;
const TURNED_Z: f64 = 0.9;

/// Refuses numbers that can only be of another unit.
///
/// # Errors
/// [`Error::Content`] with the place of the number and the unit that is likely.
pub(crate) fn check(rig: &Rig, path: &Path) -> Result<(), Error> {
    for (index, transform) in rig.transforms.iter().enumerate() {
        let place = format!("data.transforms[{index}] ({})", transform.child);
        check_transform(transform, &place, path)?;
    }
    for (index, camera) in rig.cameras.iter().enumerate() {
        let place = format!("data.cameras[{index}].lens ({})", camera.name);
        check_lens(&camera.lens, &place, path)?;
    }
    Ok(())
}

fn check_transform(transform: &Transform, place: &str, path: &Path) -> Result<(), Error> {
    if let Rotation::RpyRad(angles) = transform.rotation
        && let Some(angle) = angles.iter().find(|angle| angle.abs() > MAX_ANGLE_RAD)
    {
        let expected = format!("angles in radians as rpy_rad of {place}");
        return Err(Error::content(path, expected, format!("{angle}, probably degrees")));
    }
    let far = transform.translation_m.iter().find(|number| number.abs() > MAX_MOUNT_M);
    far.map_or(Ok(()), |number| {
        let expected = format!("at most {MAX_MOUNT_M} metres as translation_m of {place}");
        let unit = if number.abs() >= 50.0 { "millimetres" } else { "centimetres" };
        Err(Error::content(path, expected, format!("{number}, probably {unit}")))
    })
}

fn check_lens(lens: &LensModel, place: &str, path: &Path) -> Result<(), Error> {
    let focal = focal_px(lens);
    let short = focal.iter().find(|(_, pixels)| *pixels > 0.0 && *pixels < MIN_FOCAL_PX);
    short.map_or(Ok(()), |(key, pixels)| {
        let expected =
            format!("a focal length in pixels, {MIN_FOCAL_PX} or more, as {key} of {place}");
        Err(Error::content(
            path,
            expected,
            format!("{pixels}, probably a part of the picture's width"),
        ))
    })
}

/// The focal lengths of a lens by their keys.
fn focal_px(lens: &LensModel) -> Vec<(&'static str, f64)> {
    match lens {
        LensModel::Pinhole(lens) => vec![("fx", lens.fx), ("fy", lens.fy)],
        LensModel::KannalaBrandt(lens) => vec![("fx", lens.fx), ("fy", lens.fy)],
        LensModel::DoubleSphere(lens) => vec![("fx", lens.fx), ("fy", lens.fy)],
        LensModel::Cylindrical(lens) => vec![("focal_px", lens.focal_px)],
        LensModel::StitchedCylindrical(lens) => vec![("focal_px", lens.focal_px)],
        _ => Vec::new(),
    }
}

/// What is odd about a rig and may be meant all the same, each with its place: sensors that lie on their side where another order
/// of a quaternion would put them upright, and optical axes outside of the picture.
#[must_use]
pub fn doubts(rig: &Rig) -> Vec<String> {
    let quaternions = rig.transforms.iter().enumerate().filter_map(|(index, transform)| {
        let Rotation::QuaternionWxyz(q) = transform.rotation else { return None };
        let up: fn(&Matrix) -> f64 = if is_camera(rig, &transform.child) { camera_up } else { lidar_up };
        let place = format!("data.transforms[{index}] ({}): quaternion_wxyz {q:?}", transform.child);
        match q {
            _ if other_order(q, up) => Some(format!(
                "{place} puts the sensor on its side; read as x y z w it would stand upright"
            )),
            [w, .., z] if w.abs() < TURNED_W && z.abs() > TURNED_Z => Some(format!(
                "{place} turns the sensor by about 180 degrees; if it does not look backwards, the order is x y z w"
            )),
            _ => None,
        }
    });
    let axes = rig.cameras.iter().enumerate().filter_map(|(index, camera)| {
        let (key, found, side) = outside(&camera.lens)?;
        let place = format!("data.cameras[{index}].lens ({})", camera.name);
        Some(format!("{place}: {key} is {found}, outside of the picture of {side} px"))
    });
    quaternions.chain(axes).collect()
}

fn is_camera(rig: &Rig, frame: &str) -> bool {
    rig.cameras.iter().any(|camera| camera.frame == frame)
}

/// Cosine between a LiDAR's z axis and up.
fn lidar_up(rotation: &Matrix) -> f64 {
    rotation[2][2]
}

/// Cosine between a camera's y axis, which is down in its picture, and down.
fn camera_up(rotation: &Matrix) -> f64 {
    -rotation[2][1]
}

fn other_order([w, x, y, z]: [f64; 4], up: fn(&Matrix) -> f64) -> bool {
    let as_it_is = up(&rotation([w, x, y, z]));
    // The four numbers in ROS's order: the last is the real part.
    let swapped = up(&rotation([z, w, x, y]));
    as_it_is < LYING && swapped > UPRIGHT
}

/// The rotation of a quaternion, real part first.
fn rotation(q: [f64; 4]) -> Matrix {
    let norm = q.iter().map(|n| n * n).sum::<f64>().sqrt();
    let [w, x, y, z] = q.map(|n| n / norm);
    let column = |v: Vector| {
        let [a, b, c] = v;
        let t = [2.0 * (y * c - z * b), 2.0 * (z * a - x * c), 2.0 * (x * b - y * a)];
        [
            a + w * t[0] + y * t[2] - z * t[1],
            b + w * t[1] + z * t[0] - x * t[2],
            c + w * t[2] + x * t[1] - y * t[0],
        ]
    };
    transpose(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(column))
}

/// The key and the number of an optical axis outside of the picture, and the picture's side.
fn outside(lens: &LensModel) -> Option<(&'static str, f64, u32)> {
    let image = lens.image();
    let [cx, cy] = match lens {
        LensModel::Pinhole(lens) => [lens.cx, lens.cy],
        LensModel::KannalaBrandt(lens) => [lens.cx, lens.cy],
        LensModel::DoubleSphere(lens) => [lens.cx, lens.cy],
        _ => return None,
    };
    let axes = [("cx", cx, image.width_px), ("cy", cy, image.height_px)];
    axes.into_iter().find(|(_, found, side)| !(0.0..=f64::from(*side)).contains(found))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rig(transform: &str, lens: &str) -> Rig {
        let text = format!(
            r#"{{"base": "b", "transforms": [{{"parent": "b", "child": "top", {transform}}}],
            "cameras": [{{"name": "c", "frame": "b", "lens": {{"model": "pinhole", "width_px": 1280, "height_px": 720, {lens}}}}}],
            "lidars": [{{"name": "top", "frame": "top"}}]}}"#
        );
        serde_json::from_str(&text).unwrap()
    }

    const LENS: &str = r#""fx": 700, "fy": 700, "cx": 640, "cy": 360"#;
    const MOUNT: &str = r#""translation_m": [0, 0, 0.3]"#;

    fn error(rig: &Rig) -> String {
        check(rig, Path::new("rig.yaml")).unwrap_err().to_string()
    }

    #[test]
    fn numbers_of_other_units_are_refused_with_their_place() {
        assert!(check(&rig(MOUNT, LENS), Path::new("rig.yaml")).is_ok());
        assert_eq!(
            error(&rig(r#""rotation": {"rpy_rad": [0, 0, 90]}"#, LENS)),
            r#"expected angles in radians as rpy_rad of data.transforms[0] (top), found 90, probably degrees, in "rig.yaml""#
        );
        let far = error(&rig(r#""translation_m": [0, 0, 335]"#, LENS));
        assert!(
            far.contains(
                "translation_m of data.transforms[0] (top), found 335, probably millimetres"
            ),
            "{far}"
        );
        let parts = error(&rig(MOUNT, r#""fx": 0.55, "fy": 0.98, "cx": 0.5, "cy": 0.5"#));
        assert!(parts.contains("as fx of data.cameras[0].lens (c), found 0.55"), "{parts}");
    }

    #[test]
    fn a_quaternion_in_another_order_and_an_axis_outside_are_doubtful() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let mount = |q: [f64; 4]| format!(r#""rotation": {{"quaternion_wxyz": {q:?}}}"#);
        assert_eq!(doubts(&rig(&mount([half, 0.0, 0.0, half]), LENS)), Vec::<String>::new());
        let found = doubts(&rig(&mount([0.0, 0.0, half, half]), LENS));
        assert!(found[0].contains("top") && found[0].contains("x y z w"), "{found:?}");
        let found = doubts(&rig(&mount([0.0, 0.0, 0.04, 0.999]), LENS));
        assert!(found[0].contains("about 180 degrees"), "{found:?}");
        let found = doubts(&rig(MOUNT, &LENS.replace("640", "6400")));
        assert_eq!(
            found,
            ["data.cameras[0].lens (c): cx is 6400, outside of the picture of 1280 px"]
        );
    }
}
