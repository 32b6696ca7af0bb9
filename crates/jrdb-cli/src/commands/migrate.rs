//! `jrdb migrate`.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Result, bail};
use clap::Args;
use jrdb_cli::Error;
use jrdb_cli::migrate::{Migrated, migrate as to_present};
use jrdb_cli::output::write;
use jrdb_types::with_causes;

use super::print::say;

#[derive(Debug, Args)]
pub(crate) struct MigrateArgs {
    /// An artefact that an earlier version of this program wrote
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// File for the artefact of the present version; standard output when absent
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

pub(crate) fn migrate(args: &MigrateArgs) -> Result<ExitCode> {
    let path = &args.file;
    let read = |source| Error::File { action: "read", path: path.clone(), source };
    let text = std::fs::read_to_string(path).map_err(read)?;
    let migrated = match to_present(&text) {
        Ok(migrated) => migrated,
        Err(error) => bail!(Error::Usage(format!("{path:?}: {}", with_causes(&error)))),
    };
    let text = match migrated {
        Migrated::Present => {
            eprintln!("{} is of the present version", path.display());
            text
        }
        Migrated::Changed(text) => text,
    };
    match &args.out {
        Some(out) => write(out, text.as_bytes())?,
        None => say(&text)?,
    }
    Ok(ExitCode::SUCCESS)
}
