//! Changed inputs for every reader: `cargo xtask fuzz`.

use anyhow::Result;

use crate::program::{build, built, root, run};

/// Below the workspace's root, where inputs that do harm are saved.
const FINDINGS: &str = "target/fuzz";

/// Starts the fuzzer of the command's package, built with overflow checks; flags are passed on. A process that is ended by an
/// input leaves the input as `TARGET.current`.
pub(crate) fn fuzz(flags: &[String]) -> Result<()> {
    build(&["--quiet", "--example", "fuzz"])?;
    run(built("examples/fuzz").arg("--folder").arg(root().join(FINDINGS)).args(flags))
}
