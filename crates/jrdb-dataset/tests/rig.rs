//! Rigs from calibration files of every kind, made by hand.
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]

use std::f64::consts::FRAC_PI_2;
use std::fs;
use std::path::{Path, PathBuf};

use jrdb_dataset::rig::{self, Calibrations};
use jrdb_dataset::{Error, LidarMount, OfficialCalibration, TreeWriter};
use jrdb_types::{Artefact, CylindricalPanorama, LensModel, Rig, Rotation};

/// An empty folder for one test.
fn folder(test: &str) -> PathBuf {
    let root = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("rig").join(test);
    let _ = fs::remove_dir_all(&root);
    fs::create_dir_all(&root).unwrap();
    root
}

fn message<T: std::fmt::Debug>(result: Result<T, Error>) -> String {
    result.unwrap_err().to_string()
}

/// Every text with a part replaced, and the error that this gives.
fn check_faults(path: &Path, cases: &[(&str, &str, &str)], read: impl Fn() -> Result<Rig, Error>) {
    let good = fs::read_to_string(path).unwrap();
    for (old, new, expected) in cases {
        assert!(good.contains(old), "{old}");
        fs::write(path, good.replacen(old, new, 1)).unwrap();
        let found = message(read());
        assert!(found.starts_with(expected), "{found}\nexpected {expected}");
        assert!(found.contains(path.file_name().unwrap().to_str().unwrap()), "{found}");
    }
    fs::write(path, good).unwrap();
}

fn official() -> OfficialCalibration {
    let panorama = CylindricalPanorama {
        width_px: 3760,
        height_px: 480,
        focal_px: 482.924,
        horizon_px: 209.383,
    };
    let mount = |name: &str| LidarMount { name: name.into(), offset_m: [0.0; 3], yaw_rad: 0.0 };
    let lidars = ["upper_velodyne", "lower_velodyne"].map(mount).to_vec();
    OfficialCalibration { panorama, lidars }
}

