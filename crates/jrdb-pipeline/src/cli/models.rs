//! `jrdb models`.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Result;
use clap::{Args, Subcommand};
use jrdb_pipeline::engine::{EngineOptions, open_engine};
use jrdb_pipeline::light::NANODET_FILE;
use jrdb_pipeline::perceive::SSDLITE_FILE;

use super::say;

#[derive(Debug, Args)]
pub(crate) struct ModelsArgs {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Which models `--perception` knows, and where their files are looked for
    List(Folder),
    /// Load every model that is there
    Check(Folder),
}

#[derive(Debug, Args)]
struct Folder {
    /// Folder with model files
    #[arg(long, default_value = "models", value_name = "DIR")]
    models: PathBuf,
}

/// Name, file, and what it does.
const KNOWN: [(&str, &str, &str); 2] = [
    ("ssdlite", SSDLITE_FILE, "person detector, SSDLite MobileNetV2 300x300"),
    ("nanodet", NANODET_FILE, "detector of people and objects, NanoDet-g 416x416"),
];

pub(crate) fn models(args: &ModelsArgs) -> Result<ExitCode> {
    match &args.command {
        Command::List(folder) => list(folder),
        Command::Check(folder) => check(folder),
    }
}

fn list(folder: &Folder) -> Result<ExitCode> {
    for (name, file, what) in KNOWN {
        let path = folder.models.join(file);
        let state = if path.exists() { "there" } else { "missing" };
        say(&format!("{name:<10} {state:<8} {} ({what})\n", path.display()))?;
    }
    Ok(ExitCode::SUCCESS)
}

fn check(folder: &Folder) -> Result<ExitCode> {
    let options = EngineOptions { models: folder.models.clone(), ..EngineOptions::default() };
    let mut missing = false;
    for (name, file, _) in KNOWN {
        let path = folder.models.join(file);
        match std::fs::read(&path) {
            Ok(bytes) => {
                let (_, note) = open_engine(&bytes, &path, &options)?;
                say(&format!("{name:<10} loads, {note}\n"))?;
            }
            Err(error) => {
                say(&format!("{name:<10} {}: {error}\n", path.display()))?;
                missing = true;
            }
        }
    }
    Ok(ExitCode::from(u8::from(missing)))
}
