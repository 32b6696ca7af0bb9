//! Many frames through the pipeline: reading, perception, the stages, pictures, scores.
//!
//! Frames are worked on several at once, and handed out in order as soon as they are ready; only a few are in memory.

mod recordings;

use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::sync::{Arc, mpsc};

use jrdb_metrics::{MetricsConfig, Outcome};
use jrdb_models::Perception;
use jrdb_perception::Perceive;
use jrdb_pipeline::motion::{Places, with_motions};
use jrdb_pipeline::stream::in_order;
use jrdb_pipeline::{
    Frame, Pipeline, PipelineConfig, PlacedFrame, Recording, Robot, Scene, baseline,
};
use jrdb_projection::Motions;
use jrdb_types::{Answer, Detections, FrameId, ImageGeometry, Query, Question};

use crate::Error;
use crate::answers::questions_digest;
use crate::description::{Work, describe};
use crate::guard::guarded;
use crate::health::{FrameHealth, Health};
use crate::inputs::Inputs;
use crate::output::{Writer, Written};
use crate::questions::{Answered, FrameQuestions, ReadQuestion};
use crate::result::{FrameOutput, FrameResult, RunSummary};
use crate::run_folder::{Found, RunFolder};
use crate::run_options::RunOptions;
use crate::source::{FrameSource, list_frames, open_perception};

/// A run whose frames, questions and models are known, ready to go.
pub struct Run<'o> {
    options: &'o RunOptions,
    frames: Vec<FrameSource>,
    questions: FrameQuestions,
    perception: Arc<Perception>,
    config: Arc<PipelineConfig>,
    metrics: MetricsConfig,
    writer: Option<Writer>,
    folder: Option<RunFolder>,
    threads: NonZeroUsize,
    pool: rayon::ThreadPool,
}

impl<'o> Run<'o> {
    /// Lists the frames, reads the questions and opens perception.
    ///
    /// # Errors
    /// When there is no frame, or a dataset, question file or model is unusable.
    pub fn open(options: &'o RunOptions) -> Result<Self, Error> {
        let frames = list_frames(&options.sources, options.frames.as_ref(), &options.robot)?;
        let (files, parser) = (&options.questions, &options.config.parser);
        let (typed, sources) = (&options.queries, &options.sources);
        let mut questions = FrameQuestions::gather(&frames, typed, files, sources, parser)?;
        let demographics = options.demographics.for_queries(questions.queries());
        let perception =
            open_perception(&options.perception, &frames, &options.engine, demographics)?;
        if options.baseline && perception.grounder().is_none() {
            return Err(jrdb_pipeline::Error::NoGrounder.into());
        }
        let asked = questions.per_frame.iter().flatten().map(|one| &one.question);
        let questions_digest = Some(questions_digest(asked));
        if !perception.tracks() {
            questions.forget_names();
        }
        let (robot, source) = (&options.robot, &options.perception);
        let open = |root| {
            let (frames, questions, perception) = (&frames, &questions, &perception);
            let work = Work { frames, questions, robot, source, perception };
            RunFolder::open(root, describe(&work, &options.described()), options.existing)
        };
        let folder = options.out.as_deref().map(open).transpose()?;
        let config = Arc::new(options.config.clone());
        let writer = options.out.as_ref().map(|root| {
            let written = match options.artifacts {
                true => Written::Artefacts(perception.config()),
                false => Written::Answers,
            };
            Writer::new(root, config.clone(), written)
        });
        let pool =
            rayon::ThreadPoolBuilder::new().num_threads(options.threads.unwrap_or(0)).build();
        let no_pool = |error| Error::Usage(format!("cannot start worker threads: {error}"));
        let pool = pool.map_err(no_pool)?;
        let threads = NonZeroUsize::new(pool.current_num_threads()).unwrap_or(NonZeroUsize::MIN);
        let metrics = metrics_config(&options.config, frames[0].robot.image());
        let metrics = MetricsConfig { questions_digest, ..metrics };
        let perception = Arc::new(perception);
        Ok(Self {
            options,
            frames,
            questions,
            perception,
            config,
            metrics,
            writer,
            folder,
            threads,
            pool,
        })
    }

    /// How many frames there are.
    #[must_use]
    pub fn frame_count(&self) -> usize {
        self.frames.len()
    }

