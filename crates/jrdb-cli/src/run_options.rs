//! What a run is asked to do.

use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

use jrdb_models::PerceptionSource;
use jrdb_models::demographics::Demographics;
use jrdb_models::loader::EngineOptions;
use jrdb_pipeline::PipelineConfig;
use jrdb_types::Query;
use serde_json::{Value, json};

use crate::interrupt::Interrupt;
use crate::run_folder::Existing;
use crate::source::{RobotOptions, Source};

/// What to run, on what, and where to write.
#[derive(Debug, Clone, Default)]
pub struct RunOptions {
    /// Where frames come from.
    pub sources: Vec<Source>,
    /// Which rig and camera, where not the tree's own.
    pub robot: RobotOptions,
    /// Which frame numbers; all when absent.
    pub frames: Option<Range<u32>>,
    /// Where detections come from.
    pub perception: PerceptionSource,
    /// What small models may guess from faces.
    pub demographics: Demographics,
    /// How to choose an engine for models, and where they are.
    pub engine: EngineOptions,
    /// Whether the robot stands still throughout: then things that are tracked are seen to move.
    pub robot_stands: bool,
    /// Whether the detector answers every question by itself, without points, graph and search.
    pub baseline: bool,
    /// Questions asked of every frame, as they were read.
    pub queries: Vec<Arc<Query>>,
    /// A file of questions with their truth; the scenes' own when neither this nor a query is given.
    pub questions: Vec<PathBuf>,
    /// Configuration of the stages.
    pub config: PipelineConfig,
    /// Worker threads; one per core when absent. The output does not depend on it.
    pub threads: Option<usize>,
    /// Folder for answers and pictures.
    pub out: Option<PathBuf>,
    /// What is done when that folder holds another run.
    pub existing: Existing,
    /// Ends the run before the next frame.
    pub interrupt: Interrupt,
    /// Whether every stage's artefact is written too.
    pub artifacts: bool,
}

impl RunOptions {
    /// What of the options shapes the output.
    pub(crate) fn described(&self) -> Value {
        json!({
            "robot_stands": self.robot_stands, "baseline": self.baseline, "artifacts": self.artifacts,
            "demographics": format!("{:?}", self.demographics).to_lowercase(), "config": self.config,
        })
    }
}
