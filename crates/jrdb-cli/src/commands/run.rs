//! `jrdb run`.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

use anyhow::{Context, Result};
use clap::{Args, ValueEnum};
use jrdb_cli::health::{self, Demands};
use jrdb_cli::report::{Detail, JsonForm, JsonReport, Telling};
use jrdb_cli::run_folder::{Existing, Found};
use jrdb_cli::{Error, FrameResult, Run, RunOptions, RunSummary, report};
use jrdb_pipeline::{PipelineConfig, read_query};

use super::args::{Iou, PerceptionArgs, ProjectionArgs, SourceArgs};
use super::print::{say, tell_profile};
use super::progress::Progress;
use super::question::{AnswerArgs, ReadingArgs};

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
    questions: Vec<PathBuf>,
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
    /// Remove the files of another run in the folder first
    #[arg(long, requires = "out", conflicts_with = "resume")]
    overwrite: bool,
    /// Complete the folder of this run, which was interrupted; the same command without this flag does so, too
    #[arg(long, requires = "out")]
    resume: bool,
    /// Worker threads; the output does not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Tell every condition with its number and margin, and the nearest misses
    #[arg(long)]
    explain: bool,
    /// Print how many questions are answered as the truth says, and only the others
    #[arg(long, conflicts_with = "explain")]
    brief: bool,
    /// How results are printed
    #[arg(long, value_enum, default_value_t)]
    format: RunFormat,
    /// Exit with 1 when a part of a frame's input could not be used, and not only when a frame failed
    #[arg(long)]
    strict: bool,
    /// Exit with 3 when a question cannot be answered: it is unknown or not understood
    #[arg(long)]
    require_answer: bool,
}

/// How results are printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
enum RunFormat {
    /// For people
    #[default]
    Text,
    /// For programs: one document
    Json,
    /// For programs: a line for each answer, then one for the run
    Jsonl,
}

impl RunArgs {
    fn telling(&self) -> Telling {
        let detail = match (self.explain, self.brief) {
            (true, _) => Detail::Full,
            (_, true) => Detail::Misses,
            _ => Detail::Brief,
        };
        Telling { detail, why_not: self.answers.why_not.clone() }
    }

    fn options(&self) -> Result<RunOptions, Error> {
        let mut config = PipelineConfig::default();
        self.projection.apply(&mut config);
        self.iou.apply(&mut config);
        self.answers.apply(&mut config);
        config.parser = self.reading.config();
        let read = |text: &String| read_query(text, &config.parser).map(Arc::new);
        let queries = self.query.iter().map(read).collect::<Result<_, _>>()?;
        Ok(RunOptions {
            sources: self.source.sources()?,
            robot: self.source.robot(),
            frames: self.source.frames.clone(),
            perception: self.perception.perception.clone(),
            demographics: self.perception.demographics.into(),
            engine: self.perception.engine(),
            robot_stands: self.robot_stands,
            baseline: self.baseline,
            queries,
            questions: self.questions.clone(),
            config,
            threads: self.threads.map(usize::from),
            out: self.out.clone(),
            interrupt: jrdb_cli::interrupt::Interrupt::default(),
            existing: if self.overwrite { Existing::Overwrite } else { Existing::Refuse },
            artifacts: self.artifacts,
        })
    }
}

pub(crate) fn run(args: &RunArgs) -> Result<ExitCode> {
    let options = args.options()?;
    let run = Run::open(&options)?;
    tell_found(&run, args);
    options.interrupt.listen().context("cannot listen to Ctrl-C")?;
    let progress = Progress::new("frames", run.frame_count());
    let mut printer = Printer::new(args, &options.config);
    printer.notes(run.notes())?;
    let mut failed = None;
    let summary = run.execute(|result| {
        let printed = progress.suspend(|| printer.frame(&result));
        progress.advance();
        match printed {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => {
                failed = Some(error);
                ControlFlow::Break(())
            }
        }
    });
    progress.finish();
    tell_profile(&options.engine);
    if let Some(error) = failed {
        return Err(error);
    }
    let summary = summary?;
    printer.end(&summary)?;
    if let (true, Some((signal, code))) = (summary.is_cut_short, options.interrupt.came()) {
        tell_interrupted(signal, args);
        return Ok(ExitCode::from(code));
    }
    if let (RunFormat::Text, Some(out)) = (args.format, &args.out) {
        say(&format!("answers and pictures are in {}\n", out.display()))?;
    }
    for (frame, error) in &summary.failures {
        eprintln!("error: {frame}: {error}");
    }
    if let Some(line) = summary.health.line() {
        eprintln!("{line}");
    }
    let demands = Demands { strict: args.strict, require_answer: args.require_answer };
    Ok(ExitCode::from(health::exit_code(&summary.health, demands)))
}

/// Says what the folder held before, where that matters.
fn tell_found(run: &Run<'_>, args: &RunArgs) {
    let out = args.out.as_deref().unwrap_or_else(|| Path::new("")).display();
    match run.found() {
        Some(Found::Complete) => {
            eprintln!(
                "note: {out} holds this run, complete; its files are checked and written again"
            );
        }
        Some(Found::Incomplete) => {
            eprintln!("note: {out} holds this run, interrupted; it is completed");
        }
        Some(Found::Nothing) if args.resume => {
            eprintln!("note: {out} holds nothing of this run; it is started");
        }
        _ => {}
    }
}

fn tell_interrupted(signal: &str, args: &RunArgs) {
    let next = match &args.out {
        Some(_) => "the folder is not complete: the same command with --resume completes it",
        None => "what was answered is printed",
    };
    eprintln!("interrupted by {signal} before the last frame; {next}");
}

/// Prints results as they come.
enum Printer<'a> {
    Text(Telling),
    Json(JsonReport, &'a PipelineConfig),
}

impl<'a> Printer<'a> {
    fn new(args: &RunArgs, config: &'a PipelineConfig) -> Self {
        match args.format {
            RunFormat::Text => Self::Text(args.telling()),
            RunFormat::Json => Self::Json(JsonReport::new(JsonForm::Document), config),
            RunFormat::Jsonl => Self::Json(JsonReport::new(JsonForm::Lines), config),
        }
    }

    fn notes(&self, notes: &[String]) -> Result<()> {
        match self {
            Self::Text(_) => notes.iter().try_for_each(|note| say(&format!("{note}\n"))),
            Self::Json(..) => {
                notes.iter().for_each(|note| eprintln!("{note}"));
                Ok(())
            }
        }
    }

    fn frame(&mut self, result: &FrameResult) -> Result<()> {
        match self {
            Self::Text(telling) => say(&report::frame(result, telling)),
            Self::Json(report, config) => {
                let mut outputs = result.output.iter();
                outputs.try_for_each(|output| say(&report.frame(output, config)))
            }
        }
    }

    fn end(self, summary: &RunSummary) -> Result<()> {
        match self {
            Self::Text(telling) => say(&report::summary(summary, &telling)),
            Self::Json(mut report, config) => {
                for answered in &summary.recordings {
                    say(&report.answer(&answered.answer, config))?;
                }
                say(&report.end(summary, config))
            }
        }
    }
}
