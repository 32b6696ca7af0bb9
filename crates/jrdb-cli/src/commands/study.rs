//! `jrdb study`.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Context, Result};
use clap::Args;
use jrdb_cli::study::{Study, StudyOptions, budget_text};

use super::args::EngineArgs;
use super::print::say;
use super::progress::Progress;

/// Flags of `study`.
#[derive(Debug, Args)]
pub(crate) struct StudyArgs {
    /// The plan: data, methods and tables, as docs/evaluation.md describes it
    plan: PathBuf,
    /// Folder for scores and tables; what is there of the same study is reused
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    engine: EngineArgs,
    /// The root of a JRDB tree, instead of the plan's
    #[arg(long, value_name = "ROOT")]
    dataset: Option<PathBuf>,
    /// Questions with their truth, instead of the plan's; may be repeated
    #[arg(long, value_name = "FILE")]
    questions: Vec<PathBuf>,
    /// Worker threads; one per core when absent
    #[arg(long, value_name = "N")]
    threads: Option<std::num::NonZeroUsize>,
}

pub(crate) fn study(args: &StudyArgs) -> Result<ExitCode> {
    let options = StudyOptions {
        plan: args.plan.clone(),
        out: args.out.clone(),
        dataset: args.dataset.clone(),
        questions: args.questions.clone(),
        engine: args.engine.options(),
        threads: args.threads.map(usize::from),
        ..StudyOptions::default()
    };
    options.interrupt.listen().context("cannot listen to Ctrl-C")?;
    let study = Study::open(&options)?;
    let progress = Progress::new("recordings", study.step_count()?);
    let result = study.execute(|step| {
        progress.now_at(format!("{}: {}", step.method, step.what));
        progress.advance();
    });
    progress.finish();
    if let Some((signal, code)) = options.interrupt.came() {
        eprintln!("interrupted by {signal}: the same command completes the study");
        return Ok(ExitCode::from(code));
    }
    let result = result?;
    for table in &result.tables {
        say(&format!("{}\n", jrdb_study::text(table)))?;
    }
    say(&format!("{}\n", jrdb_study::text(&result.parameters)))?;
    say(&budget_text(&result.budget))?;
    say(&format!("tables are in {}\n", args.out.display()))?;
    for (method, why) in &result.failures {
        eprintln!("error: {method}: {why}");
    }
    Ok(if result.failures.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