#[test]
fn a_rig_survives_its_file_in_json_and_yaml() {
    let folder = folder("own");
    let rig = official().rig();
    let text = Artefact::new(serde_json::json!({}), rig.clone()).to_json();
    for name in ["rig.json", "rig.yaml", "rig.yml"] {
        fs::write(folder.join(name), &text).unwrap(); // JSON is YAML
        assert_eq!(rig::read(&folder.join(name)).unwrap(), rig, "{name}");
    }
    fs::write(folder.join("rig.toml"), &text).unwrap();
    assert!(
        message(rig::read(&folder.join("rig.toml")))
            .starts_with(r#"expected a .json, .yaml or .yml file, found "rig.toml""#)
    );
}

#[test]
fn a_rig_file_with_a_fault_says_which() {
    let folder = folder("own-faults");
    let path = folder.join("rig.yaml");
    let text =
        "schema: jrdb.rig\nschema_version: 2\ndata:\n  base: b\n  cameras: []\n  lidars: []\n";
    fs::write(&path, text).unwrap();
    assert_eq!(rig::read(&path).unwrap().base, "b");
    let causes = [
        ("jrdb.rig", "jrdb.map", r#"expected a "jrdb.rig" artefact, found "jrdb.map""#),
        ("version: 2", "version: 3", "expected jrdb.rig version 2, found version 3"),
        ("lidars: []", "lidar: []", "not a well-formed jrdb.rig artefact"),
    ];
    for (old, new, expected) in causes {
        fs::write(&path, text.replace(old, new)).unwrap();
        let Err(Error::Artefact { source, .. }) = rig::read(&path) else { panic!("{old}") };
        assert_eq!(source.to_string(), expected);
    }
    fs::write(&path, "schema: [").unwrap();
    assert!(matches!(rig::read(&path), Err(Error::Yaml { .. })));
    fs::write(folder.join("rig.json"), "{").unwrap();
    assert!(matches!(rig::read(&folder.join("rig.json")), Err(Error::Json { .. })));
}

/// `cameras.yaml` with a ring of five cameras that sit 10 mm in front of the axis.
fn ring() -> String {
    let mut text = String::from("cameras:\n");
    for (k, azimuth) in (0..10).zip([0.0, -1.26, -2.51, 2.51, 1.26_f64].into_iter().cycle()) {
        let (sin, cos) = azimuth.sin_cos();
        text += &format!(
            "  sensor_{k}:\n    width: 752\n    height: 480\n    K: 480 0 376 0 480 240 0 0 1\n    \
             R: {cos} 0 {} 0 1 0 {sin} 0 {cos}\n    T: 0 0 -10\n",
            -sin
        );
    }
    text
}

#[test]
fn the_refined_panorama_has_the_five_views_of_the_upper_ring() {
    let root = folder("refined");
    TreeWriter::new(&root).calibration(&official()).unwrap();
    let folder = root.join("calibration");
    fs::write(folder.join("cameras.yaml"), ring()).unwrap();
    let rig = rig::jrdb_refined(&folder).unwrap();
    let LensModel::StitchedCylindrical(lens) = &rig.cameras[0].lens else { panic!("{rig:?}") };
    assert_eq!((lens.views.len(), lens.radius_m), (5, 1.7143));
    for (view, azimuth) in lens.views.iter().zip([0.0, -1.26, -2.51, 2.51, 1.26_f64]) {
        assert!((view.azimuth_rad - azimuth).abs() < 1e-12);
        let [x, y, z] = view.center_m;
        assert!(
            (x - 0.01 * azimuth.sin()).abs() < 1e-12 && (z - 0.01 * azimuth.cos()).abs() < 1e-12
        );
        assert_eq!(y, 0.0);
    }
    assert_eq!(rig.transforms[0].translation_m, [0.0, 0.0, 0.095]);
    let Rotation::Matrix([forward_x, forward_y, _]) = rig.transforms[0].rotation else { panic!() };
    assert!(forward_x[2] > 0.999 && (forward_y[2] + 0.005).abs() < 1e-6, "a little to the right");
    assert_eq!(rig.lidars, official().rig().lidars);
    let cases = [
        ("R: 1 0", "R: 1", "expected 9 finite numbers as cameras.sensor_0.R, found [1.0, "),
        (
            "T: 0 0 -10",
            "T: zero",
            r#"expected 3 finite numbers as cameras.sensor_0.T, found "zero""#,
        ),
        (
            "T: 0 0 -10",
            "t: 0",
            "expected 3 finite numbers as cameras.sensor_0.T, found no such key",
        ),
        ("sensor_1:", "sensor_one:", "expected cameras.sensor_1, found no such camera"),
    ];
    check_faults(&folder.join("cameras.yaml"), &cases, || rig::jrdb_refined(&folder));
}

#[test]
fn jrdb_s_single_cameras_are_paired_as_the_file_pairs_them() {
    let root = folder("cameras");
    TreeWriter::new(&root).calibration(&official()).unwrap();
    let folder = root.join("calibration");
    let sensors = ["0", "2", "4", "6", "8"].map(|k| {
        format!(
            "sensor_{k}:\n  D: [0.1, 0.2, 0.3, 0.4, 0.5]\n  distorted_img_K:\n  - [48{k}, 0, 376]\n  \
             - [0, 482, 240]\n  - [0, 0, 1]\n  cam2ego:\n  - [0, 0, 1, 0.{k}]\n  - [-1, 0, 0, 2]\n  \
             - [0, -1, 0, 3]\n  - [0, 0, 0, 1]\n"
        )
    });
    let path = folder.join("lidars.yaml");
    fs::write(&path, sensors.concat()).unwrap();
    let rig = rig::jrdb_cameras(&folder).unwrap();
    let names: Vec<&str> = rig.cameras.iter().map(|camera| camera.name.as_str()).collect();
    assert_eq!(names, ["image_0", "image_2", "image_4", "image_6", "image_8"]);
    let LensModel::Pinhole(lens) = &rig.cameras[3].lens else { panic!("{rig:?}") };
    assert_eq!((lens.fx, lens.cy, lens.width_px, lens.height_px), (486.0, 240.0, 752, 480));
    let distortion = jrdb_types::lens::DistortionModel::from_opencv(&[0.1, 0.2, 0.3, 0.4, 0.5]);
    assert_eq!(lens.distortion, distortion.unwrap());
    let placed = rig.transforms.iter().find(|t| t.child == "image_6").unwrap();
    assert_eq!(
        (placed.translation_m, placed.rotation),
        ([0.6, 2.0, 3.0], jrdb_types::rig::FORWARD_CAMERA)
    );
    let cases = [
        ("0.5]", "0.5, 0.6]", "expected 5 finite numbers as sensor_0.D, found [0.1, "),
        ("[480, 0", "[480, 1", "expected fx 0 cx, 0 fy cy, 0 0 1 as sensor_0.distorted_img_K"),
        ("[0, 0, 0, 1]", "[0, 0, 0, 2]", "expected 0 0 0 1 as last row of sensor_0.cam2ego, found"),
        ("[0, 0, 0, 1]", "", "expected 16 finite numbers as sensor_0.cam2ego"),
        ("sensor_2", "sensor_3", "expected sensor_2, found no such camera"),
        (
            "[0, 0, 1, 0.0]",
            "[0, 0, east, 0]",
            "expected 16 finite numbers as sensor_0.cam2ego, found [[",
        ),
    ];
    check_faults(&path, &cases, || rig::jrdb_cameras(&folder));
}

const KITTI: &str = "P0: 700 0 600 0 0 700 180 0 0 0 1 0\nP2: 700 0 600 49.0 0 700 180 7 0 0 1 0.01\n\
    R0_rect: 1 0 0 0 1 0 0 0 1\nTr_velo_to_cam: 0 -1 0 0.1 0 0 -1 0.2 1 0 0 0.3\n";

#[test]
fn kitti_s_baselines_are_translations() {
    let path = folder("kitti").join("000000.txt");
    fs::write(&path, KITTI).unwrap();
    let rig = rig::kitti(&path, [1242, 375]).unwrap();
    let names: Vec<&str> = rig.cameras.iter().map(|camera| camera.name.as_str()).collect();
    assert_eq!((names, rig.base.as_str()), (vec!["image_2", "image_0"], "velodyne"));
    assert_eq!(rig.lidars[0].name, "velodyne");
    // The camera's centre c satisfies 0 = R c + t + b, with b = ((49 - 6) / 700, (7 - 1.8) / 700, 0.01).
    let [forward, left, up] = rig.transforms[0].translation_m;
    assert!((forward + 0.3 + 0.01).abs() < 1e-15);
    assert!((left - 0.1 - 43.0 / 700.0).abs() < 1e-15);
    assert!((up - 0.2 - 5.2 / 700.0).abs() < 1e-15);
    let cases = [
        ("P2: 700", "P2:", "expected 12 finite numbers as P2, found [0.0, 600.0"),
        ("P2: 700 0", "P2: 700 1", "expected fx 0 cx, 0 fy cy, 0 0 1 as P2, found [700.0, 1.0"),
        ("R0_rect: 1 0", "R0_rect: 1 x", r#"expected 9 finite numbers as R0_rect, found "1 x"#),
        ("R0_rect", "R_0", "expected R0_rect or R_rect of a KITTI object, tracking"),
        (
            "R0_rect: 1 0",
            "R0_rect: 1 0.002",
            "expected a rotation in R0_rect, orthonormal to 1e-3, found one that is off by 2.0e-3",
        ),
        ("cam: 0 -1", "cam: 0 -2", "expected a rotation in Tr_velo_to_cam, orthonormal to 1e-3"),
    ];
    check_faults(&path, &cases, || rig::kitti(&path, [1242, 375]));
    let narrow = message(rig::kitti(&path, [0, 375]));
    assert!(narrow.starts_with("expected width of the image of P2 of 1 to 65536 pixels, found 0"));
    fs::write(&path, &KITTI[KITTI.find("R0").unwrap()..]).unwrap();
    assert!(
        message(rig::kitti(&path, [1242, 375]))
            .starts_with("expected P0, P1, P2 or P3 of a KITTI object, tracking")
    );
}

/// Tables with a camera and a LiDAR that were calibrated once, a camera that was calibrated twice, and a radar.
fn nuscenes_tables(folder: &Path) {
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
    write(
        "sensor.json",
        r#"[{"token": "s0", "channel": "CAM_BACK", "modality": "camera"},
            {"token": "s1", "channel": "CAM_FRONT", "modality": "camera"},
            {"token": "s2", "channel": "LIDAR_TOP", "modality": "lidar"},
            {"token": "s3", "channel": "RADAR_FRONT", "modality": "radar"}]"#,
    );
    let row = |token: &str, sensor: &str, x: f64, k: &str| {
        format!(
            r#"{{"token": "{token}", "sensor_token": "{sensor}", "translation": [{x}, 0.5, 1.5],
                "rotation": [0.5, -0.5, 0.5, -0.5], "camera_intrinsic": {k}}}"#
        )
    };
    let k = "[[1260.0, 0.0, 816.0], [0.0, 1260.0, 491.0], [0.0, 0.0, 1.0]]";
    let rows = [
        row("back", "s0", -1.0, k),
        row("front-monday", "s1", 1.7, k),
        row("front-tuesday", "s1", 1.8, k),
        row("top", "s2", 0.9, "[]"),
        row("radar", "s3", 3.4, "[]"),
        row("never-used", "s2", 7.0, "[]"),
    ];
    write("calibrated_sensor.json", &format!("[{}]", rows.join(",")));
    let data = |sample: &str, calibrated: &str, width: &str| {
        format!(
            r#"{{"sample_token": "{sample}", "calibrated_sensor_token": "{calibrated}", "width": {width}, "height": 900}}"#
        )
    };
    let rows = [
        data("monday", "back", "1600"),
        data("monday", "back", "1600"),
        data("monday", "front-monday", "1600"),
        data("monday", "top", "null"),
        data("monday", "radar", "0"),
        data("tuesday", "front-tuesday", "1600"),
    ];
    write("sample_data.json", &format!("[{}]", rows.join(",")));
}

