//! One stage per command: artefacts in, an artefact out.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Result, bail};
use clap::Args;
use jrdb_metrics::Outcome;
use jrdb_parser::notation;
use jrdb_pipeline::motion::Motions;
use jrdb_pipeline::output::{read_artefact, write_artefact};
use jrdb_pipeline::perceive::Perceiver;
use jrdb_pipeline::source::{FrameSource, Source, list_frames};
use jrdb_pipeline::{Error, PipelineConfig, frame::place, read_query, report};
use jrdb_search::Pooling;
use jrdb_types::{Answer, Artefact, Detections, Entities, Payload, Query, Question, SceneGraph};
use serde_json::{Value, json};

use super::question::{AnswerArgs, ReadingArgs, question};
use super::run::{Iou, PerceptionArgs, ProjectionArgs, RobotArgs, SourceArgs};
use super::{Format, say};

/// Where a stage's artefact goes.
#[derive(Debug, Args)]
pub(crate) struct OutputArgs {
    /// File for the artefact
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// json prints the artefact
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl OutputArgs {
    pub(super) fn give<T: Payload + Clone>(
        &self,
        config: Value,
        data: &T,
        summary: &str,
    ) -> Result<ExitCode> {
        if let Some(path) = &self.out {
            write_artefact(path, config.clone(), data)?;
        }
        match self.format {
            Format::Text => say(&format!("{summary}\n"))?,
            Format::Json => say(&Artefact::new(config, data.clone()).to_json())?,
        }
        Ok(ExitCode::SUCCESS)
    }
}

#[derive(Debug, Args)]
pub(crate) struct PerceiveArgs {
    #[command(flatten)]
    source: SourceArgs,
    #[command(flatten)]
    perception: PerceptionArgs,
    #[command(flatten)]
    output: OutputArgs,
}

pub(crate) fn perceive(args: &PerceiveArgs) -> Result<ExitCode> {
    let frame = only_frame(&args.source)?;
    let (source, engine) = (args.perception.source(), args.perception.engine());
    let frames = [frame];
    let perceiver = Perceiver::open(&source, &frames, &args.perception.models, &engine)?;
    for note in perceiver.notes() {
        eprintln!("{note}");
    }
    let [frame] = frames;
    let detections = perceiver.detect(&frame, &frame.image())?;
    super::run::tell_profile(&engine);
    let lines = detections.detections.iter().map(|d| {
        let [x, y, w, h] = <[f64; 4]>::from(d.bbox);
        format!("{} {} score {:.3} box {x:.1} {y:.1} {w:.1} {h:.1}", d.id, d.category, d.score)
    });
    let summary =
        lines.chain(jrdb_render::notes(&detections.issues)).collect::<Vec<_>>().join("\n");
    args.output.give(perceiver.config().clone(), &detections, &summary)
}

fn only_frame(source: &SourceArgs) -> Result<FrameSource> {
    let mut frames = list_frames(&source.sources()?, source.frames.as_ref(), &source.robot())?;
    if frames.len() > 1 {
        bail!(Error::Usage(format!(
            "expected one frame, found {}: name it with --frames A..B",
            frames.len()
        )));
    }
    frames.pop().ok_or_else(|| Error::Usage("expected one frame, found none".into()).into())
}

#[derive(Debug, Args)]
pub(crate) struct ProjectArgs {
    /// Detections of one frame
    #[arg(long, value_name = "FILE")]
    detections: PathBuf,
    /// The tree with that frame's clouds and calibration
    #[arg(long, value_name = "ROOT")]
    dataset: PathBuf,
    #[command(flatten)]
    robot: RobotArgs,
    #[command(flatten)]
    projection: ProjectionArgs,
    #[command(flatten)]
    output: OutputArgs,
}

pub(crate) fn project(args: &ProjectArgs) -> Result<ExitCode> {
    let detections: Detections = read_artefact(&args.detections)?;
    let id = &detections.frame;
    let source = Source::Sequence { root: args.dataset.clone(), name: id.sequence.clone() };
    let frames = list_frames(
        &[source],
        Some(&(id.frame..id.frame.saturating_add(1))),
        &args.robot.options(),
    )?;
    let mut config = PipelineConfig::default();
    args.projection.apply(&mut config);
    let (clouds, cloud_issues) = frames[0].clouds();
    let entities =
        place(&detections, (&clouds, &cloud_issues), (&frames[0].robot, &Motions::new()), &config)?;
    let lines = entities.entities.iter().map(|e| match e.position {
        None => format!("{} nowhere", e.id),
        Some(p) => {
            let [x, y, z] = p.center;
            format!("{} at {x:.2} {y:.2} {z:.2} m from {} points", e.id, p.points_used)
        }
    });
    let summary = lines.chain(jrdb_render::notes(&entities.issues)).collect::<Vec<_>>().join("\n");
    args.output.give(json!(config.projection), &entities, &summary)
}

#[derive(Debug, Args)]
pub(crate) struct GraphArgs {
    /// Entities of one frame
    #[arg(long, value_name = "FILE")]
    entities: PathBuf,
    #[command(flatten)]
    output: OutputArgs,
}

pub(crate) fn graph(args: &GraphArgs) -> Result<ExitCode> {
    let entities: Entities = read_artefact(&args.entities)?;
    let config = jrdb_graph::GraphConfig::default();
    let graph = jrdb_graph::build(&entities, &config);
    let summary = format!("{} nodes, {} edges", graph.nodes.len(), graph.edges.len());
    args.output.give(json!(config), &graph, &summary)
}

#[derive(Debug, Args)]
pub(crate) struct ParseArgs {
    /// The question, in English or in the notation; - reads standard input
    text: String,
    /// Show what every word was used for: the question, its meaning, and what is open or unknown, underlined
    #[arg(long)]
    explain: bool,
    #[command(flatten)]
    reading: ReadingArgs,
    #[command(flatten)]
    output: OutputArgs,
}

pub(crate) fn parse(args: &ParseArgs) -> Result<ExitCode> {
    let text = question(&args.text)?;
    let config = args.reading.config();
    let query = read_query(&text, &config)?;
    let summary = if args.explain {
        jrdb_parser::explain(&text, &query)
    } else {
        for line in jrdb_render::notes(&query.issues) {
            eprintln!("{line}");
        }
        notation::write(&query)
    };
    args.output.give(json!(config), &query, summary.trim_end())
}

#[derive(Debug, Args)]
pub(crate) struct SearchArgs {
    /// A scene graph; several, in the order of time, make a recording
    #[arg(long, value_name = "FILE", required = true)]
    graph: Vec<PathBuf>,
    /// A query as `jrdb parse` writes it
    #[arg(long, value_name = "FILE", required_unless_present = "text")]
    query: Option<PathBuf>,
    /// A question in English or in the notation, instead; - reads standard input
    #[arg(long, value_name = "TEXT", conflicts_with = "query")]
    text: Option<String>,
    #[command(flatten)]
    reading: ReadingArgs,
    #[command(flatten)]
    answers: AnswerArgs,
    #[command(flatten)]
    output: OutputArgs,
}

pub(crate) fn search(args: &SearchArgs) -> Result<ExitCode> {
    let graphs = args.graph.iter().map(|path| read_artefact(path));
    let mut graphs: Vec<SceneGraph> = graphs.collect::<Result<_, Error>>()?;
    let query: Query = match (&args.query, &args.text) {
        (Some(path), _) => read_artefact(path)?,
        (None, text) => {
            read_query(&question(text.as_deref().unwrap_or_default())?, &args.reading.config())?
        }
    };
    let config = args.answers.search();
    if config.pooling == Pooling::PerCondition {
        jrdb_graph::make_timeless(&mut graphs);
    }
    let mut answer = match graphs.as_slice() {
        [graph] if query.slots.is_empty() => jrdb_search::search(graph, &query, &config),
        graphs => jrdb_search::search_frames(graphs, None, &query, &config),
    };
    if let ([graph], true) = (graphs.as_slice(), args.answers.sensitivity) {
        answer.sensitivity = jrdb_search::sensitivity(graph, &query, &config);
    }
    let summary = report::answer(&query, &answer, args.answers.why_not.as_ref());
    args.output.give(json!(config), &jrdb_render::with_words(answer), summary.trim_end())
}

#[derive(Debug, Args)]
pub(crate) struct EvaluateArgs {
    /// Answers; may be given several times
    #[arg(long, value_name = "FILE", required = true)]
    answers: Vec<PathBuf>,
    /// Questions with their truth, in the JRDB-Reasoning layout
    #[arg(long, value_name = "FILE")]
    questions: PathBuf,
    /// Which IoU scores use
    #[arg(long, value_enum, default_value_t)]
    iou: Iou,
    /// Circumference of the panorama for circular IoU, pixels
    #[arg(long, default_value_t = 3760.0, value_name = "PX")]
    period_px: f64,
    #[command(flatten)]
    output: OutputArgs,
}

pub(crate) fn evaluate(args: &EvaluateArgs) -> Result<ExitCode> {
    let questions = jrdb_dataset::read_questions(&args.questions).map_err(Error::from)?;
    let answers = args.answers.iter().map(|path| read_artefact(path));
    let answers: Vec<Answer> = answers.collect::<Result<_, Error>>()?;
    let find = |answer: &Answer| {
        let asked = |q: &&Question| q.frame == answer.frame && q.text == answer.question;
        questions.questions.iter().find(asked)
    };
    let outcomes: Vec<Outcome<'_>> = answers
        .iter()
        .filter_map(|answer| Some(Outcome { question: find(answer)?, answer }))
        .collect();
    if outcomes.len() < answers.len() {
        eprintln!(
            "note: {} answers are to no question of the file",
            answers.len() - outcomes.len()
        );
    }
    let mut config = PipelineConfig::default();
    args.iou.apply(&mut config);
    config.metrics.period_px = Some(args.period_px);
    let scores = jrdb_metrics::evaluate(&outcomes, &config.metrics);
    args.output.give(json!(config.metrics), &scores, &jrdb_render::scores(&scores))
}
