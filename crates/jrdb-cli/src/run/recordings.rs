//! The recordings that a run goes through, each on its own.

use std::collections::BTreeMap;

use jrdb_metrics::evaluate_all;
use jrdb_types::score::{Protocol, QuestionScore};
use jrdb_types::{FrameId, Question};
use serde_json::{Value, json};

use super::Run;
use crate::description::{Work, describe};
use crate::inputs::Inputs;
use crate::questions::{FrameQuestions, ReadQuestion};

impl Run<'_> {
    /// The recordings, in order.
    #[must_use]
    pub fn recordings(&self) -> Vec<String> {
        let mut names: Vec<String> =
            self.frames.iter().map(|frame| frame.id.sequence.clone()).collect();
        names.dedup();
        names
    }

    /// How many frames each recording has.
    #[must_use]
    pub fn frame_counts(&self) -> BTreeMap<String, usize> {
        let mut counts = BTreeMap::new();
        for frame in &self.frames {
            *counts.entry(frame.id.sequence.clone()).or_default() += 1;
        }
        counts
    }

    /// Leaves some recordings only.
    pub fn keep(&mut self, is_wanted: impl Fn(&str) -> bool) {
        let frames = std::mem::take(&mut self.frames).into_iter();
        let questions = std::mem::take(&mut self.questions.per_frame);
        let all = frames.zip(questions).filter(|(frame, _)| is_wanted(&frame.id.sequence));
        (self.frames, self.questions.per_frame) = all.unzip();
    }

    /// Whether a question about a recording speaks of time: its answer comes with the last frame.
    #[must_use]
    pub fn asks_about_time(&self, recording: &str) -> bool {
        let all = self.frames.iter().zip(&self.questions.per_frame);
        let mut own = all.filter(|(frame, _)| frame.id.sequence == recording);
        own.any(|(_, questions)| questions.iter().any(ReadQuestion::speaks_of_time))
    }

    /// All that determines the scores of a recording.
    #[must_use]
    pub fn description_of(&self, recording: &str) -> Value {
        let all = self.frames.iter().zip(&self.questions.per_frame);
        let own = all.filter(|(frame, _)| frame.id.sequence == recording);
        let (frames, per_frame): (Vec<_>, Vec<_>) =
            own.map(|(frame, questions)| (frame.clone(), questions.clone())).unzip();
        let questions = FrameQuestions { per_frame, unasked: 0 };
        let (robot, source) = (&self.options.robot, &self.options.perception);
        let perception = &self.perception;
        let work = Work { frames: &frames, questions: &questions, robot, source, perception };
        let mut described = describe(&work, &self.options.described());
        described["file_sizes"] = json!(Inputs::sizes(&frames));
        described
    }

    /// The judgements of the questions of a frame that could not be done: they are missed.
    #[must_use]
    pub fn missed(&self, frame: &FrameId) -> Vec<QuestionScore> {
        let mut all = self.frames.iter().zip(&self.questions.per_frame);
        let own = all.find(|(source, _)| source.id == *frame).map(|(_, questions)| questions);
        let of_now = own.into_iter().flatten().filter(|one| !one.speaks_of_time());
        let questions: Vec<&Question> = of_now.map(|one| &one.question).collect();
        evaluate_all(&[], &questions, &self.metrics).questions
    }

    /// By which rules answers are judged. Which questions are asked is no part of it.
    #[must_use]
    pub fn protocol(&self) -> Protocol {
        Protocol { questions_digest: None, ..self.metrics.protocol() }
    }
}