#[test]
fn nuscenes_tables_are_joined_by_token() {
    let folder = folder("nuscenes");
    nuscenes_tables(&folder);
    let monday = rig::nuscenes(&folder, Calibrations::OfSample("monday")).unwrap();
    let names: Vec<&str> = monday.cameras.iter().map(|camera| camera.name.as_str()).collect();
    assert_eq!((names, monday.base.as_str()), (vec!["CAM_FRONT", "CAM_BACK"], "ego"));
    assert_eq!((monday.lidars.len(), monday.lidars[0].name.as_str()), (1, "LIDAR_TOP"));
    assert_eq!(monday.transforms.len(), 3, "no radar");
    let LensModel::Pinhole(lens) = &monday.cameras[0].lens else { panic!("{monday:?}") };
    assert_eq!((lens.fx, lens.cx, lens.width_px, lens.height_px), (1260.0, 816.0, 1600, 900));
    let front = monday.transforms.iter().find(|t| t.child == "CAM_FRONT").unwrap();
    assert_eq!(front.translation_m, [1.7, 0.5, 1.5]);
    assert_eq!(front.rotation, Rotation::QuaternionWxyz([0.5, -0.5, 0.5, -0.5]));

    let tokens = Calibrations::Tokens(&["front-tuesday", "top"]);
    let tuesday = rig::nuscenes(&folder, tokens).unwrap();
    assert_eq!((tuesday.cameras.len(), tuesday.transforms[0].translation_m[0]), (1, 1.8));
}

