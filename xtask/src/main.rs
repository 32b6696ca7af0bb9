//! Developer commands: `cargo xtask <command>`. They start other programs through cargo and depend on none
//! of the crates.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a command prints")]

mod budget;
mod cycles;
mod fuzz;
mod law;
mod peers;
mod pipeline;
mod program;
mod tidy;

use std::process::{Command, ExitCode};

use program::{Failed, USAGE, run};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (command, rest) = match arguments.split_first() {
        Some((command, rest)) => (command.as_str(), rest),
        None => ("help", &[][..]),
    };
    let done = match command {
        "pipeline" => pipeline::pipeline(rest),
        "models" => pipeline::models(rest),
        "scenes" => pipeline::scenes(),
        "budget" => budget::budget(rest),
        "fuzz" => fuzz::fuzz(rest),
        "peers" => peers::peers(rest),
        "tidy" => tidy::tidy(),
        "ci" => run(Command::new("bash").arg(".ci/run")),
        "help" | "--help" | "-h" => {
            println!("{USAGE}");
            return ExitCode::SUCCESS;
        }
        other => {
            eprintln!("error: expected one of the commands below, found {other:?}\n{USAGE}");
            return ExitCode::from(2);
        }
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => match error.downcast_ref::<Failed>() {
            // The program has said why.
            Some(failed) => ExitCode::from(failed.code),
            None => {
                eprintln!("error: {error:#}");
                ExitCode::FAILURE
            }
        },
    }
}
