//! How many instructions each kernel takes, against what it may take.
//!
//! Instructions under valgrind do not depend on the clock or on who else uses the machine: two runs differ by less
//! than one in ten thousand.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};
use serde_json::{Value, json};

use crate::program::{cargo, root, run, target, usage};

/// The budgets, from the workspace's root.
const BUDGETS: &str = "testdata/budgets.json";

/// The program that runs every kernel once, its package, and its function whose instructions count.
const PROGRAM: &str = "budget_kernels";
const PACKAGE: &str = "jrdb-calibration";
const MEASURED: &str = "budget_kernels::measured";

/// So many parts of a budget may be used above it, or left below it, before we say so.
const TOLERANCE: f64 = 0.1;

/// What a run took, or may take.
#[derive(Debug, PartialEq)]
struct Counts {
    /// The processor's architecture and the widest vector registers that the kernels found.
    registers: String,
    /// The compiler.
    rustc: String,
    /// Instructions of each kernel.
    instructions: BTreeMap<String, u64>,
}

pub(crate) fn budget(flags: &[String]) -> Result<()> {
    let accepts = match flags {
        [] => false,
        [flag] if flag == "--accept" => true,
        other => return usage("--accept or nothing after `budget`", other),
    };
    let valgrind = Command::new("valgrind").arg("--version").stdout(Stdio::null()).status();
    if !valgrind.is_ok_and(|status| status.success()) {
        println!("skipped: no valgrind");
        return Ok(());
    }
    let found = count()?;
    let path = root().join(BUDGETS);
    if accepts {
        std::fs::write(&path, found.text()?)
            .with_context(|| format!("cannot write {}", path.display()))?;
        println!("wrote {BUDGETS}; say in the commit why a budget rose");
        return Ok(());
    }
    let text = std::fs::read_to_string(&path)
        .with_context(|| format!("cannot read {}; make it with --accept", path.display()))?;
    let budgets = Counts::parse(&text).with_context(|| format!("{BUDGETS} is not understood"))?;
    report(&budgets, &found)
}

/// Prints a line for each kernel; an error when one is over its budget.
fn report(budgets: &Counts, found: &Counts) -> Result<()> {
    if found.registers != budgets.registers {
        println!(
            "skipped: budgets are for {}, valgrind here runs {}",
            budgets.registers, found.registers
        );
        return Ok(());
    }
    println!("{:<24}{:>14}{:>14}{:>9}", "kernel", "instructions", "budget", "change");
    let mut faults = 0;
    for (name, verdict) in verdicts(&budgets.instructions, &found.instructions) {
        let number = |of: &Counts| of.instructions.get(&name).map_or("-".into(), u64::to_string);
        let (took, may_take) = (number(found), number(budgets));
        println!("{name:<24}{took:>14}{may_take:>14}{:>9}{}", verdict.change(), verdict.remark());
        faults += usize::from(verdict.is_fault());
    }
    if faults == 0 {
        return Ok(());
    }
    if found.rustc != budgets.rustc {
        println!("the budgets were taken with {}, this is {}", budgets.rustc, found.rustc);
    }
    bail!("{faults} kernels are not within {BUDGETS}; `cargo xtask budget --accept` rewrites it")
}

/// How a kernel stands to its budget.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Verdict {
    /// By what part of the budget it takes more; negative for less.
    Both(f64),
    NoBudget,
    NoKernel,
}

impl Verdict {
    fn is_fault(self) -> bool {
        match self {
            Self::Both(more) => more > TOLERANCE,
            Self::NoBudget | Self::NoKernel => true,
        }
    }

    fn change(self) -> String {
        match self {
            Self::Both(more) => format!("{:+.1} %", more * 100.0),
            Self::NoBudget | Self::NoKernel => String::new(),
        }
    }

    fn remark(self) -> &'static str {
        match self {
            Self::Both(more) if more > TOLERANCE => "  over budget",
            Self::Both(more) if more < -TOLERANCE => "  lower the budget",
            Self::Both(_) => "",
            Self::NoBudget => "  has no budget",
            Self::NoKernel => "  is no kernel any more",
        }
    }
}

fn verdicts(
    budgets: &BTreeMap<String, u64>,
    found: &BTreeMap<String, u64>,
) -> BTreeMap<String, Verdict> {
    let names = budgets.keys().chain(found.keys());
    let verdict = |name: &String| match (budgets.get(name), found.get(name)) {
        (Some(&budget), Some(&took)) => Verdict::Both(took as f64 / budget as f64 - 1.0),
        (None, _) => Verdict::NoBudget,
        (_, None) => Verdict::NoKernel,
    };
    names.map(|name| (name.clone(), verdict(name))).collect()
}

