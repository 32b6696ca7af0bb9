//! Studies: tables of several methods, from the outside.
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use jrdb_types::{Artefact, Detections, PixelBox};
use serde_json::{Value, json};
use tempfile::TempDir;

const SCENES: [&str; 3] = ["cafe", "corridor", "plaza"];

fn testdata() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata")
}

/// A plan on bundled scenes.
fn plan(folder: &TempDir, scenes: &[&str], rest: &str) -> PathBuf {
    let list = scenes.iter().map(|name| testdata().join("scenes").join(name).display().to_string());
    let list = json!(list.collect::<Vec<_>>());
    let everybody = json!(testdata().join("everybody.jsonl").display().to_string());
    let text = format!(
        "title: Test\ndata: {{scenes: {list}}}\nmethods:\n  - {{name: everybody, answers: [{everybody}]}}\n  \
         - {{name: labels, perception: labels}}\n{rest}"
    );
    let path = folder.path().join("study.yaml");
    std::fs::write(&path, text).unwrap();
    path
}

fn study(plan: &Path, out: &Path, more: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_jrdb"));
    command.arg("study").arg(plan).arg("--out").arg(out).args(more).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// All files with their bytes, but for the times.
fn contents(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let (path, name) = entry.map(|entry| (entry.path(), entry.file_name())).unwrap();
        if path.is_dir() {
            let below = contents(&path).into_iter();
            found.extend(below.map(|(below, bytes)| (Path::new(&name).join(below), bytes)));
        } else if name != "timings.json" {
            found.insert(name.into(), std::fs::read(path).unwrap());
        }
    }
    found
}

#[test]
fn its_files_are_the_same_with_any_number_of_threads_and_again() {
    let folder = TempDir::new().unwrap();
    let plan = plan(&folder, &SCENES, "error_budget: labels\n");
    let [one, two] = ["one", "two"].map(|name| folder.path().join(name));
    let first = study(&plan, &one, &["--threads", "1"]);
    assert!(first.status.success(), "{}", text(&first.stderr));
    assert!(study(&plan, &two, &["--threads", "2"]).status.success());
    assert_eq!(contents(&one), contents(&two));
    std::fs::remove_file(one.join("methods/labels/recordings/plaza_0.json")).unwrap();
    let again = study(&plan, &one, &[]);
    assert_eq!(text(&again.stdout), text(&first.stdout));
    assert_eq!(contents(&one), contents(&two));
}

#[test]
fn labels_are_right_everybody_is_a_baseline_and_nothing_is_lost_when_the_truth_is_given() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out");
    let ran = study(&plan(&folder, &SCENES, "error_budget: labels\n"), &out, &[]);
    assert!(ran.status.success(), "{}", text(&ran.stderr));
    let found: Value =
        serde_json::from_str(&std::fs::read_to_string(out.join("study.json")).unwrap()).unwrap();
    let rows = &found["tables"][0]["table"]["rows"];
    assert_eq!((&rows[0]["role"], &rows[1]["role"]), (&json!("baseline"), &json!("method")));
    let percents = |row: &Value| -> Vec<f64> {
        row["cells"].as_array().unwrap().iter().filter_map(|c| c["value"].as_f64()).collect()
    };
    assert!(percents(&rows[1]).iter().all(|percent| *percent == 100.0), "{rows}");
    assert!(percents(&rows[0]).iter().any(|percent| *percent < 50.0), "{rows}");
    let exact = &found["error_budget"]["exact"];
    assert_eq!(exact["with_all"], 1.0, "169 of 169");
    assert!(text(&ran.stdout).contains("fewer than ten recordings"));
}

#[test]
fn one_recording_gives_no_interval_and_says_so() {
    let folder = TempDir::new().unwrap();
    let ran = study(&plan(&folder, &["plaza"], ""), &folder.path().join("out"), &[]);
    let said = text(&ran.stdout);
    assert!(said.contains("One recording gives no interval.") && !said.contains('±'), "{said}");
}

#[test]
fn a_method_that_fails_is_a_row_and_the_rest_is_written() {
    let folder = TempDir::new().unwrap();
    let plan = plan(&folder, &["plaza"], "  - {name: missing, perception: no-such-model}\n");
    let ran = study(&plan, &folder.path().join("out"), &[]);
    assert_eq!(ran.status.code(), Some(1));
    let table = std::fs::read_to_string(folder.path().join("out/table-1.txt")).unwrap();
    assert!(table.contains("missing failed: ") && table.contains("no-such-model"), "{table}");
    assert!(table.contains("100.00"), "{table}");
}

