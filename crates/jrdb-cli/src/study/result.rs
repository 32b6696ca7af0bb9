//! What a study comes to.

use std::time::Duration;

use jrdb_study::{Placements, Table};
use jrdb_types::Scores;
use jrdb_types::score::{Budget, Metric};

/// What a study came to.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyResult {
    /// Its tables.
    pub tables: Vec<Table>,
    /// The parameters of the models.
    pub parameters: Table,
    /// The gap of one method, split among the stages, by metric.
    pub budget: Vec<(Metric, Budget)>,
    /// Methods that failed, or of which frames failed, and why.
    pub failures: Vec<(String, String)>,
}

/// What one method came to.
pub(super) struct MethodRun {
    pub(super) scores: Scores,
    /// Why not all frames could be done.
    pub(super) failed: Option<String>,
    /// How people were placed beside how they stand.
    pub(super) placements: Placements,
}

impl MethodRun {
    /// Scores of another program, whose scenes are not known.
    pub(super) fn of_scores(scores: Scores) -> Self {
        Self { scores, failed: None, placements: Placements::default() }
    }
}

/// How long frames and questions took.
pub(super) struct Timing {
    /// From the first frame to the last.
    pub(super) took: Duration,
    /// How many frames.
    pub(super) frames: usize,
    /// How many questions.
    pub(super) questions: usize,
}

/// The error budgets in words.
#[must_use]
pub fn budget_text(budgets: &[(Metric, Budget)]) -> String {
    let words = |(metric, budget): &(Metric, Budget)| {
        format!("error budget of {}\n{}\n", metric.name(), jrdb_render::budget(budget))
    };
    budgets.iter().map(words).collect()
}
