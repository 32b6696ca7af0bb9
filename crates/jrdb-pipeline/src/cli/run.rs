//! `jrdb run`.

use std::ops::Range;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Result;
use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};
use jrdb_pipeline::engine::{EngineChoice, EngineOptions};
use jrdb_pipeline::light::Demographics;
use jrdb_pipeline::perceive::PerceptionSource;
use jrdb_pipeline::profile::Profile;
use jrdb_pipeline::report::{Detail, Telling};
use jrdb_pipeline::source::{RigChoice, RobotOptions, Source};
use jrdb_pipeline::{Error, PipelineConfig, RunOptions, read_query, report, with_causes};
use jrdb_types::score::IouKind;
use jrdb_types::{LateralConvention, Localizer};

use super::question::{AnswerArgs, ReadingArgs};
use super::{Format, say};

/// Which frames.
#[derive(Debug, Args)]
pub(crate) struct SourceArgs {
    /// A scene folder, all its frames; may be given several times
    #[arg(long, value_name = "DIR", conflicts_with_all = ["dataset", "sequence"])]
    scene: Vec<PathBuf>,
    /// The root of a JRDB tree
    #[arg(long, value_name = "ROOT", requires = "sequence")]
    dataset: Option<PathBuf>,
    /// A sequence of the tree
    #[arg(long, value_name = "NAME", requires = "dataset")]
    sequence: Option<String>,
    /// Frame numbers, B exclusive; all when absent
    #[arg(long, value_name = "A..B", value_parser = frame_range)]
    pub(crate) frames: Option<Range<u32>>,
    #[command(flatten)]
    pub(crate) robot: RobotArgs,
}

/// Which sensors.
#[derive(Debug, Args)]
pub(crate) struct RobotArgs {
    /// A rig file; tree: the tree's own calibration (default); jrdb-refined: JRDB's panorama as the five
    /// views that it is
    #[arg(long, value_name = "RIG")]
    pub(crate) rig: Option<RigChoice>,
    /// The rig's camera that the images are from; its first when absent
    #[arg(long, value_name = "NAME")]
    camera: Option<String>,
}

impl RobotArgs {
    pub(crate) fn options(&self) -> RobotOptions {
        let (rig, camera) = (self.rig.clone().unwrap_or_default(), self.camera.clone());
        RobotOptions { rig, camera }
    }
}

impl SourceArgs {
    /// Whether any frames are named.
    pub(crate) fn is_given(&self) -> bool {
        self.dataset.is_some() || !self.scene.is_empty()
    }

    pub(crate) fn robot(&self) -> RobotOptions {
        self.robot.options()
    }

    pub(crate) fn sources(&self) -> Result<Vec<Source>, Error> {
        match (&self.dataset, &self.sequence) {
            (Some(root), Some(name)) => {
                Ok(vec![Source::Sequence { root: root.clone(), name: name.clone() }])
            }
            _ if self.scene.is_empty() => Err(Error::Usage(
                "expected --scene DIR, or --dataset ROOT and --sequence NAME".into(),
            )),
            _ => Ok(self.scene.iter().cloned().map(Source::Scene).collect()),
        }
    }
}

fn frame_range(text: &str) -> Result<Range<u32>, String> {
    let expected = || format!("expected A..B with A < B, found {text:?}");
    let (start, end) = text.split_once("..").ok_or_else(expected)?;
    let [start, end] = [start, end].map(str::parse);
    match (start, end) {
        (Ok(start), Ok(end)) if start < end => Ok(start..end),
        _ => Err(expected()),
    }
}

/// Where detections come from.
#[derive(Debug, Args)]
pub(crate) struct PerceptionArgs {
    /// labels, file:PATH (our detections or COCO results), replay:PATH (an exchange), light (people and objects), ssdlite (people), or a backbone:
    /// demo, florence2-internvl, paper, or NAME for NAME.json in the models folder
    #[arg(long, default_value = "labels", value_name = "SOURCE")]
    perception: PerceptionSource,
    /// What light guesses from faces; the bare flag means gender
    #[arg(long, value_enum, default_value_t, num_args = 0..=1, default_missing_value = "gender", value_name = "WHAT")]
    demographics: Demographics,
    /// Folder with model files
    #[arg(long, default_value = "models", value_name = "DIR")]
    pub(crate) models: PathBuf,
    /// Which engine runs models
    #[arg(long, value_enum, default_value_t)]
    engine: EngineChoice,
    /// ONNX Runtime's shared library
    #[arg(long, value_name = "PATH")]
    onnxruntime: Option<PathBuf>,
    /// Tell on stderr how long every graph of a model took, and the peak memory
    #[arg(long)]
    profile: bool,
}

impl PerceptionArgs {
    pub(crate) fn source(&self) -> PerceptionSource {
        match &self.perception {
            PerceptionSource::Light(_) => PerceptionSource::Light(self.demographics),
            other => other.clone(),
        }
    }

    pub(crate) fn engine(&self) -> EngineOptions {
        let (library, models) = (self.onnxruntime.clone(), self.models.clone());
        let profile = self.profile.then(Profile::default);
        EngineOptions { choice: self.engine, library, profile, models }
    }
}

/// How people are placed.
#[derive(Debug, Args)]
pub(crate) struct ProjectionArgs {
    /// Which side "left" names; engine-head mirrors it, as the benchmark's engine does
    #[arg(long, value_enum, default_value_t)]
    lateral: Lateral,
    /// How positions are found
    #[arg(long, value_enum, default_value_t)]
    localizer: LocalizerArg,
}

