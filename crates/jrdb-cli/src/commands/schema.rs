//! `jrdb schema`.

use std::process::ExitCode;

use anyhow::Result;
use clap::Args;
use jrdb_cli::Error;

use super::print::say;

#[derive(Debug, Args)]
pub(crate) struct SchemaArgs {
    /// Name of an artefact, for example jrdb.query; all names when absent
    name: Option<String>,
}

pub(crate) fn schema(args: &SchemaArgs) -> Result<ExitCode> {
    let all = jrdb_types::schema::all();
    let names: Vec<&str> = all.iter().map(|artefact| artefact.name).collect();
    let Some(name) = &args.name else {
        say(&format!("{}\n", names.join("\n")))?;
        return Ok(ExitCode::SUCCESS);
    };
    let found = all.iter().find(|artefact| artefact.name == name);
    let found =
        found.ok_or_else(|| Error::Usage(format!("expected one of {names:?}, found {name:?}")))?;
    say(&found.to_json())?;
    Ok(ExitCode::SUCCESS)
}
