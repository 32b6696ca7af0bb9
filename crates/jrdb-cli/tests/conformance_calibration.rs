//! Does the calibration check accept good mounts and find planted errors? On the bundled scenes always, on the
//! real JRDB frame where it is there.
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]
#![allow(clippy::print_stdout, reason = "figures and skipped tests are said aloud")]

use std::path::{Path, PathBuf};
use std::process::Command;

use jrdb_calibration::{FitConfig, FitReport, Verdict, check_fit, refine};
use jrdb_cli::calib::{CalibFrame, Mounts, Plant, with_views};
use jrdb_cli::source::{RigChoice, RobotOptions, Source, list_frames};
use jrdb_render::calibration as words;

const SEQUENCE: &str = "bytes-cafe-2019-02-07_0";

fn scene(name: &str) -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../testdata/scenes")).join(name)
}

fn scene_frames(name: &str) -> Vec<CalibFrame> {
    let frames =
        list_frames(&[Source::Scene(scene(name))], None, &RobotOptions::default()).unwrap();
    frames.iter().map(|frame| CalibFrame::read(frame).unwrap()).collect()
}

/// The sample's tree, unless it is absent.
fn sample() -> Option<PathBuf> {
    let default = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared");
    let shared = std::env::var_os("JRDB_SHARED").map_or_else(|| default.into(), PathBuf::from);
    let root = shared.join("data/jrdb-sample");
    let is_there = root.is_dir();
    if !is_there {
        println!("skipped: no shared data");
    }
    is_there.then_some(root)
}

fn sample_frames(root: &Path) -> Vec<CalibFrame> {
    let source = Source::Sequence { root: root.into(), name: SEQUENCE.into() };
    let refined = RobotOptions { rig: RigChoice::JrdbRefined, ..RobotOptions::default() };
    let frames = list_frames(&[source], Some(&(0..1)), &refined).unwrap();
    frames.iter().map(|frame| CalibFrame::read(frame).unwrap()).collect()
}

fn plant(yaw_deg: f64, height_m: f64, lidars: &[&str]) -> Plant {
    Plant { yaw_deg, height_m, lidars: lidars.iter().map(|name| (*name).into()).collect() }
}

fn mounts(frames: &[CalibFrame], plant: &Plant) -> Vec<Mounts> {
    frames.iter().map(|frame| plant.apply(&frame.mounts).unwrap()).collect()
}

fn check(frames: &[CalibFrame], plant: &Plant) -> FitReport {
    let mounts = mounts(frames, plant);
    with_views(frames, &mounts, |views| check_fit(views, &FitConfig::default())).unwrap()
}

/// Checks that what the check finds with a planted error differs from what it finds without by that error, and is
/// within so many degrees and metres of it.
fn finds(frames: &[CalibFrame], without: &FitReport, plant: &Plant, reads_within: [f64; 2]) {
    let found = check(frames, plant);
    for (with, without) in found.lidars.iter().zip(&without.lidars) {
        let is_planted = plant.concerns(&with.sensor);
        let [yaw_deg, height_m] =
            if is_planted { [plant.yaw_deg, plant.height_m] } else { [0.0; 2] };
        let found_deg = (with.yaw_rad.offset - without.yaw_rad.offset).to_degrees();
        let found_m = with.height_m.offset - without.height_m.offset;
        let line = format!(
            "{:16} planted {yaw_deg:+.1}° {height_m:+.2} m, found {found_deg:+.2}° {found_m:+.3} m",
            with.sensor
        );
        println!("{line}");
        assert!((found_deg - yaw_deg).abs() < 0.3 && (found_m - height_m).abs() < 0.03, "{line}");
        let [read_deg, read_m] = [with.yaw_rad.offset.to_degrees(), with.height_m.offset];
        let line = format!("{line}, read {read_deg:+.2}° {read_m:+.3} m");
        assert!((read_deg - yaw_deg).abs() < reads_within[0], "{line}");
        assert!((read_m - height_m).abs() < reads_within[1], "{line}");
    }
    assert_eq!(found.verdict, Verdict::Off, "{plant:?}: {}", words::verdict(&found));
}

