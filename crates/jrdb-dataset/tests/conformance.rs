//! Checks against a real frame of JRDB, for whoever has one; skipped without it.
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]
#![allow(clippy::print_stdout, reason = "skipping is visible")]

use std::fs;
use std::path::{Path, PathBuf};

use jrdb_dataset::cloud::Fields;
use jrdb_dataset::pcd::{self, Encoding};
use jrdb_dataset::{Dataset, cloud, read_detections, read_image, read_questions};
use jrdb_types::{Detections, ImageGeometry, IssueKind};

/// The folder of research data, unless it is absent.
fn shared() -> Option<PathBuf> {
    let default = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared");
    let folder = std::env::var_os("JRDB_SHARED").map_or_else(|| default.into(), PathBuf::from);
    let found = folder.join("data/jrdb-sample").is_dir();
    if !found {
        println!("skipped: no shared data");
    }
    found.then_some(folder)
}

fn sample() -> Option<Dataset> {
    shared().map(|folder| Dataset::open(&folder.join("data/jrdb-sample")).unwrap())
}

/// Every file below a folder with this extension.
fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        if path.is_dir() {
            found.extend(files(&path, extension));
        } else if path.extension().is_some_and(|e| e == extension) {
            found.push(path);
        }
    }
    found
}

#[test]
fn conformance_the_official_calibration_gives_the_official_constants() {
    let Some(dataset) = sample() else { return };
    let official = dataset.official_calibration().unwrap();
    assert!((official.panorama.focal_px - 482.924).abs() < 1e-9);
    assert!((official.panorama.horizon_px - 209.383).abs() < 1e-9);
    assert_eq!((official.panorama.width_px, official.panorama.height_px), (3760, 480));
    let [upper, lower] = &official.lidars[..] else { panic!("two lidars") };
    assert_eq!(upper.name, "upper_velodyne");
    assert_eq!((upper.yaw_rad, upper.offset_m), (0.085, [0.0, 0.0, -0.33529]));
    assert_eq!((lower.yaw_rad, lower.offset_m), (0.0, [0.0, 0.0, 0.13511]));
}

#[test]
fn conformance_every_cloud_has_as_many_points_as_its_header_says() {
    let Some(dataset) = sample() else { return };
    let paths = files(dataset.root(), "pcd");
    assert!(!paths.is_empty());
    for path in paths {
        let cloud = cloud::read(&path, "lidar", Fields::All).unwrap();
        let bytes = fs::read(&path).unwrap();
        let header = String::from_utf8_lossy(&bytes[..bytes.len().min(1000)]).into_owned();
        let points = header.lines().find_map(|line| line.strip_prefix("POINTS ")).unwrap();
        assert_eq!(cloud.len() + cloud.skipped, points.parse::<usize>().unwrap(), "{path:?}");
        assert_eq!(cloud.intensity.len(), cloud.len());
        let range = |i: usize| cloud.x[i].hypot(cloud.y[i]).hypot(cloud.z[i]);
        assert!((0..cloud.len()).all(|i| range(i) < 200.0), "metres in {path:?}");
        for encoding in [Encoding::Ascii, Encoding::Binary, Encoding::BinaryCompressed] {
            let again = pcd::parse(&pcd::write(&cloud, encoding), "lidar").unwrap();
            assert_eq!(again.x, cloud.x);
            assert_eq!(again.intensity, cloud.intensity);
        }
    }
}

#[test]
fn conformance_bare_floats_are_sweeps() {
    let Some(folder) = shared() else { return };
    let folders = ["jrdb-sample/extra_lower_velodyne_bin", "kitti-sample/training/velodyne"];
    let folders = folders.map(|name| folder.join("data").join(name)).into_iter();
    let paths: Vec<PathBuf> =
        folders.filter(|path| path.is_dir()).flat_map(|path| files(&path, "bin")).collect();
    for path in paths {
        let cloud = cloud::read(&path, "lidar", Fields::All).unwrap();
        assert_eq!(16 * (cloud.len() + cloud.skipped) as u64, fs::metadata(&path).unwrap().len());
        let range = |i: usize| cloud.x[i].hypot(cloud.y[i]).hypot(cloud.z[i]);
        assert!((0..cloud.len()).all(|i| range(i) < 200.0), "metres in {path:?}");
        assert!(cloud.intensity.iter().all(|&value| (0.0..=255.0).contains(&value)), "{path:?}");
    }
}