#[test]
fn questions_about_a_frame_that_fails_are_missed_and_the_other_recordings_count() {
    let folder = TempDir::new().unwrap();
    let broken = folder.path().join("plaza");
    copy(&testdata().join("scenes/plaza"), &broken);
    let labels = broken.join("labels/labels_2d_stitched/plaza_0.json");
    std::fs::write(labels, "no labels").unwrap();
    let path = plan(&folder, &["plaza", "cafe"], "");
    let whole = testdata().join("scenes/plaza").display().to_string();
    let text_of_plan = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, text_of_plan.replace(&whole, &broken.display().to_string())).unwrap();
    let ran = study(&path, &folder.path().join("out"), &[]);
    assert_eq!(ran.status.code(), Some(1));
    let said = text(&ran.stderr);
    let failed = "labels: a frame failed, questions about it are missed: plaza_0";
    assert!(said.contains(failed), "{said}");
    let slices = folder.path().join("out/methods/labels/slices.txt");
    let slices = std::fs::read_to_string(slices).unwrap();
    let row = |name: &str| slices.lines().find(|line| line.contains(name)).unwrap().to_owned();
    assert!(row("cafe_0").contains("100.00") && row("plaza_0 (43)").contains(" 0.00"), "{slices}");
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let (path, copied) = (entry.path(), to.join(entry.file_name()));
        if path.is_dir() {
            copy(&path, &copied);
        } else {
            std::fs::copy(&path, &copied).unwrap();
        }
    }
}

#[test]
fn what_a_plan_names_and_is_not_there_is_told_with_what_is() {
    let folder = TempDir::new().unwrap();
    let table = "tables: [{title: t, categories: [ages]}]\n";
    let ran = study(&plan(&folder, &["plaza"], table), &folder.path().join("out"), &[]);
    let said = text(&ran.stderr);
    assert_eq!(ran.status.code(), Some(2), "{said}");
    assert!(said.contains("\"ages\"") && said.contains("gender-age-race"), "{said}");
    let unknown = study(&plan(&folder, &["nowhere"], ""), &folder.path().join("out"), &[]);
    assert_eq!(unknown.status.code(), Some(2));
    assert!(text(&unknown.stderr).contains("nowhere"));
}

/// `everybody.jsonl` answers each bundled question with all people who are there. `UPDATE_TESTDATA=1`
/// writes it anew.
#[test]
fn everybody_answers_every_question_with_all_people() {
    let mut lines = Vec::new();
    for scene in SCENES {
        let folder = testdata().join("scenes").join(scene);
        let people = people(&folder.join("detections.json"));
        let questions = jrdb_dataset::read_questions(&folder.join("questions.json")).unwrap();
        for question in questions.questions {
            let boxes = &people[&question.frame];
            let frame = json!({"sequence": question.frame.sequence, "frame": question.frame.frame});
            lines.push(json!({"frame": frame, "question": question.text, "boxes": boxes}));
        }
    }
    let wanted: String = lines.iter().map(|line| format!("{line}\n")).collect();
    let path = testdata().join("everybody.jsonl");
    if std::env::var_os("UPDATE_TESTDATA").is_some() {
        std::fs::write(&path, &wanted).unwrap();
    }
    assert_eq!(std::fs::read_to_string(&path).unwrap(), wanted);
}

/// The boxes of the people of each frame.
fn people(path: &Path) -> BTreeMap<jrdb_types::FrameId, Vec<PixelBox>> {
    let text = std::fs::read_to_string(path).unwrap();
    let all: Vec<Artefact<Detections>> = serde_json::from_str(&text).unwrap();
    let frame = |one: Artefact<Detections>| {
        let people = one.data.detections.into_iter().filter(|d| d.category == "person");
        (one.data.frame, people.map(|d| d.bbox).collect())
    };
    all.into_iter().map(frame).collect()
}

