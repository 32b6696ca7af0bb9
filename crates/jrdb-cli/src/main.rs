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
            for hint in commands::hints(&error) {
                eprintln!("hint: {hint}");
            }
            ExitCode::from(commands::exit_code(&error))
        }
    }
}
