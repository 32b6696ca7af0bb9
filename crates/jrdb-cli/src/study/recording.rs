//! The recordings of one method: run where their scores are missing.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::time::Instant;

use jrdb_metrics::{from_judgements, merge};
use jrdb_models::sha256_hex;
use jrdb_study::{Method, Placements};
use jrdb_types::score::QuestionScore;
use jrdb_types::{FrameId, Scores};

use super::result::{MethodRun, Timing};
use super::truth::Labelled;
use super::{Step, Study, files};
use crate::questions::Answered;
use crate::run::Run;
use crate::run_options::RunOptions;
use crate::{Error, FrameResult};

impl Study<'_> {
    /// The scores of all recordings of a method, and which frames failed. Models are loaded once.
    pub(super) fn recordings(
        &self,
        method: &Method,
        labelled: &Labelled<'_>,
        on_step: &mut impl FnMut(&Step<'_>),
    ) -> Result<MethodRun, Error> {
        let options = RunOptions { sources: self.sources.clone(), ..self.run_options(method)? };
        let mut run = Run::open(&options)?;
        let mut shelf = Shelf::new(self, method, &run);
        for name in shelf.known.keys() {
            on_step(&Step { method: &method.name, what: name.clone() });
        }
        run.keep(|recording| !shelf.known.contains_key(recording));
        let counts = run.frame_counts();
        let mut trouble = None;
        let started = Instant::now();
        let summary = run.execute(|result| {
            let recording = result.id.sequence.clone();
            if !method.detector_alone {
                shelf.place(&result, labelled);
            }
            shelf.add(result, &run);
            let is_done = shelf.frames(&recording) == counts[&recording];
            if is_done {
                on_step(&Step { method: &method.name, what: recording.clone() });
                trouble = shelf.put(&recording, &run).err();
            }
            if trouble.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })?;
        trouble.map_or(Ok(()), Err)?;
        if summary.is_cut_short {
            return Err(Error::Usage("interrupted before the last recording".into()));
        }
        let questions = shelf.questions + summary.recordings.len();
        let timing = Timing { took: started.elapsed(), frames: run.frame_count(), questions };
        files::write_timing(&self.options.out, &method.name, &timing)?;
        let (failed, placements) = (shelf.failures(), shelf.placements());
        Ok(MethodRun { scores: shelf.finish(&summary.recordings, &run)?, failed, placements })
    }
}

/// Scores of recordings: those that are known, and judgements of those that are being run.
struct Shelf<'s> {
    study: &'s Study<'s>,
    method: &'s Method,
    /// All recordings in order, with the digest of what determines their scores.
    digests: Vec<(String, String)>,
    known: BTreeMap<String, Scores>,
    judged: BTreeMap<String, (usize, Vec<QuestionScore>)>,
    /// How people were placed beside how they stand, by recording.
    placed: BTreeMap<String, Placements>,
    /// How many questions about frames have been answered.
    questions: usize,
    /// Frames that could not be done, and why.
    failed: Vec<(FrameId, String)>,
}

impl<'s> Shelf<'s> {
    fn new(study: &'s Study<'s>, method: &'s Method, run: &Run<'_>) -> Self {
        let digest = |name: String| {
            let digest = sha256_hex(run.description_of(&name).to_string().as_bytes());
            (name, digest)
        };
        let digests: Vec<_> = run.recordings().into_iter().map(digest).collect();
        let (mut known, mut placed) = (BTreeMap::new(), BTreeMap::new());
        for (name, digest) in &digests {
            let path = files::recording(&study.options.out, &method.name, name);
            if let Some((scores, placements)) = files::known(&path, digest) {
                known.insert(name.clone(), scores);
                placed.insert(name.clone(), placements);
            }
        }
        let judged = BTreeMap::new();
        Self { study, method, known, digests, judged, placed, questions: 0, failed: Vec::new() }
    }

    /// Compares where people of a frame were placed with where its labels have them.
    fn place(&mut self, FrameResult { id, output }: &FrameResult, labelled: &Labelled<'_>) {
        let (Ok(output), Some(frame)) = (output, labelled.frames.get(id)) else { return };
        let Some(truth) = labelled.truth.scene(frame) else { return };
        let period_px = frame.robot.image().period_px();
        let found = Placements::of(output.scene.graph(), truth.graph(), period_px);
        self.placed.entry(id.sequence.clone()).or_default().extend(found);
    }

    /// How people of all recordings were placed.
    fn placements(&self) -> Placements {
        let mut all = Placements::default();
        self.placed.values().for_each(|one| all.extend(one.clone()));
        all
    }

    /// Which frames failed, in words.
    fn failures(&self) -> Option<String> {
        let (first, why) = self.failed.first()?;
        let frames = match self.failed.len() {
            1 => "a frame".to_owned(),
            count => format!("{count} frames, the first"),
        };
        Some(format!("{frames} failed, questions about it are missed: {first}: {why}"))
    }

    /// How many frames of a recording have been judged.
    fn frames(&self, recording: &str) -> usize {
        self.judged.get(recording).map_or(0, |(frames, _)| *frames)
    }

    /// Adds what a frame came to. The questions of one that failed are missed.
    fn add(&mut self, FrameResult { id, output }: FrameResult, run: &Run<'_>) {
        let scores: Vec<QuestionScore> = match output {
            Ok(output) => {
                self.questions += output.answered.len();
                output.answered.into_iter().filter_map(|one| one.score).collect()
            }
            Err(error) => {
                self.failed.push((id.clone(), jrdb_types::with_causes(&error)));
                run.missed(&id)
            }
        };
        let (frames, judged) = self.judged.entry(id.sequence).or_default();
        *frames += 1;
        judged.extend(scores);
    }

    /// Stores the scores of a recording that is complete: one without questions about time, of which
    /// no frame failed.
    fn put(&mut self, recording: &str, run: &Run<'_>) -> Result<(), Error> {
        let has_failed = self.failed.iter().any(|(frame, _)| frame.sequence == recording);
        if has_failed || run.asks_about_time(recording) {
            return Ok(());
        }
        let (_, judged) = self.judged.remove(recording).unwrap_or_default();
        let scores = from_judgements(run.protocol(), judged);
        let digests = self.digests.iter().find(|(name, _)| name == recording);
        let digest = digests.map(|(_, digest)| digest.as_str()).unwrap_or_default();
        let path = files::recording(&self.study.options.out, &self.method.name, recording);
        let placements = self.placed.get(recording).cloned().unwrap_or_default();
        files::write_known(&path, digest, &scores, &placements)?;
        self.known.insert(recording.into(), scores);
        Ok(())
    }

    /// The scores of all recordings together.
    fn finish(mut self, in_time: &[Answered], run: &Run<'_>) -> Result<Scores, Error> {
        for answered in in_time {
            let recording = self.judged.entry(answered.answer.frame.sequence.clone()).or_default();
            recording.1.extend(answered.score.clone());
        }
        let left = std::mem::take(&mut self.judged);
        let left = left.into_values().flat_map(|(_, judged)| judged);
        let mut all = vec![from_judgements(run.protocol(), left.collect())];
        all.splice(0..0, self.digests.iter().filter_map(|(name, _)| self.known.remove(name)));
        let merged = merge(&all).map_err(|error| Error::Usage(jrdb_types::with_causes(&error)))?;
        if merged.questions.is_empty() {
            let expected = "expected questions with a known answer, found none";
            return Err(Error::Usage(expected.into()));
        }
        Ok(merged)
    }
}
