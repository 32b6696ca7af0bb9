//! Changed inputs for every reader, in process: what panics, takes long or ends the process is saved.
//!
//! `cargo xtask fuzz [TARGET] [--seconds N]`. The same target and number of a run give the same input.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a command prints")]

mod mutate;
mod random;
mod targets;

use std::fs::File;
use std::io::{Seek, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};
use jrdb_types::contained;

use mutate::mutated;
use random::Random;
use targets::Target;

/// An input that takes longer is a finding.
const SLOW: Duration = Duration::from_secs(5);
/// Seconds for all targets together when none are given.
const SECONDS: u64 = 60;
/// So many findings of a target end its runs.
const FINDINGS_MAX: usize = 10;

/// What was asked for.
struct Asked {
    target: Option<String>,
    seconds: u64,
    folder: PathBuf,
}

fn asked() -> Result<Asked> {
    let mut asked = Asked { target: None, seconds: SECONDS, folder: "target/fuzz".into() };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        match word.as_str() {
            "--seconds" => {
                let number = words.next().unwrap_or_default();
                let expected = || format!("expected --seconds N, found {number:?}");
                asked.seconds = number.parse().with_context(expected)?;
            }
            "--folder" => asked.folder = words.next().unwrap_or_default().into(),
            other if other.starts_with('-') => {
                bail!("expected [TARGET] [--seconds N] [--folder DIR], found {other:?}")
            }
            other => asked.target = Some(other.into()),
        }
    }
    Ok(asked)
}

/// What the runs of a target came to.
#[derive(Default)]
struct Tally {
    runs: u64,
    accepted: u64,
    findings: Vec<String>,
    slowest: Duration,
}

fn main() -> Result<ExitCode> {
    let asked = asked()?;
    std::panic::set_hook(Box::new(|_| {}));
    let scratch = tempfile::tempdir()?;
    let all = targets::all(scratch.path())?;
    let names: Vec<&str> = all.iter().map(|target| target.name).collect();
    let is_asked = |target: &&Target| asked.target.as_ref().is_none_or(|name| name == target.name);
    let chosen: Vec<&Target> = all.iter().filter(is_asked).collect();
    if chosen.is_empty() {
        bail!("expected one of {}, found {:?}", names.join(", "), asked.target);
    }
    std::fs::create_dir_all(&asked.folder)?;
    let count = u32::try_from(chosen.len())?;
    let each = Duration::from_secs(asked.seconds) / count;
    println!(
        "{:<20} {:>8} {:>9} {:>9} {:>11}",
        "target", "runs", "accepted", "findings", "longest ms"
    );
    let mut found = 0;
    for target in chosen {
        let tally = fuzz(target, each, &asked.folder)?;
        let (runs, accepted, findings) = (tally.runs, tally.accepted, tally.findings.len());
        let slowest_ms = tally.slowest.as_secs_f64() * 1e3;
        println!("{:<20} {runs:>8} {accepted:>9} {findings:>9} {slowest_ms:>11.1}", target.name);
        tally.findings.iter().for_each(|finding| println!("  {finding}"));
        found += findings;
    }
    Ok(ExitCode::from(u8::from(found > 0)))
}

fn fuzz(target: &Target, time: Duration, folder: &Path) -> Result<Tally> {
    let (started, mut tally) = (Instant::now(), Tally::default());
    let own = tempfile::tempdir()?;
    // An abort leaves the input that caused it.
    let path = folder.join(format!("{}.current", target.name));
    let mut current = File::create(&path)?;
    while started.elapsed() < time && tally.findings.len() < FINDINGS_MAX {
        let mut random = Random::of(target.name, tally.runs);
        let seed = random.pick(&target.seeds);
        let seed = seed.clone();
        let input = mutated(&seed, target.structure, &mut random);
        current.rewind()?;
        current.write_all(&input)?;
        current.set_len(u64::try_from(input.len())?)?;
        let before = Instant::now();
        let read = contained(target.name, || (target.read)(&input, own.path()));
        let took = before.elapsed();
        tally.slowest = tally.slowest.max(took);
        tally.accepted += u64::from(read.as_ref().is_ok_and(|accepted| *accepted));
        let message = match read {
            Err(panic) => Some(panic.to_string()),
            Ok(_) if took > SLOW => Some(format!("took {:.1} s", took.as_secs_f64())),
            Ok(_) => None,
        };
        if let Some(message) = message {
            let path = folder.join(format!("{}-{}", target.name, tally.runs));
            std::fs::write(&path, &input)?;
            tally.findings.push(format!("{}: {message}", path.display()));
        }
        tally.runs += 1;
    }
    std::fs::remove_file(&path)?;
    Ok(tally)
}
