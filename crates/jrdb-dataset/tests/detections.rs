//! Detections from our own artefact and from COCO files.
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

use jrdb_dataset::{Error, read_detections};
use jrdb_types::{Artefact, Detections, ImageGeometry, IssueKind};

const IMAGE: ImageGeometry = ImageGeometry { width_px: 3760, height_px: 480, wraps: true };

fn read(test: &str, text: &str) -> Result<BTreeMap<u32, Detections>, Error> {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("detections");
    fs::create_dir_all(&folder).unwrap();
    let path = folder.join(format!("{test}.json"));
    fs::write(&path, text).unwrap();
    read_detections(&path, "cafe", IMAGE)
}

fn error(test: &str, text: &str) -> String {
    read(test, text).unwrap_err().to_string()
}

fn lines(found: &Detections) -> Vec<String> {
    let line =
        |d: &jrdb_types::Detection| format!("{} {} {} {}", d.id, d.category, d.bbox.x, d.score);
    found.detections.iter().map(line).collect()
}

const RESULTS: &str = r#"[
    {"image_id": 7, "category_id": 1, "bbox": [300, 10, 20, 40], "score": 0.5},
    {"image_id": 7, "category_id": 3, "bbox": [100, 10, 20, 40], "score": 0.25},
    {"image_id": 7, "category_id": 1, "bbox": [-10, 10, 20, 40], "score": 0.75},
    {"image_id": 7, "category_id": 1, "bbox": [50, 10, 20, 40]},
    {"image_id": "000008.jpg", "category_id": 1, "bbox": [50, 10, 0, 40], "score": 1}
]"#;

#[test]
fn coco_results_are_numbered_from_left_to_right() {
    let found = read("results", RESULTS).unwrap();
    assert_eq!(found.keys().copied().collect::<Vec<_>>(), [7, 8]);
    assert_eq!(
        lines(&found[&7]),
        [
            "category_3:1 category_3 100 0.25",
            "person:1 person 50 1",
            "person:2 person 300 0.5",
            "person:3 person 3750 0.75",
        ]
    );
    assert_eq!((found[&7].frame.sequence.as_str(), found[&7].frame.frame), ("cafe", 7));
    assert_eq!(found[&8].issues[0].kind, IssueKind::BadBox);
    assert!(found[&8].issues[0].message.starts_with("annotation 4: expected a box with an area"));
}

const DATASET: &str = r#"{
    "images": [{"id": 1, "file_name": "images/cafe/000000.jpg"}, {"id": 2, "file_name": "images/cafe/000010.jpg"},
        {"id": 3, "file_name": "images/hall/000000.jpg"}],
    "annotations": [{"image_id": 2, "category_id": 4, "bbox": [5, 5, 5, 5], "keypoints": []},
        {"image_id": 2, "category_id": 1, "bbox": [4, 5, 5, 5]}, {"image_id": 3, "category_id": 4, "bbox": [1, 1, 1, 1]},
        {"image_id": 2, "category_id": 4}],
    "categories": [{"id": 4, "name": "pedestrian"}, {"id": 1, "name": "chair"}]
}"#;

#[test]
fn a_coco_dataset_maps_images_by_file_name_and_names_its_categories() {
    let found = read("dataset", DATASET).unwrap();
    assert_eq!(found.keys().copied().collect::<Vec<_>>(), [0, 10]);
    assert_eq!(lines(&found[&10]), ["chair:1 chair 4 1", "person:1 person 5 1"]);
    assert_eq!(found[&10].issues[0].message, "annotation 3: no box");
    assert!(found[&0].detections.is_empty(), "an image without annotations is a frame");
}

#[test]
fn artefacts_are_read_alone_or_in_a_list() {
    let data = read("for-artefacts", RESULTS).unwrap();
    let text = |frame: &u32| Artefact::new(serde_json::json!({}), data[frame].clone()).to_json();
    assert_eq!(read("artefact", &text(&7)).unwrap(), BTreeMap::from([(7, data[&7].clone())]));
    let both = format!("[{}, {}]", text(&8), text(&7));
    assert_eq!(read("artefacts", &both).unwrap(), data);
    let hall = text(&8).replace("cafe", "hall");
    assert_eq!(read("mixed", &format!("[{}, {hall}]", text(&7))).unwrap().len(), 1);

    assert!(error("twice", &format!("[{0}, {0}]", text(&7))).contains("found two for frame 7"));
    assert!(error("elsewhere", &hall).contains(r#"expected detections of sequence "cafe""#));
    assert!(error("small", &text(&7).replace("3760", "376")).contains("width_px: 376,"));
    assert!(error("ids", &text(&7).replace("person:2", "person:1")).contains("person:1 twice"));
    assert!(
        error("query", &text(&7).replace("jrdb.detections", "jrdb.query")).contains("artefact")
    );
}

#[test]
fn trouble_says_what_was_expected_and_found() {
    let cases = [
        (
            "{",
            "expected a jrdb.detections artefact, a list of them, COCO results, or a COCO dataset",
        ),
        (r#"[{"boxes": 1}]"#, "COCO dataset, found JSON with other keys"),
        (
            r#"[{"image_id": "cover.jpg", "category_id": 1, "bbox": [1, 1, 1, 1]}]"#,
            r#"expected a frame number as image_id, found Name("cover.jpg")"#,
        ),
        (
            r#"[{"image_id": 1, "category_id": 1, "bbox": [1, 1, 1, 1], "score": 7}]"#,
            "expected a score in [0, 1] in annotation 0, found 7",
        ),
        (
            &DATASET.replace(r#""image_id": 3"#, r#""image_id": 9"#),
            "expected an image_id of `images`, found Number(9)",
        ),
        (
            &DATASET.replace("000010", "000000"),
            "expected one image for each frame, found Number(1) and Number(2) for frame 0",
        ),
    ];
    for (text, expected) in cases {
        let found = error("trouble", text);
        assert!(found.contains(expected), "{found}");
    }
    assert!(read("nothing", "[]").unwrap().is_empty());
}