#[test]
fn bundled_scenes_are_consistent_and_planted_errors_are_found_in_them() {
    let cases = [
        ("plaza", plant(2.0, 0.0, &[])),
        ("cafe", plant(-2.0, 0.1, &["lower_velodyne"])),
        ("corridor", plant(0.0, -0.15, &["upper_velodyne"])),
    ];
    for (name, plant) in cases {
        let frames = scene_frames(name);
        let report = check(&frames, &self::plant(0.0, 0.0, &[]));
        println!("{name}\n{}", words::fit(&report));
        assert_eq!(report.verdict, Verdict::Consistent, "{name}: {}", words::verdict(&report));
        finds(&frames, &report, &plant, [0.3, 0.06]);
    }
}

#[test]
fn a_cloud_of_elsewhere_is_not_called_consistent_nor_off() {
    for (name, turned_deg) in [("plaza", 120.0), ("cafe", 240.0)] {
        let report = check(&scene_frames(name), &plant(turned_deg, 0.0, &[]));
        assert_eq!(report.verdict, Verdict::CannotTell, "{name}: {}", words::verdict(&report));
        assert!(words::verdict(&report).contains("no offset fits better than chance"));
    }
}

#[test]
fn the_command_says_consistent_by_its_exit_code_and_draws() {
    let out = tempfile::tempdir().unwrap();
    let run = |rest: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_jrdb"));
        command.args(["calib", "check", "--scene"]).arg(scene("plaza")).args(rest);
        let output = command.arg("--out").arg(out.path()).output().unwrap();
        (output.status.code(), String::from_utf8(output.stdout).unwrap())
    };
    let (code, text) = run(&[]);
    assert_eq!(code, Some(0), "{text}");
    assert!(text.ends_with("verdict: consistent\n"), "{text}");
    let (code, text) = run(&["--plant-yaw-deg", "-2", "--format", "json"]);
    assert_eq!(code, Some(1));
    let report: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(report["fit"]["verdict"], "off");
    let written = std::fs::read_to_string(out.path().join("report.json")).unwrap();
    assert_eq!(written + "\n", text);
    let picture = jrdb_dataset::read_image(&out.path().join("overlay.png")).unwrap();
    assert_eq!(picture.width, 1880);
    assert_eq!(run(&["--plant-lidar", "sonar", "--plant-yaw-deg", "1"]).0, Some(2));
}

#[test]
fn conformance_the_shipped_calibration_is_accepted_and_planted_errors_are_found() {
    let Some(root) = sample() else { return };
    let frames = sample_frames(&root);
    let report = check(&frames, &plant(0.0, 0.0, &[]));
    println!("{}", words::fit(&report));
    assert_eq!(report.verdict, Verdict::Consistent, "{}", words::verdict(&report));
    let [both, upper, lower]: [&[&str]; 3] = [&[], &["upper_velodyne"], &["lower_velodyne"]];
    for (yaw_deg, height_m) in [(2.0, 0.0), (-2.0, 0.0), (0.0, 0.1), (0.0, -0.1)] {
        finds(&frames, &report, &plant(yaw_deg, height_m, both), [0.3, 0.03]);
    }
    for lidars in [both, upper, lower] {
        finds(&frames, &report, &plant(2.0, -0.1, lidars), [0.3, 0.03]);
        finds(&frames, &report, &plant(-2.0, 0.1, lidars), [0.3, 0.03]);
    }
}

#[test]
fn conformance_refinement_undoes_a_planted_error() {
    let Some(root) = sample() else { return };
    let frames = sample_frames(&root);
    let mounts = mounts(&frames, &plant(2.0, 0.1, &[]));
    let found = with_views(&frames, &mounts, |v| refine(v, &FitConfig::default())).unwrap();
    for lidar in &found.lidars {
        println!("{lidar:?}");
        assert!(lidar.score_after > lidar.score_before + 0.02);
        let yaw_deg = lidar.correction.yaw_rad.to_degrees();
        assert!((yaw_deg + 2.0).abs() < 0.3, "{yaw_deg}°");
        assert!((lidar.correction.height_m + 0.1).abs() < 0.03, "{}", lidar.correction.height_m);
    }
}
