//! The rules that a compiler does not check.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use serde_json::Value;

use crate::cycles::{before_tests, circles};
use crate::law::{LAW, Row, table};
use crate::program::{cargo, root};

/// Only crates that may touch the world may use these.
const WORLD: [&str; 8] = [
    "std::env",
    "std::fs",
    "std::net",
    "std::process",
    "std::time",
    "CARGO_MANIFEST_DIR",
    "println!",
    "eprintln!",
];

/// A file may have this many lines before its tests.
const LINES_MAX: usize = 400;

/// Text that has no place in the repository: paths of somebody's machine.
const HOST_PATHS: [&str; 3] = ["/home/", "/root/", "/Users/"];

pub(crate) fn tidy() -> Result<()> {
    let mut faults = dependency_faults()?;
    faults.extend(table_fault()?);
    for row in LAW {
        let folder = root().join(row.folder());
        faults.extend(page_faults(row, &folder)?);
        let files = rust_files(&folder.join("src"))?;
        for file in &files {
            faults.extend(source_faults(row, file)?);
        }
        let circles = circles(&folder.join("src"), &files, &root())?;
        faults.extend(
            circles.iter().map(|files| {
                format!("these files use each other in a circle: {}", files.join(", "))
            }),
        );
    }
    for fault in &faults {
        eprintln!("tidy: {fault}");
    }
    if faults.is_empty() {
        println!("tidy: {} crates keep the law", LAW.len());
        return Ok(());
    }
    bail!("{} rules are broken", faults.len())
}

fn dependency_faults() -> Result<Vec<String>> {
    let output = cargo()
        .args(["metadata", "--no-deps", "--format-version", "1", "--offline"])
        .current_dir(root())
        .output()
        .context("cannot start cargo metadata")?;
    let metadata: Value =
        serde_json::from_slice(&output.stdout).context("cargo metadata is not JSON")?;
    let packages = metadata["packages"].as_array().context("cargo metadata lists no packages")?;
    let mut faults = Vec::new();
    for package in packages {
        let name = package["name"].as_str().unwrap_or_default();
        match LAW.iter().find(|row| row.name == name) {
            Some(row) => faults.extend(package_faults(row, package)),
            None => faults.push(format!("{name} has no row in xtask/src/law.rs")),
        }
    }
    let known = |row: &&Row| !packages.iter().any(|package| package["name"] == row.name);
    faults.extend(
        LAW.iter()
            .filter(known)
            .map(|row| format!("the law names {}, which is no package", row.name)),
    );
    Ok(faults)
}

/// Faults in what a package depends on; its tests may depend on anything.
fn package_faults(row: &Row, package: &Value) -> Vec<String> {
    let dependencies = package["dependencies"].as_array().map(Vec::as_slice).unwrap_or_default();
    let normal = dependencies.iter().filter(|d| d["kind"].is_null());
    let names = normal.filter_map(|dependency| dependency["name"].as_str());
    let is_ours = |name: &str| LAW.iter().any(|row| row.name == name);
    let allowed = |name: &&str| match is_ours(name) {
        true => row.ours.contains(name),
        false => row.others.is_none_or(|others| others.contains(name)),
    };
    let broken = names.filter(|name| !allowed(name));
    broken.map(|name| format!("{} may not depend on {name}", row.name)).collect()
}

fn table_fault() -> Result<Option<String>> {
    let path = root().join("docs/architecture.md");
    let text = read(&path)?;
    let fault = || format!("docs/architecture.md must hold this table:\n{}", table());
    Ok((!text.contains(&table())).then(fault))
}

fn page_faults(row: &Row, folder: &Path) -> Result<Vec<String>> {
    if row.name == "xtask" {
        return Ok(Vec::new());
    }
    let page = read(&folder.join("README.md"))?;
    let library = read(&folder.join("src/lib.rs"))?;
    let mut faults = Vec::new();
    if !page.starts_with(&format!("# {}\n", row.name)) {
        faults.push(format!("the README of {} must start with its name", row.name));
    }
    if !library.starts_with("#![doc = include_str!(\"../README.md\")]") {
        faults.push(format!("the documentation of {} must be its README", row.name));
    }
    Ok(faults)
}

fn source_faults(row: &Row, path: &Path) -> Result<Vec<String>> {
    let text = read(path)?;
    let shown = path.strip_prefix(root()).unwrap_or(path).display().to_string();
    let code = before_tests(&text);
    let mut faults = Vec::new();
    let lines = code.lines().count();
    if lines > LINES_MAX {
        faults.push(format!("{shown} has {lines} lines before its tests, more than {LINES_MAX}"));
    }
    faults.extend(flags(code).into_iter().map(|(line, name)| {
        format!("{shown}:{line}: {name} has a bool parameter: take an enum, or make two functions")
    }));
    for (line, number) in code.lines().zip(1..) {
        let is_comment = line.trim_start().starts_with("//");
        if let Some(word) =
            WORLD.iter().find(|word| !row.touches_the_world && !is_comment && line.contains(*word))
        {
            faults.push(format!("{shown}:{number}: {} may not use {word}", row.name));
        }
        if let Some(path) =
            HOST_PATHS.iter().find(|path| line.contains(*path) && !shown.ends_with("tidy.rs"))
        {
            faults.push(format!("{shown}:{number}: a path of somebody's machine, {path}"));
        }
    }
    Ok(faults)
}

/// Public functions with a `bool` among their parameters, each with its line.
fn flags(code: &str) -> Vec<(usize, &str)> {
    let starts = code.match_indices("pub fn ").map(|(at, start)| at + start.len());
    let flag = |at: usize| {
        let signature = &code[at..];
        let open = signature.find('(')?;
        let close = matching(&signature[open..])? + open;
        let takes_flag = signature[open..close].contains(": bool");
        let name = signature[..open].split('<').next().unwrap_or_default();
        takes_flag.then(|| (code[..at].lines().count(), name))
    };
    starts.filter_map(flag).collect()
}

/// Where the bracket that a text begins with is closed.
fn matching(text: &str) -> Option<usize> {
    let mut depth = 0;
    text.char_indices().find_map(|(at, c)| {
        match c {
            '(' => depth += 1,
            ')' => depth -= 1,
            _ => {}
        }
        (depth == 0).then_some(at)
    })
}

fn rust_files(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    let entries =
        std::fs::read_dir(folder).with_context(|| format!("cannot list {}", folder.display()))?;
    for entry in entries {
        let path = entry.with_context(|| format!("cannot list {}", folder.display()))?.path();
        if path.is_dir() {
            files.extend(rust_files(&path)?);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

fn read(path: &Path) -> Result<String> {
    std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn public_functions_with_a_bool_are_found_over_several_lines() {
        let code = "fn a(x: bool) {}\npub fn b(\n    x: u8,\n    is_y: bool,\n) {}\npub fn c(f: impl Fn(u8) -> bool) {}\n";
        assert_eq!(flags(code), [(2, "b")]);
    }
}
