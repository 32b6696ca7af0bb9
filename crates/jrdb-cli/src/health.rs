//! What of a run's input could not be used: frame by frame, and for the whole run.

use std::collections::BTreeMap;

use jrdb_pipeline::Scene;
use jrdb_types::answer::Status;
use jrdb_types::issue::IssueKind;
use jrdb_types::{FrameId, Issue};
use serde::Serialize;

/// A part of a frame that could not be used although it was there, or should have been.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Fault {
    /// The stage that needed it.
    pub stage: &'static str,
    /// What kind of trouble.
    pub kind: IssueKind,
    /// What happened; names the file.
    pub message: String,
}

/// One frame of a run that was answered.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct FrameHealth {
    /// Which frame.
    pub frame: FrameId,
    /// Everything that was noticed about it.
    pub issues: Vec<Issue>,
    /// What of its input could not be used; empty when it is good.
    pub degraded: Vec<Fault>,
}

impl FrameHealth {
    /// The health of a frame that was answered.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let mut degraded: Vec<Fault> = staged(scene)
            .filter(|(_, issue)| degrades(issue.kind))
            .map(|(stage, issue)| Fault { stage, kind: issue.kind, message: message(issue) })
            .collect();
        degraded.sort();
        degraded.dedup_by(|a, b| a.message == b.message);
        Self { frame: scene.id().clone(), issues: issues(scene), degraded }
    }
}

/// The issues of a frame, each once: those of perception, then those of the places.
#[must_use]
pub fn issues(scene: &Scene) -> Vec<Issue> {
    let mut all: Vec<Issue> = Vec::new();
    for (_, issue) in staged(scene) {
        if !all.contains(issue) {
            all.push(issue.clone());
        }
    }
    all
}

/// The issues of a frame with the stage that reported them.
fn staged(scene: &Scene) -> impl Iterator<Item = (&'static str, &Issue)> {
    let perception = scene.detections().issues.iter().map(|issue| ("perception", issue));
    perception.chain(scene.entities().issues.iter().map(|issue| ("projection", issue)))
}

fn message(issue: &Issue) -> String {
    match &issue.subject {
        Some(subject) => format!("{}: {}", subject.short(), issue.message),
        None => issue.message.clone(),
    }
}

/// Whether an issue says that input was lost. That a box has few points, or a person no known heading, is ordinary.
fn degrades(kind: IssueKind) -> bool {
    matches!(
        kind,
        IssueKind::MissingInput
            | IssueKind::MissingLabels
            | IssueKind::DoubtfulInput
            | IssueKind::BadLabel
            | IssueKind::BadBox
            | IssueKind::NotDescribed
    )
}

/// How many frames of a run were good, and how many answers there are of each status.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
pub struct Health {
    /// All frames that were done or failed.
    pub frames: usize,
    /// Frames without faults.
    pub good: usize,
    /// Frames that were answered although a part of their input could not be used.
    pub degraded: usize,
    /// Frames that could not be done.
    pub failed: usize,
    /// Degraded frames by the kind of their faults; a frame may count under several.
    pub causes: BTreeMap<IssueKind, usize>,
    /// Answers by status.
    pub answers: BTreeMap<Status, usize>,
}

impl Health {
    /// Counts a frame that was answered.
    pub fn add(&mut self, frame: &FrameHealth) {
        self.frames += 1;
        if frame.degraded.is_empty() {
            self.good += 1;
            return;
        }
        self.degraded += 1;
        let mut kinds: Vec<IssueKind> = frame.degraded.iter().map(|fault| fault.kind).collect();
        kinds.sort();
        kinds.dedup();
        kinds.into_iter().for_each(|kind| *self.causes.entry(kind).or_default() += 1);
    }

    /// Counts a frame that could not be done.
    pub fn add_failed(&mut self) {
        self.frames += 1;
        self.failed += 1;
    }

    /// Counts an answer.
    pub fn add_answer(&mut self, status: Status) {
        *self.answers.entry(status).or_default() += 1;
    }

    /// Whether any answer is open.
    #[must_use]
    pub fn has_open_answers(&self) -> bool {
        self.answers.keys().any(|status| status.is_open())
    }

    /// The frames in a line; nothing to say of a run whose frames are all good.
    #[must_use]
    pub fn line(&self) -> Option<String> {
        let Self { frames, good, degraded, failed, .. } = self;
        if degraded + failed == 0 {
            return None;
        }
        let name = |kind: &IssueKind| serde_json::to_value(kind).ok()?.as_str().map(str::to_owned);
        let causes =
            self.causes.iter().filter_map(|(kind, n)| Some(format!("{} {n}", name(kind)?)));
        let causes: Vec<String> = causes.collect();
        let causes =
            if causes.is_empty() { String::new() } else { format!(" ({})", causes.join(", ")) };
        let plural = if *frames == 1 { "" } else { "s" };
        Some(format!(
            "{frames} frame{plural}: {good} good, {degraded} degraded{causes}, {failed} failed"
        ))
    }
}

/// The exit code of a run: 1 when a frame failed, or, where that is asked for, was degraded; 3 when an answer is open and
/// answers are required.
#[must_use]
pub fn exit_code(health: &Health, demands: Demands) -> u8 {
    if health.failed > 0 || (demands.strict && health.degraded > 0) {
        return 1;
    }
    if demands.require_answer && health.has_open_answers() { 3 } else { 0 }
}

/// What a run must achieve to succeed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Demands {
    /// No frame may be degraded.
    pub strict: bool,
    /// Every question must be answered.
    pub require_answer: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_counts_frames_by_kind_of_fault_and_good_runs_have_none() {
        let frame = |kinds: &[IssueKind]| FrameHealth {
            frame: FrameId::default(),
            issues: Vec::new(),
            degraded: kinds
                .iter()
                .map(|&kind| Fault { stage: "perception", kind, message: "gone".into() })
                .collect(),
        };
        let mut health = Health::default();
        health.add(&frame(&[]));
        assert_eq!(health.line(), None);
        health.add(&frame(&[IssueKind::MissingInput, IssueKind::MissingInput]));
        health.add(&frame(&[IssueKind::BadLabel, IssueKind::MissingInput]));
        health.add_failed();
        let line = "4 frames: 1 good, 2 degraded (missing_input 2, bad_label 1), 1 failed";
        assert_eq!(health.line().as_deref(), Some(line));
    }

    #[test]
    fn failures_weigh_more_than_open_answers() {
        let mut health = Health::default();
        health.add_answer(Status::Unknown);
        let both = Demands { strict: true, require_answer: true };
        assert_eq!(exit_code(&health, Demands::default()), 0);
        assert_eq!(exit_code(&health, both), 3);
        health.degraded = 1;
        assert_eq!(exit_code(&health, both), 1);
        assert_eq!(exit_code(&health, Demands { require_answer: true, ..Demands::default() }), 3);
    }
}
