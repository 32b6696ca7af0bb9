//! Starting other programs, and what is said when that is not possible.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

/// What the developer commands are.
pub(crate) const USAGE: &str = "\
cargo xtask pipeline [flags of `jrdb run`]   run the pipeline; unless flags say otherwise: the bundled scenes, seen by the
                                             demo's models, into out/
cargo xtask pipeline --verbose               the same, printing every question and not only the misses
cargo xtask pipeline --check                 compare every stage's artefact with its committed snapshot
cargo xtask pipeline --accept                rewrite the snapshots; read the difference before you commit
cargo xtask models list|fetch|check|params [flags]  model files, as `jrdb models` does it
cargo xtask scenes                           make the bundled scenes anew
cargo xtask budget                           count each kernel's instructions against testdata/budgets.json
cargo xtask budget --accept                  rewrite the budgets; say in the commit why one rose
cargo xtask peers [--peers DIR] [--python PATH]
                                             time our kernels beside what people run today, and print the ratios
cargo xtask fuzz [TARGET] [--seconds N]      feed changed inputs to every reader; what does harm is saved in target/fuzz
cargo xtask tidy                             check the rules of docs/architecture.md and docs/style.md
cargo xtask ci                               all that CI runs";

/// A program that ended with another exit code than 0.
#[derive(Debug)]
pub(crate) struct Failed {
    pub(crate) code: u8,
}

impl std::fmt::Display for Failed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "exit code {}", self.code)
    }
}

impl std::error::Error for Failed {}

/// The workspace's root folder.
pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().map_or_else(|| ".".into(), Path::to_path_buf)
}

/// Says that a command was not given what it takes: bad usage.
pub(crate) fn usage<T>(expected: &str, found: &[String]) -> Result<T> {
    refuse(&format!("expected {expected}, found {found:?}\n{USAGE}"))
}

/// Says that a command cannot start with what it was given.
pub(crate) fn refuse<T>(why: &str) -> Result<T> {
    eprintln!("error: {why}");
    bail!(Failed { code: 2 })
}

/// Where cargo builds.
pub(crate) fn target() -> PathBuf {
    let folder = std::env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into());
    root().join(folder)
}

/// Runs a program in the workspace's root; its exit code is passed on.
pub(crate) fn run(command: &mut Command) -> Result<()> {
    run_in(&root(), command)
}

/// Runs a program in a folder; its exit code is passed on.
pub(crate) fn run_in(folder: &Path, command: &mut Command) -> Result<()> {
    let status = command
        .current_dir(folder)
        .status()
        .with_context(|| format!("cannot start {command:?}"))?;
    match status.code() {
        Some(0) => Ok(()),
        Some(code) => bail!(Failed { code: u8::try_from(code).unwrap_or(1) }),
        None => bail!("{command:?} was stopped by a signal"),
    }
}

/// The cargo that started us.
pub(crate) fn cargo() -> Command {
    Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
}

/// A light example. Whoever builds an example or a test beside a program gets the features that the
/// tests of the workspace select; without one, `cargo test` would compile most crates again.
const LIGHT_EXAMPLE: &str = "interval_speed";

/// Builds programs of the workspace as its tests have them. `selection` holds flags such as
/// `--bin NAME`.
pub(crate) fn build(selection: &[&str]) -> Result<()> {
    run(cargo().args(["build", "--workspace", "--example", LIGHT_EXAMPLE]).args(selection))
}

/// A program that [`build`] left below the folder of the profile.
pub(crate) fn built(program: &str) -> Command {
    Command::new(target().join("debug").join(format!("{program}{}", std::env::consts::EXE_SUFFIX)))
}