    /// What the user should know: which models and which engine run.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        self.perception.notes()
    }

    /// Works on all frames. `on_frame` gets each in order, as soon as it is ready, and may end the run.
    ///
    /// A frame that cannot be done does not stop the others; its error is in the result.
    ///
    /// # Errors
    /// When what the run leaves besides its frames cannot be written.
    pub fn execute(
        &self,
        mut on_frame: impl FnMut(FrameResult) -> ControlFlow<()>,
    ) -> Result<RunSummary, Error> {
        let mut tally = Tally::new(self);
        let mut count = 0;
        let each = |result: FrameResult| {
            tally.add(&result);
            count += 1;
            on_frame(result)
        };
        // Things are seen to move only while the robot stands, and only where ids are tracks.
        if self.options.robot_stands && self.perception.tracks() {
            self.moving_frames(each);
        } else {
            let work = |(frame, questions): (&FrameSource, &Vec<ReadQuestion>)| {
                let output = guarded(|| self.pool.install(|| self.frame(frame, questions)));
                FrameResult { id: frame.id.clone(), output }
            };
            in_order(self.due().zip(&self.questions.per_frame), self.threads, work, each);
        }
        let is_cut_short = count < self.frames.len();
        let summary = RunSummary { is_cut_short, ..tally.summary() };
        if !is_cut_short {
            self.write_summary(&summary)?;
        }
        Ok(summary)
    }

    /// Writes what all frames together come to, and notes that the folder is complete when no frame failed.
    fn write_summary(&self, summary: &RunSummary) -> Result<(), Error> {
        let Some(writer) = &self.writer else { return Ok(()) };
        summary.recordings.iter().try_for_each(|answered| writer.recording(answered))?;
        summary.scores.iter().try_for_each(|scores| writer.scores(scores))?;
        let folder = self.folder.as_ref().filter(|_| summary.failures.is_empty());
        folder.map_or(Ok(()), RunFolder::complete)
    }

    /// What `--out` held before, where there is one.
    #[must_use]
    pub fn found(&self) -> Option<Found> {
        self.folder.as_ref().map(RunFolder::found)
    }

    /// Frames in two steps: places first, then, once the neighbouring frames have theirs, everything that motion decides.
    fn moving_frames(&self, each: impl FnMut(FrameResult) -> ControlFlow<()>) {
        let position_std_m = self.config.projection.heading.motion_position_std_m;
        let (send, placed) = mpsc::sync_channel(self.threads.get());
        std::thread::scope(|scope| {
            scope.spawn(move || {
                let place = |frame: &FrameSource| {
                    let pipeline = self.pipeline(&frame.robot);
                    guarded(|| self.pool.install(|| pipeline.place(self.read(frame))))
                };
                in_order(self.due(), self.threads, place, |result| match send.send(result) {
                    Ok(()) => ControlFlow::Continue(()),
                    Err(_) => ControlFlow::Break(()),
                });
            });
            let frames = self.frames.iter().zip(&self.questions.per_frame);
            let frames = placed.into_iter().zip(frames).map(|(placed, (frame, questions))| {
                let nowhere = || Places::new(frame.id.clone(), []);
                let places = placed.as_ref().map_or_else(|_| nowhere(), PlacedFrame::places);
                (places, (placed, frame, questions))
            });
            let moving = with_motions(frames, position_std_m);
            let work = |(motions, (placed, frame, questions)): Moving<'_>| {
                let complete = |placed| {
                    let scene = self.pipeline(&frame.robot).complete(placed, &motions);
                    self.pool.install(|| self.answer(frame, scene, questions))
                };
                let output = guarded(|| placed.map_err(Error::from).and_then(complete));
                FrameResult { id: frame.id.clone(), output }
            };
            in_order(moving, self.threads, work, each);
        });
    }

    /// The frames until the run is interrupted.
    fn due(&self) -> impl Iterator<Item = &FrameSource> + Send {
        self.frames.iter().take_while(|_| self.options.interrupt.came().is_none())
    }

    fn pipeline(&self, robot: &Arc<Robot>) -> Pipeline {
        Pipeline::sharing(robot.clone(), self.perception.clone(), self.config.clone())
    }

    /// A frame, with its image decoded where pictures will be drawn on it: then trouble with it is known in time.
    fn read(&self, frame: &FrameSource) -> Frame {
        let read = frame.read();
        if self.writer.is_some() {
            read.decode();
        }
        read
    }

    fn frame(&self, frame: &FrameSource, questions: &[ReadQuestion]) -> Result<FrameOutput, Error> {
        let pipeline = self.pipeline(&frame.robot);
        if !self.options.baseline {
            let scene = match self.known_detections(frame) {
                Some(known) => pipeline.see_detections(self.read(frame), known)?,
                None => pipeline.see(self.read(frame))?,
            };
            return self.answer(frame, scene, questions);
        }
        let of_now: Vec<_> = questions.iter().filter(|one| !one.speaks_of_time()).collect();
        let queries: Vec<&Query> = of_now.iter().map(|one| &*one.query).collect();
        let (scene, answers) = baseline::answer(&pipeline, self.read(frame), &queries)?;
        let answered = of_now.into_iter().zip(answers);
        let answered = answered.map(|(one, answer)| self.answered(one, answer)).collect();
        Ok(self.written(frame, scene, answered))
    }

    /// The detections of a frame that an earlier run into the same folder completed: models need not look again.
    fn known_detections(&self, frame: &FrameSource) -> Option<Detections> {
        let writer = self.writer.as_ref().filter(|_| self.options.artifacts)?;
        let is_continued = self.found() != Some(Found::Nothing);
        let is_there = is_continued && writer.has(&frame.id, &Inputs::of_frame(frame));
        is_there.then(|| writer.detections(&frame.id))?
    }

    /// Answers every question that one frame can answer; those that speak of time are left to the recording.
    fn answer(
        &self,
        frame: &FrameSource,
        scene: Scene,
        questions: &[ReadQuestion],
    ) -> Result<FrameOutput, Error> {
        let of_now = questions.iter().filter(|one| !one.speaks_of_time());
        let answered = of_now.map(|one| self.answered(one, scene.ask_query(&one.query))).collect();
        Ok(self.written(frame, scene, answered))
    }

    /// The output with what became of its files: answers are not lost with them.
    fn written(&self, frame: &FrameSource, scene: Scene, answered: Vec<Answered>) -> FrameOutput {
        let mut output = FrameOutput { scene, answered, unwritten: None };
        if let Some(writer) = &self.writer {
            output.unwritten = writer.frame(&output, &Inputs::of_frame(frame)).err();
        }
        output
    }

    fn answered(&self, one: &ReadQuestion, answer: Answer) -> Answered {
        let ReadQuestion { question, query } = one.clone();
        let answer = Answer { question_id: question.id.clone(), ..answer };
        let outcome = Outcome { question: &question, answer: &answer };
        let score = jrdb_metrics::score(outcome, &self.metrics);
        Answered { question, query, answer, score }
    }
}

