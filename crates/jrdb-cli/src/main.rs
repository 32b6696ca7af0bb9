//! The `jrdb` command.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a command prints")]

mod commands;

use std::process::ExitCode;

use clap::Parser;

fn main() -> ExitCode {
    keep_contained_panics_quiet();
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

/// A contained panic is reported as an error of its frame, so the hook prints only the others; with
/// `RUST_BACKTRACE` set it prints all.
fn keep_contained_panics_quiet() {
    let usual = std::panic::take_hook();
    let wants_all = std::env::var_os("RUST_BACKTRACE").is_some_and(|value| value != "0");
    std::panic::set_hook(Box::new(move |panic| {
        if wants_all || !jrdb_types::is_contained() {
            usual(panic);
        }
    }));
}