/// Builds the program, runs it under valgrind and reads what each kernel took.
fn count() -> Result<Counts> {
    run(cargo().args([
        "build",
        "--quiet",
        "--release",
        "--package",
        PACKAGE,
        "--example",
        PROGRAM,
    ]))?;
    let folder = target().join("budget");
    if folder.exists() {
        std::fs::remove_dir_all(&folder)
            .with_context(|| format!("cannot empty {}", folder.display()))?;
    }
    std::fs::create_dir_all(&folder)
        .with_context(|| format!("cannot create {}", folder.display()))?;
    let counts = folder.join("counts");
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--quiet"])
        .arg(format!("--toggle-collect={MEASURED}"))
        .arg(format!("--dump-after={MEASURED}"))
        .arg(format!("--callgrind-out-file={}", counts.display()))
        .arg(target().join("release/examples").join(PROGRAM))
        .stderr(Stdio::inherit())
        .output()
        .context("cannot start valgrind")?;
    if !output.status.success() {
        bail!("{PROGRAM} failed under valgrind: {}", output.status);
    }
    let text = String::from_utf8_lossy(&output.stdout);
    let mut lines = text.lines().map(String::from);
    let registers = lines.next().with_context(|| format!("{PROGRAM} printed nothing"))?;
    let took = |(number, name)| Ok((name, total(&part(&counts, number))?));
    let instructions = (1..).zip(lines).map(took).collect::<Result<_>>()?;
    Ok(Counts { registers, rustc: rustc()?, instructions })
}

/// Where valgrind writes what it counted in the `number`th run of [`MEASURED`].
fn part(counts: &Path, number: usize) -> PathBuf {
    counts.with_extension(number.to_string())
}

fn total(path: &Path) -> Result<u64> {
    let text = std::fs::read_to_string(path).with_context(|| {
        format!("valgrind did not stop after {MEASURED}: cannot read {}", path.display())
    })?;
    let total = text.lines().find_map(|line| line.strip_prefix("totals: "));
    let number = total.and_then(|number| number.trim().parse().ok()).filter(|&number| number > 0);
    number
        .with_context(|| format!("expected a count over 0 in {}, found {total:?}", path.display()))
}

fn rustc() -> Result<String> {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let output = Command::new(rustc).arg("--version").output().context("cannot start rustc")?;
    Ok(String::from_utf8_lossy(&output.stdout).trim().into())
}

impl Counts {
    fn text(&self) -> Result<String> {
        let Self { registers, rustc, instructions } = self;
        let value = json!({ "registers": registers, "rustc": rustc, "instructions": instructions });
        Ok(serde_json::to_string_pretty(&value)? + "\n")
    }

    fn parse(text: &str) -> Result<Self> {
        let value: Value = serde_json::from_str(text)?;
        let word = |key: &str| {
            let word = value[key].as_str().map(String::from);
            word.with_context(|| format!("expected a text {key:?}"))
        };
        let numbers = value["instructions"].as_object().context("expected \"instructions\"")?;
        let number = |(name, number): (&String, &Value)| {
            let number = number.as_u64().filter(|&number| number > 0);
            let number = number.with_context(|| format!("expected a count over 0 of {name}"))?;
            Ok((name.clone(), number))
        };
        let instructions = numbers.iter().map(number).collect::<Result<_>>()?;
        Ok(Self { registers: word("registers")?, rustc: word("rustc")?, instructions })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(numbers: &[(&str, u64)]) -> Counts {
        let instructions = numbers.iter().map(|&(name, number)| (name.into(), number)).collect();
        Counts { registers: "x86-64, AVX2".into(), rustc: "rustc 1".into(), instructions }
    }

    #[test]
    fn a_tenth_more_is_borne_and_a_tenth_less_is_remarked() {
        let budgets = counts(&[("a", 1000), ("b", 1000), ("c", 1000)]);
        let found = counts(&[("a", 1099), ("b", 899), ("c", 1101)]);
        let verdicts = verdicts(&budgets.instructions, &found.instructions);
        assert_eq!(["a", "b", "c"].map(|name| verdicts[name].is_fault()), [false, false, true]);
        let remarks = ["a", "b", "c"].map(|name| verdicts[name].remark().trim());
        assert_eq!(remarks, ["", "lower the budget", "over budget"]);
        assert!(report(&budgets, &found).is_err());
    }

    #[test]
    fn kernels_and_budgets_must_be_the_same_ones() {
        let (old, new) = (counts(&[("old", 1)]), counts(&[("new", 1)]));
        let verdicts = verdicts(&old.instructions, &new.instructions);
        assert_eq!(verdicts["old"], Verdict::NoKernel);
        assert_eq!(verdicts["new"], Verdict::NoBudget);
        assert!(verdicts.values().all(|verdict| verdict.is_fault()));
    }

    #[test]
    fn other_registers_are_not_compared() {
        let budgets = counts(&[("a", 1000)]);
        let found = Counts { registers: "aarch64".into(), ..counts(&[("a", 9000)]) };
        assert!(report(&budgets, &found).is_ok());
    }

    #[test]
    fn budgets_survive_the_round_trip_and_say_what_is_wrong() {
        let counts = counts(&[("a", 1000), ("b", 2)]);
        assert_eq!(Counts::parse(&counts.text().unwrap()).unwrap(), counts);
        let zero = counts.text().unwrap().replace("1000", "0");
        assert_eq!(Counts::parse(&zero).unwrap_err().to_string(), "expected a count over 0 of a");
    }
}