#[test]
fn a_channel_with_several_calibrations_needs_a_choice() {
    let folder = folder("nuscenes-choice");
    nuscenes_tables(&folder);
    let read = |choice| message(rig::nuscenes(&folder, choice));
    assert!(read(Calibrations::Only).starts_with(
        "expected one calibration of CAM_FRONT, or a choice by token or sample, found front-monday, front-tuesday, in"
    ));
    assert!(
        read(Calibrations::OfSample("sunday"))
            .starts_with(r#"expected data of sample "sunday", found none"#)
    );
    let unknown = Calibrations::Tokens(&["top", "nowhere"]);
    assert!(
        read(unknown).starts_with(r#"expected a calibration "nowhere" that has data, found none"#)
    );
    let both = Calibrations::Tokens(&["front-monday", "front-tuesday"]);
    assert!(read(both).starts_with("expected one calibration of CAM_FRONT"));
}

#[test]
fn nuscenes_tables_with_a_fault_say_which() {
    let folder = folder("nuscenes-faults");
    nuscenes_tables(&folder);
    let read = || rig::nuscenes(&folder, Calibrations::OfSample("monday"));
    let cases = [
        (
            "[-1, 0.5, 1.5]",
            "[-1, 0.5]",
            r#"expected 3 finite numbers as translation of "back", found [-1.0, 0.5]"#,
        ),
        (
            "[0.5, -0.5,",
            "[\"half\", -0.5,",
            r#"expected 4 finite numbers as rotation of "back", found ["half""#,
        ),
        (
            "0.0, 816.0",
            "0.1, 816.0",
            r#"expected fx 0 cx, 0 fy cy, 0 0 1 as camera_intrinsic of "back""#,
        ),
        (
            "[[1260.0, 0.0, 816.0], ",
            "[",
            r#"expected 9 finite numbers as camera_intrinsic of "back""#,
        ),
        ("\"s0\"", "\"s9\"", r#"expected a sensor of sensor.json in row "back", found "s9""#),
        ("\"rotation\"", "\"rot\"", "expected rows of token, sensor_token, translation, rotation"),
    ];
    check_faults(&folder.join("calibrated_sensor.json"), &cases, read);
    let cases = [
        (
            "1600",
            "1200",
            r#"expected pictures of one size of calibration "back", found [[1200, 900], [1600, 900]]"#,
        ),
        ("1600", "-1", "expected rows of sample_token, calibrated_sensor_token, width and height"),
    ];
    check_faults(&folder.join("sample_data.json"), &cases, read);
}

#[test]
fn a_quarter_turn_of_a_lidar_is_written_as_a_yaw() {
    let mut calibration = official();
    calibration.lidars[1].yaw_rad = FRAC_PI_2;
    let rig = calibration.rig();
    assert_eq!(rig.transforms[2].rotation, Rotation::RpyRad([0.0, 0.0, FRAC_PI_2]));
    assert_eq!(
        (rig.transforms[2].child.as_str(), rig.lidars[1].frame.as_str()),
        ("lower_velodyne", "lower_velodyne")
    );
}