#[test]
fn conformance_every_frame_has_a_panorama_and_two_sweeps() {
    let Some(dataset) = sample() else { return };
    let sequences = dataset.sequences().unwrap();
    assert!(!sequences.is_empty());
    for sequence in sequences {
        for frame in dataset.frames(&sequence).unwrap() {
            let image = dataset.image(&sequence, frame).unwrap();
            assert_eq!((image.width, image.height), (3760, 480));
            let lidars = dataset.rig().unwrap().lidars;
            let (clouds, issues) = dataset.clouds(&sequence, frame, &lidars);
            assert_eq!((clouds.len(), issues), (2, vec![]));
        }
    }
}

#[test]
fn conformance_pictures_of_all_kinds_decode() {
    let Some(folder) = shared() else { return };
    let pictures = ["jpg", "png"].map(|extension| files(&folder.join("data"), extension)).concat();
    assert!(!pictures.is_empty());
    for path in pictures {
        let image = read_image(&path).unwrap();
        assert_eq!(image.rgb.len(), 3 * image.width * image.height);
        assert!(image.rgb.iter().any(|&value| value != image.rgb[0]), "{path:?} is one colour");
    }
}

#[test]
fn conformance_a_jrdb_coco_file_has_a_frame_for_each_image() {
    let Some(dataset) = sample() else { return };
    let folder = dataset.root().join("labels/labels_2d_pose_stitched_coco");
    for path in files(&folder, "json") {
        let sequence = path.file_stem().unwrap().to_str().unwrap();
        let image = ImageGeometry { width_px: 3760, height_px: 480, wraps: true };
        let found = read_detections(&path, sequence, image).unwrap();
        let json: serde_json::Value =
            serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
        assert_eq!(found.len(), json["images"].as_array().unwrap().len());
        // Its annotations are key points without boxes: every one is an issue, and every frame says that nothing could be used.
        let of_object = |issue: &&jrdb_types::Issue| issue.kind != IssueKind::MissingInput;
        let issues = |f: &Detections| f.issues.iter().filter(of_object).count();
        let objects: usize = found.values().map(|f| f.detections.len() + issues(f)).sum();
        assert_eq!(objects, json["annotations"].as_array().unwrap().len());
    }
}

/// The engine's records have the parts of a data point in another arrangement.
fn data_point(record: &serde_json::Value) -> serde_json::Value {
    serde_json::json!({
        "task_type": if record["task"] == "VG" { "VG" } else { "VQA" },
        "data": {"seq": "scene.json", "modality_type": record["modality"]},
        "question": {
            "question": record["question"],
            "timestamps": record["timestamps"],
            "sub_questions": record["sub_questions"],
        },
        "labels": record["labels"],
    })
}

#[test]
fn conformance_the_benchmark_s_questions_keep_their_category_and_answer() {
    let Some(path) = shared().map(|folder| folder.join("goldens/jrdb_reasoning/questions.json"))
    else {
        return;
    };
    let Ok(text) = fs::read_to_string(path) else { return println!("skipped: no shared data") };
    let records: Vec<serde_json::Value> = serde_json::from_str(&text).unwrap();
    let images: Vec<&serde_json::Value> =
        records.iter().filter(|record| record["modality"] == "image" && record["T"] == 1).collect();
    assert!(!images.is_empty());
    let points: Vec<_> = images.iter().map(|record| data_point(record)).collect();
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("engine-questions.json");
    fs::write(&path, serde_json::to_string(&points).unwrap()).unwrap();
    let found = read_questions(&path).unwrap().questions;
    for (record, question) in images.iter().zip(&found) {
        let category = record["category"].as_str().unwrap();
        if category.starts_with("gender") || category == "age" {
            let scope_aside = category.trim_end_matches("/multi-frame");
            assert_eq!(question.category, scope_aside);
        }
        let known = &record["labels"]["slot1"];
        if record["task"] == "VG" {
            let truth = question.truth.as_ref().unwrap();
            assert_eq!(truth.boxes.len(), known["final_bbox"].as_array().unwrap().len());
        }
        if record["task"] == "VQA-Count" {
            let count = question.truth.as_ref().unwrap().count.unwrap();
            assert_eq!(known["final_answer"].to_string().trim_matches('"'), count.to_string());
        }
    }
}
