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
    assert_eq!(
        messages(&found[&8])[1],
        "MissingInput: none of the frame's 1 detections could be used"
    );
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
            "expected a jrdb.detections artefact, a list of them, COCO results, a COCO dataset, or JRDB's detections_2d_stitched",
        ),
        (r#"[{"boxes": 1}]"#, "detections_2d_stitched, found JSON with other keys"),
        (
            r#"[{"image_id": "cover.jpg", "category_id": 1, "bbox": [1, 1, 1, 1]}]"#,
            r#"annotation 0: expected a frame number as image_id, found "cover.jpg""#,
        ),
        (
            &DATASET.replace("000010", "000000"),
            "expected one image for each frame, found 1 and 2 for frame 0",
        ),
    ];
    for (text, expected) in cases {
        let found = error("trouble", text);
        assert!(found.contains(expected), "{found}");
    }
    assert!(read("nothing", "[]").unwrap().is_empty());
}

fn messages(found: &Detections) -> Vec<String> {
    found.issues.iter().map(|issue| format!("{:?}: {}", issue.kind, issue.message)).collect()
}

#[test]
fn one_entry_that_cannot_be_used_does_not_spoil_the_others() {
    let bad = [
        (
            r#""score": 0.5"#,
            r#""score": 7"#,
            "BadLabel: annotation 0: expected a score in [0, 1], found 7",
        ),
        (
            r#""score": 0.5"#,
            r#""score": NaN"#,
            r#"BadLabel: annotation 0: expected a score in [0, 1], found "NaN""#,
        ),
        ("[300, 10, 20, 40]", "[]", "BadBox: annotation 0: expected 4 numbers as box, found []"),
        (
            "[300, 10, 20, 40]",
            "[300, 10, 20, 40, 5]",
            "BadBox: annotation 0: expected 4 numbers as box, found [300,10,20,40,5]",
        ),
    ];
    for (old, new, expected) in bad {
        let found = read("one-bad", &RESULTS.replacen(old, new, 1)).unwrap();
        assert_eq!((found[&7].detections.len(), messages(&found[&7])), (3, vec![expected.into()]));
    }
    let nowhere = RESULTS.replacen(r#""image_id": 7"#, r#""image_id": {}"#, 1);
    let found = read("nowhere", &nowhere).unwrap();
    assert_eq!(
        messages(&found[&7]),
        ["DoubtfulInput: annotation 0: expected an image_id, found {}"]
    );
    let orphan = read("orphan", &DATASET.replace(r#""image_id": 3"#, r#""image_id": 9"#)).unwrap();
    let message = "DoubtfulInput: annotation 2: expected an image_id of `images`, found 9";
    assert!(messages(&orphan[&0]).contains(&message.into()));
}

#[test]
fn numbers_may_be_texts_or_have_parts_and_scores_may_be_rounded() {
    let text = RESULTS
        .replace(r#""image_id": 7, "category_id": 1"#, r#""image_id": "7", "category_id": 1.0"#)
        .replace("[300, 10, 20, 40]", r#"["300", 10.0, "20", 40]"#)
        .replace(r#""score": 0.5"#, r#""score": "0.5""#);
    assert_eq!(
        read("texts", &text).unwrap()[&7].detections,
        read("plain", RESULTS).unwrap()[&7].detections
    );
    let rounded = RESULTS.replace("0.75", "1.0000001");
    assert_eq!(read("rounded", &rounded).unwrap()[&7].detections[3].score, 1.0);
}

#[test]
fn regions_of_many_are_left_out() {
    for mark in [r#""iscrowd": 1"#, r#""ignore": true"#, r#""iscrowd": "1""#] {
        let text = RESULTS.replacen(r#""score": 0.5"#, &format!(r#""score": 0.5, {mark}"#), 1);
        let found = read("crowd", &text).unwrap();
        let expected =
            "DoubtfulInput: annotation 0: a region of many (iscrowd or ignore), left out";
        assert_eq!((found[&7].detections.len(), messages(&found[&7])), (3, vec![expected.into()]));
    }
}

#[test]
fn people_may_be_called_otherwise_and_a_file_without_people_says_so() {
    for name in ["Person", "PEOPLE", "human", "person ", "Pedestrian"] {
        let found = read("names", &DATASET.replace("pedestrian", name)).unwrap();
        assert_eq!(lines(&found[&10])[1], "person:1 person 5 1", "{name}");
    }
    let dogs = read("dogs", &DATASET.replace("pedestrian", "dog")).unwrap();
    let expected = r#"MissingInput: no category of the file is called person: there are the categories "chair", "dog""#;
    assert_eq!(messages(&dogs[&0]), [expected]);
    let zero =
        read("zero", &RESULTS.replace(r#""category_id": 3"#, r#""category_id": 0"#)).unwrap();
    assert!(zero[&7].detections.iter().all(|d| d.category.starts_with("category_")));
    assert!(messages(&zero[&7])[0].contains("there are the categories 0, 1"), "{zero:?}");
}

#[test]
fn jrdb_s_own_detections_are_read() {
    let text = r#"{"detections": {"000007.jpg": [
        {"box": [10, 20, 30, 40], "file_id": "000007.jpg", "label_id": "person:5", "score": 0.5},
        {"box": [5, 20, 30, 40], "file_id": "000007.jpg", "label_id": "person:-1", "score": 0.25},
        {"box": [5, 20, 0, 40], "label_id": "person:1"}]}}"#;
    let found = read("jrdb", text).unwrap();
    assert_eq!(lines(&found[&7]), ["person:1 person 5 0.25", "person:2 person 10 0.5"]);
    assert_eq!(found[&7].issues[0].kind, IssueKind::BadBox);
}

#[test]
fn corners_are_read_and_parts_of_the_picture_are_refused() {
    let entry = |b: [f64; 4]| format!(r#"{{"image_id": 0, "category_id": 1, "bbox": {b:?}}}"#);
    let boxes = (0..6).map(|i| [900.0 - 99.0 * f64::from(i), 150.0, 60.0, 250.0]);
    let file = |change: fn([f64; 4]) -> [f64; 4]| {
        let entries: Vec<String> = boxes.clone().map(|b| entry(change(b))).collect();
        format!("[{}]", entries.join(","))
    };
    let corners = read("corners", &file(|[x, y, w, h]| [x, y, x + w, y + h])).unwrap();
    let usual = read("usual", &file(|b| b)).unwrap();
    assert_eq!(corners[&0].detections, usual[&0].detections);
    assert!(messages(&corners[&0])[0].contains("corners"), "{corners:?}");
    let parts = read("parts", &file(|b| b.map(|n| n / 3760.0))).unwrap();
    assert!(parts[&0].detections.is_empty());
    assert!(messages(&parts[&0])[0].starts_with("MissingInput: the boxes are normalised"));
}

#[test]
fn texts_of_windows_are_read() {
    let utf16: Vec<u8> =
        format!("\u{feff}{RESULTS}").encode_utf16().flat_map(u16::to_le_bytes).collect();
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("utf16.json");
    for bytes in [utf16, format!("\u{feff}{RESULTS}").into_bytes()] {
        fs::write(&path, bytes).unwrap();
        assert_eq!(read_detections(&path, "cafe", IMAGE).unwrap(), read("utf8", RESULTS).unwrap());
    }
}
