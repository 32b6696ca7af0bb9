//! What the command says when it does not know: status, causes, faults of frames, exit codes.
#![allow(clippy::panic, clippy::unwrap_used, reason = "a failing helper should panic")]

mod tree;

use std::path::PathBuf;
use std::process::Command;

use serde_json::{Value, json};
use tempfile::TempDir;

/// A dataset of two people, 3 m ahead and 3 m to the left, to be broken.
struct Scene(TempDir);

impl Scene {
    fn new() -> Self {
        let folder = TempDir::new().unwrap();
        tree::write(folder.path());
        Self(folder)
    }

    fn cloud(&self, sensor: &str) -> PathBuf {
        self.0.path().join(format!("pointclouds/{sensor}/{}/000000.pcd", tree::SEQUENCE))
    }

    /// Exit code and standard output of a question about the first frame.
    fn ask(&self, question: &str, flags: &[&str]) -> (i32, String) {
        let mut command = Command::new(env!("CARGO_BIN_EXE_jrdb"));
        command.args(["run", "--scene"]).arg(self.0.path());
        command.args(["--frames", "0..1", "--query", question]).args(flags);
        let output = command.output().unwrap();
        (output.status.code().unwrap(), String::from_utf8(output.stdout).unwrap())
    }

    /// The whole document, and the data of its only answer.
    fn json(&self, question: &str) -> (Value, Value) {
        let document: Value =
            serde_json::from_str(&self.ask(question, &["--format", "json"]).1).unwrap();
        let answer = document["answers"][0]["data"].clone();
        (document, answer)
    }
}

fn causes(answer: &Value) -> Vec<&str> {
    let because = answer["because"].as_array().unwrap();
    because.iter().map(|cause| cause["kind"].as_str().unwrap()).collect()
}

#[test]
fn an_intact_frame_is_answered_and_good() {
    let (document, answer) = Scene::new().json("is anyone behind me?");
    assert_eq!(
        (&answer["status"], &answer["reply"]["yes_no"]),
        (&json!("answered"), &json!(false))
    );
    assert_eq!(document["summary"]["good"], 1);
    assert_eq!(document["frames"][0]["degraded"], json!([]));
}

#[test]
fn a_missing_sweep_leaves_no_open_and_yes_as_it_is() {
    let scene = Scene::new();
    std::fs::remove_file(scene.cloud("upper_velodyne")).unwrap();
    let (document, answer) = scene.json("is anyone behind me?");
    assert_eq!((&answer["status"], &answer["reply"]["yes_no"]), (&json!("unknown"), &Value::Null));
    assert!(causes(&answer).contains(&"sensor"), "{answer}");
    let fault = &document["frames"][0]["degraded"][0];
    assert_eq!(fault["stage"], "projection");
    assert!(fault["message"].as_str().unwrap().contains("upper_velodyne"), "{fault}");
    let (_, answer) = scene.json("is anyone within 4 metres?");
    assert_eq!(answer["reply"]["yes_no"], true);
}

#[test]
fn counts_have_bounds_and_those_who_may_be_meant_are_named() {
    let (_, answer) = Scene::new().json("how many women wear striped shirts?");
    assert_eq!(answer["status"], "unknown");
    let number = &answer["reply"]["number"];
    let possible = answer["possible"].as_array().unwrap();
    assert_eq!(number["at_least"], 0);
    assert_eq!(number["at_most"].as_u64().unwrap() as usize, possible.len());
    assert_eq!(causes(&answer), ["perception"]);
}

#[test]
fn what_labels_do_not_hold_is_not_denied() {
    let scene = Scene::new();
    let (_, answer) = scene.json("is there a zebra crossing?");
    assert_eq!(answer["status"], "unknown");
    let (_, answer) = scene.json("who is next to a bench?");
    assert_eq!((&answer["status"], causes(&answer)[0]), (&json!("unknown"), "perception"));
}

#[test]
fn nobody_and_the_nearest_are_told_apart_from_an_answer() {
    let (_, answer) = Scene::new().json("the man within 1 metre");
    assert_eq!(answer["status"], "nearest");
    let (code, text) = Scene::new().ask("the man within 1 metre", &["--require-answer"]);
    assert_eq!(code, 0, "the nearest is an answer: nobody");
    assert!(text.contains("answer  nobody"), "{text}");
}

#[test]
fn exit_codes_tell_open_answers_and_degraded_frames() {
    let scene = Scene::new();
    assert_eq!(scene.ask("which of them is a nurse?", &[]).0, 0);
    assert_eq!(scene.ask("which of them is a nurse?", &["--require-answer"]).0, 3);
    assert_eq!(scene.ask("the man", &["--strict"]).0, 0);
    std::fs::write(scene.cloud("lower_velodyne"), b"").unwrap();
    assert_eq!(scene.ask("the man", &[]).0, 0);
    assert_eq!(scene.ask("the man", &["--strict"]).0, 1);
}

#[test]
fn lines_of_json_are_answers_and_then_the_summary() {
    let scene = Scene::new();
    let (_, text) =
        scene.ask("the man", &["--query", "which of them is a nurse?", "--format", "jsonl"]);
    let lines: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(lines.len(), 3);
    assert_eq!(
        (&lines[0]["schema"], &lines[1]["schema"]),
        (&json!("jrdb.answer"), &json!("jrdb.answer"))
    );
    assert_eq!(lines[2]["summary"]["answers"], json!({ "answered": 1, "unknown": 1 }));
}

#[test]
fn the_engine_keeps_its_closed_world() {
    let (_, text) = Scene::new().ask("is there a bench?", &["--semantics", "engine"]);
    assert!(text.contains("answer  no"), "{text}");
}
