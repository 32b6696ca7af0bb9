//! All that determines the bytes of a run's files.

use std::collections::BTreeSet;

use jrdb_models::{Perception, PerceptionSource, sha256_hex};
use jrdb_perception::Perceive;
use jrdb_types::Question;
use serde_json::{Value, json};

use crate::inputs::Inputs;
use crate::questions::FrameQuestions;
use crate::source::{FrameSource, RigChoice, RobotOptions};

/// What a note about the engine begins with; the library's path follows after a comma.
const ENGINE_NOTE: &str = "engine: ";

/// What a run works on.
pub(crate) struct Work<'a> {
    /// The frames.
    pub(crate) frames: &'a [FrameSource],
    /// Their questions.
    pub(crate) questions: &'a FrameQuestions,
    /// Which rig and camera.
    pub(crate) robot: &'a RobotOptions,
    /// Where detections come from.
    pub(crate) source: &'a PerceptionSource,
    /// The same, opened.
    pub(crate) perception: &'a Perception,
}

/// Questions, frames and inputs of a run beside its `options`: not how many threads work on it, nor where its files are.
#[must_use]
pub(crate) fn describe(work: &Work<'_>, options: &Value) -> Value {
    let Work { frames, questions, robot, source, perception } = work;
    let all = || questions.per_frame.iter().flatten().map(|one| &one.question);
    let texts: BTreeSet<&str> = all().map(|question| question.text.as_str()).collect();
    let asked: Vec<&Question> = all().collect();
    let engine = perception.notes().iter().find_map(|note| note.strip_prefix(ENGINE_NOTE));
    let engine = engine.map(|note| note.split(',').next().unwrap_or_default());
    json!({
        "frames": frames.iter().map(|frame| frame.id.to_string()).collect::<Vec<_>>(),
        "questions": texts,
        "questions_sha256": sha256_hex(json!(asked).to_string().as_bytes()),
        "perception": perception.config(),
        "engine": engine,
        "camera": robot.camera,
        "rig": kind(&robot.rig),
        "options": options,
        "inputs": Inputs::shared(frames, &robot.rig, source),
    })
}

/// Which kind of rig; a file's digest is among the inputs.
fn kind(rig: &RigChoice) -> &'static str {
    match rig {
        RigChoice::Tree => "tree",
        RigChoice::JrdbRefined => "jrdb-refined",
        RigChoice::File(_) => "file",
    }
}
