//! What commands print.

use std::io::{ErrorKind, Write};

use anyhow::{Context, Result};
use clap::ValueEnum;
use jrdb_models::loader::EngineOptions;

/// How results are printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub(crate) enum Format {
    /// For people.
    #[default]
    Text,
    /// For programs: one document
    Json,
}

/// Writes to standard output. Whoever stops reading, as `head` does, has read enough.
pub(crate) fn say(text: &str) -> Result<()> {
    match std::io::stdout().lock().write_all(text.as_bytes()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(error).context("cannot write to standard output")
        }
        _ => Ok(()),
    }
}

/// Says on stderr where the models' time went, if that was asked for.
pub(crate) fn tell_profile(engine: &EngineOptions) {
    if let Some(profile) = &engine.profile {
        eprint!("{}", profile.table());
    }
}
