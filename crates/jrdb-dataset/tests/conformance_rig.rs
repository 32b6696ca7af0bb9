//! Rigs of real calibration files against pixels computed by others, for whoever has the tables; skipped without
//! them.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a failing helper should panic")]
#![allow(clippy::print_stdout, reason = "skipping is visible")]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use jrdb_dataset::{Dataset, rig};
use jrdb_types::lens::{DistortionModel, Pinhole, StitchedCylindrical};
use jrdb_types::{LensModel, Rig, Rotation, Transform};

/// Largest accepted distance from the tables, pixels.
const TOLERANCE_PX: f64 = 1e-3;

/// The folder of research data, unless it is absent.
fn data() -> Option<PathBuf> {
    let default = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared");
    let folder = std::env::var_os("JRDB_SHARED").map_or_else(|| default.into(), PathBuf::from);
    let data = folder.join("data");
    let found = data.join("camera_projection_reference.csv").is_file();
    if !found {
        println!("skipped: no shared data");
    }
    found.then_some(data)
}

/// One row of a table: column name → text.
type Row = BTreeMap<String, String>;

fn rows(path: PathBuf) -> Vec<Row> {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let row = |line: &str| {
        header.iter().zip(line.split(',')).map(|(k, v)| (k.to_string(), v.to_string())).collect()
    };
    let rows: Vec<Row> = lines.map(row).collect();
    assert!(!rows.is_empty(), "a table without rows checks nothing");
    rows
}

fn numbers<const N: usize>(row: &Row, columns: [&str; N]) -> [f64; N] {
    columns.map(|column| row[column].parse().unwrap())
}

fn frame<'a>(rig: &'a Rig, name: &str) -> &'a Transform {
    rig.transforms.iter().find(|transform| transform.child == name).unwrap()
}

/// A rotation that these readers write, as a matrix.
fn matrix(rotation: &Rotation) -> [[f64; 3]; 3] {
    match *rotation {
        Rotation::Matrix(matrix) => matrix,
        Rotation::RpyRad([0.0, 0.0, yaw]) => {
            let (sin, cos) = yaw.sin_cos();
            [[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]]
        }
        _ => panic!("{rotation:?}"),
    }
}

/// p_parent = R p + t.
fn out_of(frame: &Transform, [x, y, z]: [f64; 3]) -> [f64; 3] {
    let rows = matrix(&frame.rotation);
    let t = frame.translation_m;
    [0, 1, 2].map(|i| rows[i][0] * x + rows[i][1] * y + rows[i][2] * z + t[i])
}

/// p = Rᵀ (p_parent - t).
fn into(frame: &Transform, p: [f64; 3]) -> [f64; 3] {
    let rows = matrix(&frame.rotation);
    let d = [0, 1, 2].map(|i| p[i] - frame.translation_m[i]);
    [0, 1, 2].map(|i| rows[0][i] * d[0] + rows[1][i] * d[1] + rows[2][i] * d[2])
}

fn through_pinhole(lens: &Pinhole, [x, y, z]: [f64; 3]) -> [f64; 2] {
    let (x, y) = (x / z, y / z);
    let (x, y) = match lens.distortion {
        DistortionModel::None => (x, y),
        DistortionModel::BrownConrady { k1, k2, p1, p2, k3 } => {
            let s = x * x + y * y;
            let radial = 1.0 + k1 * s + k2 * s * s + k3 * s * s * s;
            (
                x * radial + 2.0 * p1 * x * y + p2 * (s + 2.0 * x * x),
                y * radial + p1 * (s + 2.0 * y * y) + 2.0 * p2 * x * y,
            )
        }
        _ => panic!("{lens:?}"),
    };
    [lens.fx * x + lens.cx, lens.fy * y + lens.cy]
}

fn pixel_of(rig: &Rig, camera: &str, in_base: [f64; 3]) -> [f64; 2] {
    let camera = rig.cameras.iter().find(|found| found.name == camera).unwrap();
    let LensModel::Pinhole(lens) = &camera.lens else { panic!("{camera:?}") };
    through_pinhole(lens, into(frame(rig, &camera.frame), in_base))
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).abs().max((a[1] - b[1]).abs())
}

fn calibration(data: &Path) -> PathBuf {
    data.join("jrdb-sample/calibration")
}

#[test]
fn conformance_the_single_cameras_of_jrdb() {
    let Some(data) = data() else { return };
    let rig = rig::jrdb_cameras(&calibration(&data)).unwrap();
    let mut worst_px = 0.0;
    for row in rows(data.join("camera_projection_reference.csv")) {
        let expected = numbers(&row, ["u_distorted", "v_distorted"]);
        let in_base = numbers(&row, ["ego_x", "ego_y", "ego_z"]);
        let camera = format!("image_{}", row["camera"]);
        if expected.iter().all(|n| n.is_finite()) {
            worst_px = f64::max(worst_px, distance(pixel_of(&rig, &camera, in_base), expected));
        }
    }
    println!("jrdb: at most {worst_px:.1e} px off");
    assert!(worst_px <= TOLERANCE_PX);
}

