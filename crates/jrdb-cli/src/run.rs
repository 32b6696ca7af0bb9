//! Many frames through the pipeline: reading, perception, the stages, pictures, scores.
//!
//! Frames are worked on several at once, and handed out in order as soon as they are ready; only a few are in memory.

use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::ops::{ControlFlow, Range};
use std::path::PathBuf;
use std::sync::{Arc, mpsc};

use jrdb_metrics::{MetricsConfig, Outcome};
use jrdb_models::demographics::Demographics;
use jrdb_models::loader::EngineOptions;
use jrdb_models::{Perception, PerceptionSource};
use jrdb_perception::Perceive;
use jrdb_pipeline::motion::{Places, with_motions};
use jrdb_pipeline::stream::in_order;
use jrdb_pipeline::{
    Frame, Pipeline, PipelineConfig, PlacedFrame, Recording, Robot, Scene, baseline,
};
use jrdb_projection::Motions;
use jrdb_types::{Answer, FrameId, ImageGeometry, Query, Question};

use crate::Error;
use crate::health::{FrameHealth, Health};
use crate::output::{Layout, Writer, Written};
use crate::questions::{Answered, FrameQuestions, ReadQuestion};
use crate::result::{FrameOutput, FrameResult, RunSummary};
use crate::source::{FrameSource, RobotOptions, Source, list_frames, open_perception};

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
    pub questions: Option<PathBuf>,
    /// Configuration of the stages.
    pub config: PipelineConfig,
    /// Worker threads; one per core when absent. The output does not depend on it.
    pub threads: Option<usize>,
    /// Folder for answers and pictures.
    pub out: Option<PathBuf>,
    /// Whether every stage's artefact is written too.
    pub artifacts: bool,
}

/// A run whose frames, questions and models are known, ready to go.
pub struct Run<'o> {
    options: &'o RunOptions,
    frames: Vec<FrameSource>,
    questions: FrameQuestions,
    perception: Arc<Perception>,
    config: Arc<PipelineConfig>,
    metrics: MetricsConfig,
    writer: Option<Writer>,
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
        let (file, parser) = (options.questions.as_ref(), &options.config.parser);
        let (typed, sources) = (&options.queries, &options.sources);
        let mut questions = FrameQuestions::gather(&frames, typed, file, sources, parser)?;
        let demographics = options.demographics.for_queries(questions.queries());
        let perception =
            open_perception(&options.perception, &frames, &options.engine, demographics)?;
        if options.baseline && perception.grounder().is_none() {
            return Err(jrdb_pipeline::Error::NoGrounder.into());
        }
        if !perception.tracks() {
            questions.forget_names();
        }
        let ids: Vec<&FrameId> = frames.iter().map(|frame| &frame.id).collect();
        let layout = Layout::of(&ids, questions.most());
        let config = Arc::new(options.config.clone());
        let writer = options.out.as_ref().map(|root| {
            let written = match options.artifacts {
                true => Written::Artefacts(perception.config()),
                false => Written::Answers,
            };
            Writer::new(root, layout, config.clone(), written)
        });
        let pool = pool(options.threads)?;
        let threads = NonZeroUsize::new(pool.current_num_threads()).unwrap_or(NonZeroUsize::MIN);
        let metrics = metrics_config(&options.config, frames[0].robot.image());
        let perception = Arc::new(perception);
        Ok(Self { options, frames, questions, perception, config, metrics, writer, threads, pool })
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
        let each = |result: FrameResult| {
            tally.add(&result);
            on_frame(result)
        };
        // Things are seen to move only while the robot stands, and only where ids are tracks.
        if self.options.robot_stands && self.perception.tracks() {
            self.moving_frames(each);
        } else {
            let work = |(frame, questions): (&FrameSource, &Vec<ReadQuestion>)| {
                let output = self.pool.install(|| self.frame(frame, questions));
                FrameResult { id: frame.id.clone(), output }
            };
            let frames = self.frames.iter().zip(&self.questions.per_frame);
            in_order(frames, self.threads, work, each);
        }
        let summary = tally.summary();
        if let Some(writer) = &self.writer {
            for (index, answered) in summary.recordings.iter().enumerate() {
                writer.recording(index, answered)?;
            }
            if let Some(scores) = &summary.scores {
                writer.scores(scores)?;
            }
        }
        Ok(summary)
    }

    /// Frames in two steps: places first, then, once the neighbouring frames have theirs, everything that motion decides.
    fn moving_frames(&self, each: impl FnMut(FrameResult) -> ControlFlow<()>) {
        let position_std_m = self.config.projection.heading.motion_position_std_m;
        let (send, placed) = mpsc::sync_channel(self.threads.get());
        std::thread::scope(|scope| {
            scope.spawn(move || {
                let place = |frame: &FrameSource| {
                    let pipeline = self.pipeline(&frame.robot);
                    self.pool.install(|| pipeline.place(self.read(frame)))
                };
                in_order(self.frames.iter(), self.threads, place, |result| {
                    match send.send(result) {
                        Ok(()) => ControlFlow::Continue(()),
                        Err(_) => ControlFlow::Break(()),
                    }
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
                    self.pool.install(|| self.answer(scene, questions))
                };
                let output = placed.map_err(Error::from).and_then(complete);
                FrameResult { id: frame.id.clone(), output }
            };
            in_order(moving, self.threads, work, each);
        });
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
            return self.answer(pipeline.see(self.read(frame))?, questions);
        }
        let of_now: Vec<_> = questions.iter().filter(|one| !one.speaks_of_time()).collect();
        let queries: Vec<&Query> = of_now.iter().map(|one| &*one.query).collect();
        let (scene, answers) = baseline::answer(&pipeline, self.read(frame), &queries)?;
        let answered = of_now.into_iter().zip(answers);
        let answered = answered.map(|(one, answer)| self.answered(one, answer)).collect();
        self.written(FrameOutput { scene, answered })
    }

    /// Answers every question that one frame can answer; those that speak of time are left to the recording.
    fn answer(&self, scene: Scene, questions: &[ReadQuestion]) -> Result<FrameOutput, Error> {
        let of_now = questions.iter().filter(|one| !one.speaks_of_time());
        let answered = of_now.map(|one| self.answered(one, scene.ask_query(&one.query))).collect();
        self.written(FrameOutput { scene, answered })
    }

    fn written(&self, output: FrameOutput) -> Result<FrameOutput, Error> {
        if let Some(writer) = &self.writer {
            writer.frame(&output)?;
        }
        Ok(output)
    }

    fn answered(&self, one: &ReadQuestion, answer: Answer) -> Answered {
        let ReadQuestion { question, query } = one.clone();
        let outcome = Outcome { question: &question, answer: &answer };
        let score = jrdb_metrics::score(outcome, &self.metrics);
        Answered { question, query, answer, score }
    }
}

type Moving<'a> =
    (Motions, (Result<PlacedFrame, jrdb_pipeline::Error>, &'a FrameSource, &'a Vec<ReadQuestion>));

fn pool(threads: Option<usize>) -> Result<rayon::ThreadPool, Error> {
    let builder = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0));
    builder.build().map_err(|error| Error::Usage(format!("cannot start worker threads: {error}")))
}

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
                self.health.add(&FrameHealth::of(&output.scene));
            }
            Err(error) => {
                self.health.add_failed();
                self.failures.push((result.id.clone(), jrdb_types::with_causes(error)));
            }
        }
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
        RunSummary { recordings, scores, unasked, failures: self.failures, health: self.health }
    }
}
