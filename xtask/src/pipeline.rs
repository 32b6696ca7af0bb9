//! The pipeline on the bundled scenes, and its snapshots.

use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result};

use crate::program::{build, built, cargo, root, run, run_in};

/// Where the bundled scenes are, from the workspace's root.
const SCENES: &str = "testdata/scenes";

pub(crate) fn pipeline(flags: &[String]) -> Result<()> {
    match flags {
        [flag] if flag == "--check" => snapshots("no"),
        [flag] if flag == "--accept" => snapshots("always"),
        flags if flags.iter().any(|flag| names_source(flag)) => run_here("run", flags),
        flags => bundled_run(flags),
    }
}

/// `jrdb models` with these flags.
pub(crate) fn models(flags: &[String]) -> Result<()> {
    run_here("models", flags)
}

/// The program starts where the user stands, so that relative paths in flags hold.
fn run_here(command: &str, flags: &[String]) -> Result<()> {
    let here = std::env::current_dir().context("cannot tell the current folder")?;
    build_jrdb()?;
    run_in(&here, jrdb().arg(command).args(flags))
}

/// Whether a flag says on what to run.
fn names_source(flag: &str) -> bool {
    ["--scene", "--dataset", "--help", "-h"].iter().any(|name| flag.starts_with(name))
}

/// The flag that prints every question instead of the misses.
const VERBOSE: &str = "--verbose";

/// All bundled scenes, seen by the demo's models unless the flags say otherwise, into `out/`.
fn bundled_run(flags: &[String]) -> Result<()> {
    eprintln!("building jrdb: a few minutes the first time, seconds later");
    build_jrdb()?;
    let scenes = bundled()?;
    let count = scenes.len();
    eprintln!("running all stages on {count} bundled scenes: about half a minute on two cores");
    let mut command = jrdb();
    command.arg("run");
    for scene in scenes {
        command.arg("--scene").arg(scene);
    }
    let is_given = |name: &str| flags.iter().any(|flag| flag.starts_with(name));
    if !is_given("--perception") {
        command.args(["--perception", "demo"]);
    }
    if !is_given("--out") {
        command.args(["--artifacts", "--out", "out", "--overwrite"]);
    }
    if !is_given(VERBOSE) && !is_given("--format") && !is_given("--explain") {
        command.arg("--brief");
    }
    run(command.args(flags.iter().filter(|flag| *flag != VERBOSE)))?;
    if flags.is_empty() { bundled_study() } else { Ok(()) }
}

/// The plan that compares methods on the bundled scenes, and where its tables go.
const STUDY: &str = "testdata/study.yaml";
const STUDY_OUT: &str = "out/study";

/// The table that the run ends with.
fn bundled_study() -> Result<()> {
    eprintln!("comparing methods on the same questions: about a minute on two cores");
    run(jrdb().arg("study").arg(root().join(STUDY)).args(["--out", STUDY_OUT]))
}

/// Makes the bundled scenes anew from their `scene.json`.
pub(crate) fn scenes() -> Result<()> {
    build_jrdb()?;
    for scene in bundled()? {
        run(jrdb()
            .arg("synth")
            .arg("--config")
            .arg(scene.join("scene.json"))
            .arg("--out")
            .arg(&scene))?;
    }
    Ok(())
}

fn build_jrdb() -> Result<()> {
    build(&["--bin", "jrdb"])
}

fn jrdb() -> Command {
    built("jrdb")
}

fn bundled() -> Result<Vec<PathBuf>> {
    let folder = root().join(SCENES);
    let entries =
        std::fs::read_dir(&folder).with_context(|| format!("cannot list {}", folder.display()))?;
    let mut names: Vec<_> = entries.filter_map(|entry| Some(entry.ok()?.file_name())).collect();
    names.sort();
    Ok(names.into_iter().map(|name| PathBuf::from(SCENES).join(name)).collect())
}

fn snapshots(update: &str) -> Result<()> {
    let mut command = cargo();
    command.args(["test", "--quiet", "--workspace", "--test", "snapshots"]);
    run(command.env("INSTA_UPDATE", update).env("RUST_BACKTRACE", "0"))
}
