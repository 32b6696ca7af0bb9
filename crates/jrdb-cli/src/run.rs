//! Many frames through the pipeline: reading, perception, the stages, pictures, scores.

use std::ops::Range;
use std::path::PathBuf;

use jrdb_metrics::{MetricsConfig, Outcome};
use jrdb_models::loader::EngineOptions;
use jrdb_types::{FrameId, Question, Questions, Scores};
use rayon::prelude::*;

use crate::Error;
use crate::baseline;
use crate::output::{Layout, Writer};
use crate::perceive::{Perceiver, PerceptionSource};
use crate::recording;
use crate::source::{self, FrameSource, RobotOptions, Source};
use jrdb_pipeline::frame::place;
use jrdb_pipeline::motion::{self, Motions, Places};
use jrdb_pipeline::query::read_or_report;
use jrdb_pipeline::{Asked, FrameInput, FrameOutput, PipelineConfig, process};

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
    /// Folder with model files.
    pub models: PathBuf,
    /// How to choose an engine for them.
    pub engine: EngineOptions,
    /// Whether the robot stands still throughout: then things that are tracked are seen to move.
    pub robot_stands: bool,
    /// Whether the detector answers every question by itself, without points, graph and search.
    pub baseline: bool,
    /// Questions asked of every frame.
    pub queries: Vec<String>,
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

/// One frame's result.
#[derive(Debug)]
pub struct FrameResult {
    /// Which frame.
    pub id: FrameId,
    /// Its output, or why it could not be done; other frames go on.
    pub output: Result<FrameOutput, Error>,
}

/// What a run came to.
#[derive(Debug)]
pub struct RunResult {
    /// Every frame, in order.
    pub frames: Vec<FrameResult>,
    /// Questions about time with their answers, one for each recording they were asked of.
    pub recordings: Vec<Asked>,
    /// Scores, when any question had a known answer.
    pub scores: Option<Scores>,
    /// What the user should know: which engine ran.
    pub notes: Vec<String>,
    /// Questions of the file that no frame of this run could answer.
    pub unasked: usize,
}

/// Runs the pipeline. `on_frame` is called after each frame, from worker threads.
///
/// A frame that cannot be done does not stop the others; its error is in the result.
///
/// # Errors
/// When there is no frame, or a dataset, question file, model or output folder is unusable.
pub fn run(options: &RunOptions, on_frame: &(dyn Fn() + Sync)) -> Result<RunResult, Error> {
    let frame_sources =
        source::list_frames(&options.sources, options.frames.as_ref(), &options.robot)?;
    let mut questions = frame_questions(options, &frame_sources)?;
    let perception = perception(options, &questions);
    let perceiver = Perceiver::open(&perception, &frame_sources, &options.models, &options.engine)?;
    if options.baseline {
        perceiver.check_baseline()?;
    }
    if !perceiver.knows_truth() {
        questions.forget_names();
    }
    let asked = questions.per_frame.iter().map(Vec::len).max().unwrap_or(0);
    let ids: Vec<&FrameId> = frame_sources.iter().map(|frame| &frame.id).collect();
    let layout = Layout::of(&ids, asked);
    let writer = options.out.as_ref().map(|root| Writer::new(root, layout, options, &perceiver));
    let work = || {
        let motions = motions(&frame_sources, &perceiver, options);
        let each = frame_sources.par_iter().zip(&questions.per_frame).zip(motions);
        let each = each.map(|((frame, questions), motions)| {
            let asked = (questions.as_slice(), motions);
            let output = run_frame(frame, asked, &perceiver, writer.as_ref(), options);
            on_frame();
            FrameResult { id: frame.id.clone(), output }
        });
        each.collect::<Vec<_>>()
    };
    let frames = pool(options.threads)?.install(work);
    let recordings = recording::ask(&frames, &questions.per_frame, &options.config);
    let scores = score(&frames, &recordings, &metrics_config(options, &frame_sources));
    if let Some(writer) = &writer {
        recordings
            .iter()
            .enumerate()
            .try_for_each(|(index, asked)| writer.recording(index, asked))?;
    }
    if let (Some(writer), Some(scores)) = (&writer, &scores) {
        writer.scores(scores)?;
    }
    let notes = perceiver.notes().to_vec();
    Ok(RunResult { frames, recordings, scores, notes, unasked: questions.unasked })
}

/// Where detections come from, with what the questions need of it.
fn perception(options: &RunOptions, questions: &FrameQuestions) -> PerceptionSource {
    let PerceptionSource::Light(demographics) = &options.perception else {
        return options.perception.clone();
    };
    let asked = questions.per_frame.iter().flatten();
    let queries: Vec<_> = asked.map(|q| read_or_report(&q.text, &options.config.parser)).collect();
    PerceptionSource::Light(demographics.for_queries(&queries))
}