type Moving<'a> =
    (Motions, (Result<PlacedFrame, jrdb_pipeline::Error>, &'a FrameSource, &'a Vec<ReadQuestion>));

/// The metrics' configuration, with the panorama's circumference when nobody has set it.
pub(crate) fn metrics_config(config: &PipelineConfig, image: ImageGeometry) -> MetricsConfig {
    let period_px = config.metrics.period_px.or_else(|| image.period_px());
    MetricsConfig { period_px, ..config.metrics.clone() }
}

/// What is kept of frames that have been handed out: what scores and questions about time need.
struct Tally<'r> {
    run: &'r Run<'r>,
    /// Questions about time of every recording, each once, with the recording so far.
    recordings: BTreeMap<&'r str, (Vec<&'r ReadQuestion>, Recording)>,
    scored: Vec<(Question, Answer)>,
    failures: Vec<(FrameId, String)>,
    health: Health,
}

impl<'r> Tally<'r> {
    fn new(run: &'r Run<'_>) -> Self {
        let mut recordings: BTreeMap<&str, (Vec<&ReadQuestion>, Recording)> = BTreeMap::new();
        for (frame, questions) in run.frames.iter().zip(&run.questions.per_frame) {
            for one in questions.iter().filter(|one| one.speaks_of_time()) {
                let (about, _) = recordings.entry(&frame.id.sequence).or_default();
                let (text, slots) = (&one.question.text, &one.question.slots);
                let is_same = |other: &&ReadQuestion| {
                    other.question.text == *text && other.question.slots == *slots
                };
                if !about.iter().any(is_same) {
                    about.push(one);
                }
            }
        }
        let (scored, failures, health) = Default::default();
        Self { run, recordings, scored, failures, health }
    }

    fn add(&mut self, result: &FrameResult) {
        match &result.output {
            Ok(output) => {
                if let Some((_, recording)) = self.recordings.get_mut(&*result.id.sequence) {
                    recording.push_graph_of(&output.scene);
                }
                output.answered.iter().for_each(|answered| self.keep(answered));
                match &output.unwritten {
                    None => self.health.add(&FrameHealth::of(&output.scene)),
                    Some(error) => self.fail(&result.id, error),
                }
            }
            Err(error) => self.fail(&result.id, error),
        }
    }

    fn fail(&mut self, frame: &FrameId, error: &Error) {
        self.health.add_failed();
        self.failures.push((frame.clone(), jrdb_types::with_causes(error)));
    }

    /// Keeps what scores need: not the trace, which is most of an answer.
    fn keep(&mut self, answered: &Answered) {
        self.health.add_answer(answered.answer.status);
        if answered.score.is_some() {
            let answer = Answer { trace: Vec::new(), ..answered.answer.clone() };
            self.scored.push((answered.question.clone(), answer));
        }
    }

    fn summary(mut self) -> RunSummary {
        let recordings: Vec<Answered> = self
            .recordings
            .values()
            .filter(|(_, recording)| !recording.is_empty())
            .flat_map(|(about, recording)| {
                about.iter().map(|one| {
                    let answer = recording.ask_query(&one.query, &one.question.slots);
                    self.run.answered(one, answer)
                })
            })
            .collect();
        recordings.iter().for_each(|answered| self.keep(answered));
        let scored = self.scored.iter();
        let outcomes: Vec<Outcome<'_>> =
            scored.map(|(question, answer)| Outcome { question, answer }).collect();
        let scores =
            (!outcomes.is_empty()).then(|| jrdb_metrics::evaluate(&outcomes, &self.run.metrics));
        let unasked = self.run.questions.unasked;
        let (failures, health) = (self.failures, self.health);
        RunSummary { recordings, scores, unasked, is_cut_short: false, failures, health }
    }
}
