//! The `jrdb` command.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a command prints")]

mod commands;

use std::process::ExitCode;

use clap::Parser;

fn main() -> ExitCode {
    match commands::dispatch(commands::Cli::parse()) {
        Ok(code) => code,
        Err(error) => {
            eprintln!("error: {}", jrdb_types::with_causes(error.as_ref()));
            let known = error.downcast_ref::<jrdb_cli::Error>();
            for hint in known.into_iter().flat_map(commands::hints) {
                eprintln!("hint: {hint}");
            }
            ExitCode::from(known.map_or(1, jrdb_cli::Error::exit_code))
        }
    }
}