#[test]
fn methods_of_a_study_are_compared_and_a_method_with_itself_does_not_differ() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out");
    assert!(study(&plan(&folder, &SCENES, ""), &out, &[]).status.success());
    let compare = |a: &str, b: &str| {
        let name = |method: &str| format!("{}:{method}", out.display());
        let mut command = Command::new(env!("CARGO_BIN_EXE_jrdb"));
        command.args(["compare", &name(a), &name(b), "--format", "json"]).output().unwrap()
    };
    let same: Value = serde_json::from_slice(&compare("labels", "labels").stdout).unwrap();
    let all = same["data"]["overall"].as_array().unwrap();
    assert!(!all.is_empty());
    for one in all {
        assert_eq!((&one["difference"], &one["interval"]["low"]), (&json!(0.0), &json!(0.0)));
        assert_eq!(one["interval"]["high"], 0.0);
    }
    let other: Value = serde_json::from_slice(&compare("everybody", "labels").stdout).unwrap();
    assert!(other["data"]["fixed"].as_array().unwrap().len() > 100, "{other}");
    assert_eq!(other["data"]["broken"], json!([]));
    let unknown = compare("labels", "nobody");
    assert_eq!(unknown.status.code(), Some(2));
    assert!(text(&unknown.stderr).contains("(everybody, labels), found \"nobody\""));
}

/// The requests of a baseline on a scene, each answered with the true boxes in the form of a model.
fn answered_requests(folder: &Path, scene: &str) -> PathBuf {
    let scene = testdata().join("scenes").join(scene);
    let out = folder.join("exchange");
    let asked = Command::new(env!("CARGO_BIN_EXE_jrdb"))
        .args(["exchange", "--perception", "labels", "--scene"])
        .arg(&scene)
        .arg("--questions")
        .arg(scene.join("questions.json"))
        .arg("--out")
        .arg(&out)
        .output()
        .unwrap();
    assert!(asked.status.success(), "{}", text(&asked.stderr));
    let truth = jrdb_dataset::read_questions(&scene.join("questions.json")).unwrap().questions;
    let boxes = |sentence: &Value| {
        let one = truth.iter().find(|one| json!(one.text) == *sentence).unwrap();
        one.truth.clone().unwrap().boxes
    };
    // A model that sees the image 1,000 wide and high, whatever its size.
    let [wide, high] = [3760.0, 480.0].map(|px| 1000.0 / px);
    let corner = |b: PixelBox| {
        let [x1, y1] = [b.x + b.w, b.y + b.h];
        format!("<box>[[{}, {}, {}, {}]]</box>", b.x * wide, b.y * high, x1 * wide, y1 * high)
    };
    let path = out.join("exchange.jsonl");
    let lines = std::fs::read_to_string(&path).unwrap();
    let lines = lines.lines().map(|line| {
        let mut line: Value = serde_json::from_str(line).unwrap();
        let said: String = boxes(&line["request"]["sentence"]).into_iter().map(corner).collect();
        line["reply"] = json!({"text": said, "size": [1000, 1000]});
        format!("{line}\n")
    });
    std::fs::write(&path, lines.collect::<String>()).unwrap();
    path
}

#[test]
fn recorded_replies_to_whole_questions_are_a_baseline() {
    let folder = TempDir::new().unwrap();
    let replies = answered_requests(folder.path(), "plaza");
    let file = replies.display();
    let method =
        format!("  - {{name: model, perception: \"replay:{file}\", detector_alone: true}}\n");
    let out = folder.path().join("out");
    let ran = study(&plan(&folder, &["plaza"], &method), &out, &[]);
    assert!(ran.status.success(), "{}", text(&ran.stderr));
    let path = out.join("methods/model/scores.json");
    let scores: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let overall = &scores["data"]["overall"];
    assert_eq!(
        (&overall["recall"], &overall["precision"]),
        (&json!(1.0), &json!(1.0)),
        "{overall}"
    );
    // A question without a line is open, and the others count.
    let lines = std::fs::read_to_string(&replies).unwrap();
    let kept: String = lines.lines().skip(1).map(|line| format!("{line}\n")).collect();
    std::fs::write(&replies, kept).unwrap();
    let out = folder.path().join("fewer");
    let ran = study(&plan(&folder, &["plaza"], &method), &out, &[]);
    assert!(ran.status.success(), "{}", text(&ran.stderr));
    let path = out.join("methods/model/scores.json");
    let scores: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let recall = scores["data"]["overall"]["recall"].as_f64().unwrap();
    assert!((0.9..1.0).contains(&recall), "{recall}");
}

