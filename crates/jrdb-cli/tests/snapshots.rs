//! Every stage's artefact for every bundled scene, against its committed snapshot.
//!
//! `cargo xtask pipeline --check` runs this and names the first stage that moved; `--accept` rewrites.
#![allow(clippy::panic, clippy::unwrap_used, reason = "a failing helper should panic")]
#![allow(clippy::print_stdout, reason = "figures and skipped tests are said aloud")]

use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::{Path, PathBuf};

use jrdb_cli::questions::Answered;
use jrdb_cli::source::Source;
use jrdb_cli::{FrameOutput, FrameResult, Run, RunOptions, RunSummary};
use serde_json::{Value, json};

const STAGES: [&str; 6] = ["detections", "entities", "scene_graph", "queries", "answers", "scores"];

fn scenes() -> Vec<(String, PathBuf)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata/scenes");
    let mut scenes: Vec<(String, PathBuf)> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap())
        .map(|entry| (entry.file_name().into_string().unwrap(), entry.path()))
        .collect();
    scenes.sort();
    scenes
}

fn frame_stage(output: &FrameOutput, stage: &str) -> Value {
    let asked = |pick: &dyn Fn(&Answered) -> Value| output.answered.iter().map(pick).collect();
    match stage {
        "detections" => json!(output.scene.detections()),
        "entities" => json!(output.scene.entities()),
        "scene_graph" => json!(output.scene.graph()),
        "queries" => asked(&|asked| json!(*asked.query)),
        "answers" => asked(&|asked| json!(jrdb_render::with_words(asked.answer.clone()))),
        other => panic!("{other} is no stage of a frame"),
    }
}

/// All that a run came to.
struct RunResult {
    frames: Vec<FrameResult>,
    summary: RunSummary,
}

fn run(options: &RunOptions) -> RunResult {
    let mut frames = Vec::new();
    let each = |frame| {
        frames.push(frame);
        ControlFlow::Continue(())
    };
    let summary = Run::open(options).unwrap().execute(each).unwrap();
    RunResult { frames, summary }
}

/// The snapshots of one stage of one scene: name and value.
fn stage(scene: &str, result: &RunResult, stage: usize) -> Vec<(String, Value)> {
    let named = |middle: &str| format!("{scene}{middle}-{}-{}", stage + 1, STAGES[stage]);
    if STAGES[stage] == "scores" {
        return vec![(named(""), json!(result.summary.scores))];
    }
    let frames = result.frames.iter().map(|frame| {
        let output = frame.output.as_ref().unwrap();
        (named(&format!("-{:06}", frame.id.frame)), frame_stage(output, STAGES[stage]))
    });
    frames.collect()
}

/// Numbers at six decimals: what differs beyond is the processor's business.
fn rounded(value: &Value) -> Value {
    match value {
        Value::Number(number) if number.is_f64() => {
            let number = number.as_f64().unwrap();
            json!((number * 1e6).round() / 1e6)
        }
        Value::Array(items) => items.iter().map(rounded).collect(),
        Value::Object(map) => {
            map.iter().map(|(key, value)| (key.clone(), rounded(value))).collect()
        }
        other => other.clone(),
    }
}

/// JSON made for the eye: one line per thing in a list.
fn lines(value: &Value, depth: usize) -> String {
    let inner = " ".repeat(2 * (depth + 1));
    let close = " ".repeat(2 * depth);
    match value {
        Value::Object(map) if depth < 2 && !map.is_empty() => {
            let fields = map
                .iter()
                .map(|(key, value)| format!("{inner}{key:?}: {}", lines(value, depth + 1)));
            format!("{{\n{}\n{close}}}", fields.collect::<Vec<_>>().join(",\n"))
        }
        Value::Array(items) if depth < 3 && items.iter().any(Value::is_object) => {
            let items = items.iter().map(|item| match item {
                Value::Object(_) if depth == 0 => format!("{inner}{}", lines(item, 1)),
                item => format!("{inner}{item}"),
            });
            format!("[\n{}\n{close}]", items.collect::<Vec<_>>().join(",\n"))
        }
        other => other.to_string(),
    }
}

#[test]
fn every_stage_is_as_it_was() {
    let scenes = scenes();
    let run_scene = |path: &PathBuf| {
        let sources = vec![Source::Scene(path.clone())];
        run(&RunOptions { sources, ..RunOptions::default() })
    };
    let results: Vec<RunResult> = scenes.iter().map(|(_, path)| run_scene(path)).collect();
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path("../../../testdata/snapshots");
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    // Stage by stage over all scenes, so that the first that fails is the first that moved.
    for (number, stage_name) in STAGES.iter().enumerate() {
        for ((scene, _), result) in scenes.iter().zip(&results) {
            for (name, value) in stage(scene, result, number) {
                let text = lines(&rounded(&value), 0);
                let compare = || settings.bind(|| insta::assert_snapshot!(name.clone(), text));
                if let Err(panic) = catch_unwind(AssertUnwindSafe(compare)) {
                    println!("\nthe first stage that moved is {stage_name}, in {name}");
                    resume_unwind(panic);
                }
            }
        }
    }
}

#[test]
fn every_bundled_question_is_answered_exactly() {
    let sources = scenes().into_iter().map(|(_, path)| Source::Scene(path)).collect();
    let result = run(&RunOptions { sources, ..RunOptions::default() });
    let scores = result.summary.scores.unwrap();
    for score in &scores.questions {
        assert_eq!(score.exact, Some(true), "{}: {}", score.frame, score.question);
        assert_eq!((score.false_positives, score.false_negatives), (0, 0), "{}", score.question);
    }
    assert!(scores.questions.len() >= 36, "the bundled scenes have questions");
}
