//! `jrdb compare`: whether two methods differ on the same questions.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Result;
use clap::Args;
use jrdb_cli::Error;
use jrdb_cli::output::read_artefact;
use jrdb_metrics::BootstrapConfig;
use jrdb_types::Scores;
use serde_json::json;

use super::stage::OutputArgs;

/// File of the scores in a folder.
const SCORES: &str = "scores.json";
/// Folder of the methods in that of a study.
const METHODS: &str = "methods";

/// Flags of `compare`.
#[derive(Debug, Args)]
pub(crate) struct CompareArgs {
    /// Scores: a file, the folder of a run, or DIR:METHOD of a study
    #[arg(value_name = "A")]
    a: String,
    /// Scores of the same questions, to be compared with them
    #[arg(value_name = "B")]
    b: String,
    /// Draws of the bootstrap over recordings
    #[arg(long, default_value_t = BootstrapConfig::default().draws, value_name = "N")]
    draws: usize,
    /// Seed of the draws
    #[arg(long, default_value_t = BootstrapConfig::default().seed, value_name = "N")]
    seed: u64,
    #[command(flatten)]
    output: OutputArgs,
}

pub(crate) fn compare(args: &CompareArgs) -> Result<ExitCode> {
    let [a, b] = [scores(&args.a)?, scores(&args.b)?];
    let config = BootstrapConfig { draws: args.draws, seed: args.seed };
    let comparison = jrdb_metrics::compare(&a, &b, &config).map_err(|error| {
        let why = jrdb_types::with_causes(&error);
        Error::Usage(format!(
            "{} and {} cannot be compared: {why}; score both by the same questions and flags",
            args.a, args.b
        ))
    })?;
    let words = jrdb_render::comparison(&comparison);
    args.output.give(json!({ "draws": args.draws, "seed": args.seed }), &comparison, &words)
}

fn scores(name: &str) -> Result<Scores, Error> {
    read_artefact(&file(name)?)
}

/// The file of scores that a name stands for.
fn file(name: &str) -> Result<PathBuf, Error> {
    let path = Path::new(name);
    if path.is_dir() {
        return in_folder(path);
    }
    match name.rsplit_once(':') {
        Some((folder, method)) if Path::new(folder).join(METHODS).is_dir() => {
            of_method(Path::new(folder), method)
        }
        _ => Ok(path.into()),
    }
}

fn in_folder(folder: &Path) -> Result<PathBuf, Error> {
    let path = folder.join(SCORES);
    if path.is_file() {
        return Ok(path);
    }
    let methods = methods(folder);
    let folder = folder.display();
    Err(Error::Usage(match methods.is_empty() {
        true => format!(
            "expected {SCORES} in {folder}, found none: jrdb run --out DIR writes it where \
             questions have a known answer"
        ),
        false => format!(
            "expected a method of the study in {folder}, as {folder}:METHOD, found none named: \
             there are {}",
            methods.join(", ")
        ),
    }))
}

fn of_method(folder: &Path, method: &str) -> Result<PathBuf, Error> {
    let methods = methods(folder);
    if methods.iter().any(|known| known == method) {
        return Ok(folder.join(METHODS).join(method).join(SCORES));
    }
    let (folder, methods) = (folder.display(), methods.join(", "));
    Err(Error::Usage(format!("expected a method of {folder} ({methods}), found {method:?}")))
}

/// The methods of a study that have scores.
fn methods(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder.join(METHODS)).into_iter().flatten().flatten();
    let scored = entries.filter(|entry| entry.path().join(SCORES).is_file());
    let mut names: Vec<String> =
        scored.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}