#[test]
fn places_sides_and_slices_stand_beside_the_scores() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out");
    let ran = study(&plan(&folder, &SCENES, ""), &out, &[]);
    assert!(ran.status.success(), "{}", text(&ran.stderr));
    let read = |name: &str| std::fs::read_to_string(out.join("methods").join(name)).unwrap();
    let places = read("labels/places.txt");
    assert!(places.contains("at any range  36.00  100.00  100.00"), "{places}");
    assert!(read("labels/sides.txt").contains("left taken for left: 9\n"));
    let slices = read("labels/slices.txt");
    let keys = ["range 0 to 3 m", "occlusion fully visible", "frame of reference the robot's"];
    for key in keys.iter().chain(&["points of a person 10 to 99", "people in the frame 10 to 19"]) {
        assert!(slices.contains(key), "{key}: {slices}");
    }
    assert!(read("labels/reliability.svg").contains("<circle"));
    // Answers of other programs have no places.
    assert!(!out.join("methods/everybody/places.txt").exists());
}

#[test]
fn a_misread_question_is_a_gap_that_parsing_closes() {
    let folder = TempDir::new().unwrap();
    let questions = testdata().join("scenes/plaza/questions.json");
    let mut asked: Value =
        serde_json::from_str(&std::fs::read_to_string(questions).unwrap()).unwrap();
    let question = &mut asked[0]["question"];
    assert_eq!(question["query"], "find person[standing]");
    question["question"] = json!("Find persons who are sitting");
    let path = folder.path().join("questions.json");
    std::fs::write(&path, asked.to_string()).unwrap();
    let out = folder.path().join("out");
    let flags = ["--questions", path.to_str().unwrap()];
    let ran = study(&plan(&folder, &["plaza"], "error_budget: labels\n"), &out, &flags);
    // The answers of "everybody" are to other words.
    assert!(text(&ran.stdout).contains("error budget of exact"), "{}", text(&ran.stderr));
    let found: Value =
        serde_json::from_str(&std::fs::read_to_string(out.join("study.json")).unwrap()).unwrap();
    let budget = &found["error_budget"]["exact"];
    let parsing = budget["shares"].as_array().unwrap().last().unwrap();
    let gap = budget["with_all"].as_f64().unwrap() - budget["without"].as_f64().unwrap();
    assert_eq!(parsing["truth"], "parsing");
    assert!(gap > 0.0 && (parsing["shapley"].as_f64().unwrap() - gap).abs() < 1e-12, "{budget}");
}

/// The real frame: people and, so that there is something to score, where the reference has them.
#[test]
fn the_table_of_light_on_the_real_frame_says_that_one_recording_gives_no_interval() {
    let shared = std::env::var_os("JRDB_SHARED").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared"),
        PathBuf::from,
    );
    let table = shared.join("data/frame0_box_points_reference.csv");
    let models = shared.join("models");
    if !table.exists() || !models.exists() {
        println!("skipped: no shared data");
        return;
    }
    let boxes: Vec<Vec<f64>> = std::fs::read_to_string(table)
        .unwrap()
        .lines()
        .skip(1)
        .map(|line| line.split(',').skip(1).take(4).map(|cell| cell.parse().unwrap()).collect())
        .collect();
    let question = json!([{
        "category": "human", "task_type": "VG",
        "data": {"seq": "bytes-cafe-2019-02-07_0.json", "modality_type": "image"},
        "question": {"question": "Find all persons", "timestamps": {"slot1": {"image_ids": ["000000.jpg"]}}},
        "labels": {"slot1": {"final_bbox": boxes}},
    }]);
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("questions.json");
    std::fs::write(&path, question.to_string()).unwrap();
    let plan = folder.path().join("study.yaml");
    let data = json!({
        "title": "The real frame",
        "data": {
            "dataset": shared.join("data/jrdb-sample"),
            "sequences": ["bytes-cafe-2019-02-07_0"],
            "frames": "0..1",
            "questions": path,
        },
        "methods": [{"name": "light", "perception": "light"}],
    });
    std::fs::write(&plan, data.to_string()).unwrap();
    let out = folder.path().join("out");
    let ran = study(&plan, &out, &["--models", models.to_str().unwrap()]);
    assert!(ran.status.success(), "{}", text(&ran.stderr));
    let said = text(&ran.stdout);
    assert!(said.contains("One recording gives no interval."), "{said}");
}
