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