fn pool(threads: Option<usize>) -> Result<rayon::ThreadPool, Error> {
    let builder = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0));
    builder.build().map_err(|error| Error::Usage(format!("cannot start worker threads: {error}")))
}

struct FrameQuestions {
    per_frame: Vec<Vec<Question>>,
    unasked: usize,
}

impl FrameQuestions {
    /// Leaves of the truth only its boxes: the names that perception gives are others.
    fn forget_names(&mut self) {
        let truths = self.per_frame.iter_mut().flatten().filter_map(|q| q.truth.as_mut());
        truths.for_each(|truth| truth.ids.clear());
    }
}

fn frame_questions(options: &RunOptions, frames: &[FrameSource]) -> Result<FrameQuestions, Error> {
    let mut listed = Questions::default();
    if let Some(path) = &options.questions {
        listed = jrdb_dataset::read_questions(path)?;
    } else if options.queries.is_empty() {
        for source in &options.sources {
            listed.questions.extend(source.own_questions()?.questions);
        }
    }
    let per_frame: Vec<Vec<Question>> =
        frames.iter().map(|f| source::questions_for(&f.id, &options.queries, &listed)).collect();
    let asked: usize = per_frame.iter().map(Vec::len).sum();
    let from_file = asked - options.queries.len() * frames.len();
    Ok(FrameQuestions { per_frame, unasked: listed.questions.len().saturating_sub(from_file) })
}

/// How things move in every frame: nothing is known to, unless the robot stands and ids are tracks.
fn motions(frames: &[FrameSource], perceiver: &Perceiver, options: &RunOptions) -> Vec<Motions> {
    let is_known = options.robot_stands && perceiver.tracks();
    if !is_known {
        return vec![Motions::new(); frames.len()];
    }
    let places = |frame: &FrameSource| {
        let detections = perceiver.detect(frame, &frame.image()).ok()?;
        let (clouds, _) = frame.clouds();
        let nothing = (frame.robot.as_ref(), &Motions::new());
        Some(Places::of(&place(&detections, (&clouds, &[]), nothing, &options.config).ok()?))
    };
    let nowhere = |frame: &FrameSource| Places::nowhere(&frame.id);
    let places: Vec<Places> =
        frames.par_iter().map(|f| places(f).unwrap_or_else(|| nowhere(f))).collect();
    motion::motions(&places, options.config.projection.heading.motion_position_std_m)
}

fn run_frame(
    frame: &FrameSource,
    (questions, motions): (&[Question], Motions),
    perceiver: &Perceiver,
    writer: Option<&Writer>,
    options: &RunOptions,
) -> Result<FrameOutput, Error> {
    let (image, config) = (frame.image(), &options.config);
    let (detections, baseline) = if options.baseline {
        let (found, asked) = baseline::answer(frame, &image, questions, perceiver, config)?;
        (found, Some(asked))
    } else {
        (perceiver.detect(frame, &image)?, None)
    };
    let questions = if baseline.is_some() { &[] } else { questions };
    let (clouds, cloud_issues) = frame.clouds();
    let (image, robot) = (image.ok(), frame.robot.clone());
    let input = FrameInput { detections, image, clouds, robot, cloud_issues, motions };
    let mut output = process(&input, questions, config)?;
    output.asked.extend(baseline.into_iter().flatten());
    if let Some(writer) = writer {
        writer.frame(&input, &output)?;
    }
    Ok(output)
}

/// The metrics' configuration, with the panorama's circumference when nobody has set it.
fn metrics_config(options: &RunOptions, frames: &[FrameSource]) -> MetricsConfig {
    let circumference_px = frames.first().and_then(|frame| frame.robot.image.period_px());
    let period_px = options.config.metrics.period_px.or(circumference_px);
    MetricsConfig { period_px, ..options.config.metrics.clone() }
}

fn score(frames: &[FrameResult], recordings: &[Asked], config: &MetricsConfig) -> Option<Scores> {
    let asked = frames.iter().filter_map(|frame| frame.output.as_ref().ok()).flat_map(|o| &o.asked);
    let outcomes: Vec<Outcome<'_>> = asked
        .chain(recordings)
        .filter(|asked| asked.question.truth.is_some())
        .map(|asked| Outcome { question: &asked.question, answer: &asked.answer })
        .collect();
    (!outcomes.is_empty()).then(|| jrdb_metrics::evaluate(&outcomes, config))
}