impl ProjectionArgs {
    pub(crate) fn apply(&self, config: &mut PipelineConfig) {
        config.projection.lateral = match self.lateral {
            Lateral::Physical => LateralConvention::Physical,
            Lateral::EngineHead => LateralConvention::BenchmarkMirrored,
        };
        config.projection.localizer = match self.localizer {
            LocalizerArg::DensestRange => Localizer::DensestRange,
            LocalizerArg::Mean => Localizer::Mean,
            LocalizerArg::Given => Localizer::Given,
        };
    }
}

#[derive(Debug, Clone, Copy, Default, ValueEnum)]
enum Lateral {
    #[default]
    Physical,
    EngineHead,
}

#[derive(Debug, Clone, Copy, Default, ValueEnum)]
enum LocalizerArg {
    /// Densest range bin in the core of the box
    #[default]
    DensestRange,
    /// Mean of all points in the box (the paper)
    Mean,
    /// The 3D box that came with the detection
    Given,
}

/// Which IoU scores use.
#[derive(Debug, Clone, Copy, Default, ValueEnum)]
pub(crate) enum Iou {
    /// On the plane, as the official evaluators
    #[default]
    Planar,
    /// On the circle of the panorama
    Circular,
}

impl Iou {
    pub(crate) fn apply(self, config: &mut PipelineConfig) {
        config.metrics.iou = match self {
            Self::Planar => IouKind::Planar,
            Self::Circular => IouKind::Circular,
        };
    }
}

#[derive(Debug, Args)]
pub(crate) struct RunArgs {
    #[command(flatten)]
    source: SourceArgs,
    #[command(flatten)]
    perception: PerceptionArgs,
    #[command(flatten)]
    projection: ProjectionArgs,
    /// The robot does not move: velocities, and headings where labels have none, come from labelled tracks
    #[arg(long)]
    robot_stands: bool,
    /// Let the detector answer every question by itself, as the paper's baselines do: no points, no graph, no search
    #[arg(long)]
    baseline: bool,
    /// A question for every frame, in English or in the notation; may be given several times
    #[arg(long, value_name = "TEXT")]
    query: Vec<String>,
    /// Questions in the JRDB-Reasoning layout; a scene's own are taken when neither this nor --query is given
    #[arg(long, value_name = "FILE")]
    questions: Option<PathBuf>,
    #[command(flatten)]
    reading: ReadingArgs,
    #[command(flatten)]
    answers: AnswerArgs,
    /// Which IoU scores use
    #[arg(long, value_enum, default_value_t)]
    iou: Iou,
    /// Folder for answers and pictures
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write every stage's artefact, too
    #[arg(long, requires = "out")]
    artifacts: bool,
    /// Worker threads; the output does not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Tell every condition with its number and margin, and the nearest misses
    #[arg(long)]
    explain: bool,
    /// How results are printed
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl RunArgs {
    fn telling(&self) -> Telling {
        let detail = if self.explain { Detail::Full } else { Detail::Brief };
        Telling { detail, why_not: self.answers.why_not.clone() }
    }

    fn options(&self) -> Result<RunOptions, Error> {
        let mut config = PipelineConfig::default();
        self.projection.apply(&mut config);
        self.iou.apply(&mut config);
        self.answers.apply(&mut config);
        config.parser = self.reading.config();
        for query in &self.query {
            read_query(query, &config.parser)?;
        }
        Ok(RunOptions {
            sources: self.source.sources()?,
            robot: self.source.robot(),
            frames: self.source.frames.clone(),
            perception: self.perception.source(),
            models: self.perception.models.clone(),
            engine: self.perception.engine(),
            robot_stands: self.robot_stands,
            baseline: self.baseline,
            queries: self.query.clone(),
            questions: self.questions.clone(),
            config,
            threads: self.threads.map(usize::from),
            out: self.out.clone(),
            artifacts: self.artifacts,
        })
    }
}

/// Says on stderr where the models' time went, if that was asked for.
pub(crate) fn tell_profile(engine: &EngineOptions) {
    if let Some(profile) = &engine.profile {
        eprint!("{}", profile.table());
    }
}

pub(crate) fn run(args: &RunArgs) -> Result<ExitCode> {
    let options = args.options()?;
    // Drawn on stderr, and only when that is a terminal.
    let style = ProgressStyle::with_template("{spinner} {pos} frames, {per_sec}")
        .unwrap_or_else(|_| ProgressStyle::default_spinner());
    let progress = ProgressBar::new_spinner().with_style(style);
    let result = jrdb_pipeline::run(&options, &|| progress.inc(1))?;
    progress.finish_and_clear();
    tell_profile(&options.engine);
    match args.format {
        Format::Text => say(&report::text(&result, &args.telling()))?,
        Format::Json => say(&report::json(&result, &options.config))?,
    }
    if let (Format::Text, Some(out)) = (args.format, &args.out) {
        say(&format!("answers and pictures are in {}\n", out.display()))?;
    }
    for frame in &result.frames {
        if let Err(error) = &frame.output {
            eprintln!("error: {}: {}", frame.id, with_causes(error));
        }
    }
    let failed = result.frames.iter().any(|frame| frame.output.is_err());
    Ok(ExitCode::from(u8::from(failed)))
}