#[test]
fn conformance_the_left_colour_camera_of_kitti() {
    let Some(data) = data() else { return };
    let mut worst_px = 0.0;
    for row in rows(data.join("kitti_projection_reference.csv")) {
        let name = format!("kitti-sample/training/calib/{}.txt", row["frame"]);
        let rig = rig::kitti(&data.join(name), [1242, 375]).unwrap();
        let expected = numbers(&row, ["u", "v"]);
        let found = pixel_of(&rig, "image_2", numbers(&row, ["x", "y", "z"]));
        if expected.iter().all(|n| n.is_finite()) {
            worst_px = f64::max(worst_px, distance(found, expected));
        }
    }
    println!("kitti: at most {worst_px:.1e} px off");
    assert!(worst_px <= TOLERANCE_PX);
}

#[test]
fn conformance_the_official_panorama() {
    let Some(data) = data() else { return };
    let rig = Dataset::open(&data.join("jrdb-sample")).unwrap().rig().unwrap();
    let LensModel::Cylindrical(lens) = &rig.cameras[0].lens else { panic!("{rig:?}") };
    for row in rows(data.join("projection_reference.csv")) {
        let point = numbers(&row, ["x", "y", "z"]);
        let in_base = match row["input_frame"].as_str() {
            "base" => point,
            lidar => out_of(frame(&rig, lidar), point),
        };
        let expected = numbers(&row, ["u", "v"]);
        if !expected.iter().all(|n| n.is_finite()) {
            continue; // exactly beside the robot, where the reference divides by zero
        }
        let [x, y, z] = into(frame(&rig, &rig.cameras[0].frame), in_base);
        let width = f64::from(lens.width_px);
        let u = ((0.5 + x.atan2(z) / std::f64::consts::TAU) * width).rem_euclid(width);
        let v = lens.horizon_px + lens.focal_px * y / x.hypot(z);
        let around = (u - expected[0]).abs().min(width - (u - expected[0]).abs());
        assert!(around <= TOLERANCE_PX && (v - expected[1]).abs() <= TOLERANCE_PX, "{row:?}");
    }
}

/// Where the ray from the nearest view through a point of the panorama's frame meets the cylinder.
fn through_stitched(lens: &StitchedCylindrical, [x, y, z]: [f64; 3]) -> [f64; 2] {
    let azimuth = x.atan2(z);
    let off =
        |view: f64| (view - azimuth + 9.0 * std::f64::consts::PI).rem_euclid(std::f64::consts::TAU);
    let off = |view: f64| (off(view) - std::f64::consts::PI).abs();
    let nearest = |a: &&jrdb_types::lens::StitchView, b: &&jrdb_types::lens::StitchView| {
        off(a.azimuth_rad).total_cmp(&off(b.azimuth_rad))
    };
    let [cx, cy, cz] = lens.views.iter().min_by(nearest).unwrap().center_m;
    let (dx, dy, dz) = (x - cx, y - cy, z - cz);
    let (a, b, c) =
        (dx * dx + dz * dz, cx * dx + cz * dz, cx * cx + cz * cz - lens.radius_m.powi(2));
    let s = (-b + (b * b - a * c).sqrt()) / a;
    let width = f64::from(lens.width_px);
    let u = (0.5 + (cx + s * dx).atan2(cz + s * dz) / std::f64::consts::TAU) * width
        + lens.column_offset_px;
    [u.rem_euclid(width), lens.focal_px * (cy + s * dy) / lens.radius_m + lens.horizon_px]
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

#[test]
fn conformance_the_refined_panorama_draws_people_where_their_boxes_are() {
    let Some(data) = data() else { return };
    let path = data.join("jrdb-sample/labels/bytes-cafe-2019-02-07_0.track_3dbb_2dbb.csv");
    let Ok(labels) = fs::read_to_string(path) else { return println!("skipped: no shared data") };
    let rig = rig::jrdb_refined(&calibration(&data)).unwrap();
    let LensModel::StitchedCylindrical(lens) = &rig.cameras[0].lens else { panic!("{rig:?}") };
    // frame, track, cx, cy, h, w, l, rot_z of the 3D label; x, y, w, h of the 2D label
    let columns_off = labels.lines().map(|line| {
        let n: Vec<f64> = line.split(',').map(|word| word.parse().unwrap()).collect();
        let [u, _] = through_stitched(lens, into(frame(&rig, "panorama"), [n[2], n[3], 0.0]));
        (u - (n[8] + n[10] / 2.0) + 1880.0).rem_euclid(3760.0) - 1880.0
    });
    let off_px = median(columns_off.collect());
    println!(
        "refined panorama: people are drawn {off_px:.2} columns beside their boxes in the median"
    );
    assert!(off_px.abs() < 1.5);
}
