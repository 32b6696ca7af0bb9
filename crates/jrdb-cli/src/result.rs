//! What a run comes to.

use jrdb_pipeline::Scene;
use jrdb_types::{FrameId, Scores};

use crate::Error;
use crate::health::Health;
use crate::questions::Answered;

/// One frame's result.
pub struct FrameResult {
    /// Which frame.
    pub id: FrameId,
    /// Its scene and answers, or why it could not be done; other frames go on.
    pub output: Result<FrameOutput, Error>,
}

/// A scene and the answers to the questions about it.
pub struct FrameOutput {
    /// The scene.
    pub scene: Scene,
    /// Its questions with their answers; those about time are the recording's.
    pub answered: Vec<Answered>,
    /// Why its files could not be written; the frame then counts as failed, and its answers are there all the same.
    pub unwritten: Option<Error>,
}

/// What a run came to, besides the frames.
#[derive(Debug, Default)]
pub struct RunSummary {
    /// Questions about time with their answers, one for each recording they were asked of.
    pub recordings: Vec<Answered>,
    /// Scores, when any question had a known answer.
    pub scores: Option<Scores>,
    /// Questions of the file that no frame of this run could answer.
    pub unasked: usize,
    /// Whether the run was ended before all its frames were worked on.
    pub is_cut_short: bool,
    /// Frames that could not be done, and why.
    pub failures: Vec<(FrameId, String)>,
    /// How many frames were good, and how many questions are open.
    pub health: Health,
}
