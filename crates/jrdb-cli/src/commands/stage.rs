//! One stage per command: artefacts in, an artefact out.

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

use anyhow::{Result, bail};
use clap::Args;
use jrdb_cli::output::{read_artefact, write, write_artefact};
use jrdb_cli::source::{FrameSource, Source, list_frames};
use jrdb_cli::{Error, report};
use jrdb_parser::notation;
use jrdb_perception::{KnownDetections, Perceive};
use jrdb_pipeline::{Pipeline, PipelineConfig, read_query};
use jrdb_search::{Pooling, SearchConfig};
use jrdb_types::{Artefact, Detections, Entities, Payload, Query, SceneGraph};
use serde_json::{Value, json};

use super::args::{PerceptionArgs, ProjectionArgs, RobotArgs, SourceArgs};
use super::print::{Format, say};
use super::question::{AnswerArgs, ReadingArgs, only_question, questions};

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
    let perception = Arc::new(args.perception.open(std::slice::from_ref(&frame))?);
    for note in perception.notes() {
        eprintln!("{note}");
    }
    let (robot, shared) = (frame.robot.clone(), perception.clone());
    let read = frame.image_only();
    // Decoded even where perception does not look at it: trouble with it is worth knowing.
    read.decode();
    let detections = Pipeline::sharing(robot, shared, Arc::default()).perceive(&read)?;
    super::print::tell_profile(&args.perception.engine());
    let lines = detections.detections.iter().map(|d| {
        let [x, y, w, h] = <[f64; 4]>::from(d.bbox);
        format!("{} {} score {:.3} box {x:.1} {y:.1} {w:.1} {h:.1}", d.id, d.category, d.score)
    });
    let summary =
        lines.chain(jrdb_render::notes(&detections.issues)).collect::<Vec<_>>().join("\n");
    args.output.give(perception.config(), &detections, &summary)
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
    let robot = frames[0].robot.clone();
    let pipeline = Pipeline::new(robot, KnownDetections::default(), config);
    let scene = pipeline.see_detections(frames[0].read(), detections)?;
    let entities = scene.entities();
    let lines = entities.entities.iter().map(|e| match e.position {
        None => format!("{} nowhere", e.id),
        Some(p) => {
            let [x, y, z] = p.center;
            format!("{} at {x:.2} {y:.2} {z:.2} m from {} points", e.id, p.points_used)
        }
    });
    let summary = lines.chain(jrdb_render::notes(&entities.issues)).collect::<Vec<_>>().join("\n");
    args.output.give(json!(scene.config().projection), entities, &summary)
}

#[derive(Debug, Args)]
pub(crate) struct GraphArgs {
    /// Entities of one frame
    #[arg(long, value_name = "FILE")]
    entities: PathBuf,
    /// Write the graph in the DOT language of Graphviz, too: interactions, and places within --dot-within
    #[arg(long, value_name = "FILE")]
    dot: Option<PathBuf>,
    /// Largest distance of two things whose relation --dot shows
    #[arg(long, value_name = "METRES", default_value_t = 5.0, requires = "dot")]
    dot_within: f64,
    #[command(flatten)]
    output: OutputArgs,
}

pub(crate) fn graph(args: &GraphArgs) -> Result<ExitCode> {
    let entities: Entities = read_artefact(&args.entities)?;
    let config = jrdb_graph::GraphConfig::default();
    let graph = jrdb_graph::build(&entities, &config);
    if let Some(path) = &args.dot {
        write(path, jrdb_graph::dot(&graph, args.dot_within).as_bytes())?;
    }
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
    let text = only_question(&args.text)?;
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
    /// A question in English or in the notation, instead; - reads standard input, where each line is a question
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
    let queries: Vec<Query> = match (&args.query, &args.text) {
        (Some(path), _) => vec![read_artefact(path)?],
        (None, text) => {
            let texts = questions(text.as_deref().unwrap_or_default())?;
            let read = |text: &String| read_query(text, &args.reading.config());
            texts.iter().map(read).collect::<Result<_, _>>()?
        }
    };
    let config = args.answers.search();
    if config.pooling == Pooling::PerCondition {
        jrdb_graph::make_timeless(&mut graphs);
    }
    if let (true, Some(path)) = (queries.len() > 1, &args.output.out) {
        let found = format!("found {} on standard input", queries.len());
        bail!(Error::Usage(format!("expected one question for the file {path:?}, {found}")));
    }
    for query in &queries {
        answer(args, &graphs, query, &config)?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Answers one question of `search`.
fn answer(
    args: &SearchArgs,
    graphs: &[SceneGraph],
    query: &Query,
    config: &SearchConfig,
) -> Result<ExitCode> {
    let mut answer = match graphs {
        [graph] if query.slots.is_empty() => jrdb_search::search(graph, query, config),
        graphs => jrdb_search::search_frames(graphs, None, query, config),
    };
    if let ([graph], true) = (graphs, args.answers.sensitivity) {
        answer.sensitivity = jrdb_search::sensitivity(graph, query, config);
    }
    let summary = report::answer(query, &answer, args.answers.why_not.as_ref());
    args.output.give(json!(config), &jrdb_render::with_words(answer), summary.trim_end())
}
