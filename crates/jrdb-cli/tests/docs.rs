//! Every command and every question of the documents, run: what a reader types works.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a failing helper should panic")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use jrdb_parser::{notation, parse};

/// The dataset and the sequence that documents speak of, and what stands for them here.
const DATASETS: [&str; 2] = ["/data/jrdb/train", "ROOT"];
const SEQUENCE: &str = "bytes-cafe-2019-02-07_0";

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The research data, which is not in the repository.
fn sample() -> Option<PathBuf> {
    let beside = || root().join("../shared");
    let shared = std::env::var_os("JRDB_SHARED").map_or_else(beside, PathBuf::from);
    Some(shared.join("data/jrdb-sample")).filter(|folder| folder.is_dir())
}

/// The documents: name and text.
fn documents() -> Vec<(String, String)> {
    let mut paths = vec![root().join("README.md"), root().join("CONTRIBUTING.md")];
    for folder in ["docs", "crates"] {
        for entry in std::fs::read_dir(root().join(folder)).unwrap() {
            let path = entry.unwrap().path();
            paths.push(if path.is_dir() { path.join("README.md") } else { path });
        }
    }
    paths.retain(|path| path.extension().is_some_and(|end| end == "md") && path.exists());
    paths.sort();
    let read = |path: PathBuf| {
        let name = path.strip_prefix(root()).unwrap().display().to_string();
        (name, std::fs::read_to_string(path).unwrap())
    };
    paths.into_iter().map(read).collect()
}

/// A command of a code block, and the output that is shown behind it.
#[derive(Debug)]
struct Shown {
    document: String,
    command: String,
    output: Vec<String>,
}

/// The commands of all code blocks that begin with a word.
fn commands(program: &str) -> Vec<Shown> {
    let mut found: Vec<Shown> = Vec::new();
    for (document, text) in documents() {
        for block in text.split("```").skip(1).step_by(2) {
            let (mut is_continued, mut shows_output) = (false, false);
            for line in block.lines().skip(1) {
                let bare = line.strip_prefix("$ ").unwrap_or(line);
                if is_continued {
                    let last = found.last_mut().unwrap();
                    last.command = format!("{} {}", last.command, line.trim());
                } else if bare.starts_with(&format!("{program} ")) {
                    let command = bare.trim_end_matches('\\').trim().to_string();
                    found.push(Shown { document: document.clone(), command, output: Vec::new() });
                    shows_output = line.starts_with("$ ");
                } else if shows_output {
                    found.last_mut().unwrap().output.push(line.into());
                    continue;
                } else {
                    continue;
                }
                is_continued = line.ends_with('\\');
            }
        }
    }
    found
}

/// A command's words as a shell has them; comments and optional parts are left out.
fn words(command: &str) -> Vec<String> {
    let command = command.split(" # ").next().unwrap();
    let command = command.split(" [").next().unwrap();
    let (mut words, mut is_quoted) = (vec![String::new()], false);
    for c in command.chars() {
        match c {
            '"' => is_quoted = !is_quoted,
            ' ' if !is_quoted => words.push(String::new()),
            c => words.last_mut().unwrap().push(c),
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Runs `jrdb` where the documents assume that the reader stands.
fn jrdb(arguments: &[String]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_jrdb"));
    command.args(arguments).current_dir(root()).output().unwrap()
}

/// A command's words with our data for the reader's, and where it writes. `None` when that data is not here.
fn arguments(command: &str, out: &Path) -> Option<Vec<String>> {
    let mut words = words(command);
    words.remove(0);
    for at in 0..words.len() {
        if DATASETS.contains(&words[at].as_str()) {
            words[at] = sample()?.display().to_string();
        } else if words[at] == "NAME" {
            words[at] = SEQUENCE.into();
        } else if words[at] == "--out" {
            words[at + 1] = out.join("out").display().to_string();
        }
    }
    // Packages come from the network; without Python the command ends before it asks for any.
    if words.starts_with(&["models".into(), "fetch".into()]) {
        words.extend(["--python", "/no/such/python", "--dir"].map(String::from));
        words.push(out.join("models").display().to_string());
    }
    Some(words)
}

/// Whether a command needs what the repository does not have: weights, packages, labels, a reader's own files.
fn needs_more(words: &[String]) -> bool {
    let has = |word: &str| words.iter().any(|one| one.contains(word));
    // The sample has no label files in JRDB's form.
    let needs_labels = has("--dataset") && !has("--perception") && words[0] == "run";
    needs_labels
        || words[0] == "models"
        || ["…", "FILE", "florence2-internvl", "llmdet", "ssdlite", "questions.json"]
            .iter()
            .any(|word| has(word))
}

#[test]
fn every_command_of_the_documents_runs() {
    let shown = commands("jrdb");
    assert!(shown.len() >= 8, "the documents show commands: {shown:?}");
    for Shown { document, command, output } in shown {
        let folder = tempfile::tempdir().unwrap();
        let Some(words) = arguments(&command, folder.path()) else {
            println!("skipped: no shared data for {command:?} of {document}");
            continue;
        };
        let ran = jrdb(&words);
        let (out, err) = (text(&ran.stdout), text(&ran.stderr));
        assert!(!err.contains("Usage: jrdb"), "{document}: {command}\n{err}");
        if !needs_more(&words) {
            // The calibration check ends with 1 when it cannot tell.
            let is_told = words[0] == "calib" && out.contains("verdict: ");
            assert!(ran.status.success() || is_told, "{document}: {command}\n{err}");
        }
        for line in output.iter().map(|line| line.trim()).filter(|line| !line.is_empty()) {
            let is_there = line.split('…').all(|part| out.contains(part.trim()));
            assert!(is_there, "{document}: {command} no longer prints {line:?}:\n{out}");
        }
    }
}

#[test]
fn every_question_of_a_table_means_what_stands_beside_it() {
    let mut rows = 0;
    for (document, text) in documents() {
        let mut is_table = false;
        for line in text.lines() {
            let cells: Vec<&str> = line.trim_matches('|').split(" | ").map(str::trim).collect();
            is_table = line.starts_with('|') && (is_table || cells == ["question", "query"]);
            let [question, query] = cells[..] else { continue };
            if is_table && query.starts_with('`') {
                let read = notation::write(&parse(question));
                assert_eq!(read, query.trim_matches('`'), "{document}: {question}");
                rows += 1;
            }
        }
    }
    assert!(rows >= 5, "the README has questions with their queries");
}

#[test]
fn the_library_example_of_the_readme_is_one_that_compiles() {
    let readme = std::fs::read_to_string(root().join("README.md")).unwrap();
    let compiled = include_str!("../examples/embed.rs");
    let shown = readme.split("```rust").nth(1).unwrap().split("```").next().unwrap();
    let shown: Vec<&str> = shown.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    assert!(shown.len() >= 6, "{shown:?}");
    for line in shown {
        assert!(compiled.lines().any(|one| one.trim() == line), "{line}");
    }
}

/// The folder of a package.
fn folder_of(package: &str) -> PathBuf {
    let folder = if package == "jrdb" { "jrdb-cli" } else { package };
    root().join("crates").join(folder)
}

#[test]
fn every_cargo_command_names_what_there_is() {
    let usage = std::fs::read_to_string(root().join("xtask/src/program.rs")).unwrap();
    let shown = commands("cargo");
    assert!(shown.len() >= 10, "the documents show commands: {shown:?}");
    for Shown { document, command, .. } in shown {
        let words = words(&command);
        let after = |flag: &str| {
            let at = words.iter().position(|word| word == flag)?;
            words.get(at + 1).map(String::as_str)
        };
        let wrong = |what: &str| panic!("{document}: {command}: no {what}");
        if words[1] == "xtask" && !usage.contains(&format!("cargo xtask {}", words[2])) {
            wrong("such developer command");
        }
        if let Some(path) = after("--path")
            && !root().join(path).is_dir()
        {
            wrong("such folder");
        }
        let Some(package) = after("-p") else { continue };
        if !folder_of(package).join("Cargo.toml").exists() {
            wrong("such package");
        }
        for (flag, folder) in [("--test", "tests"), ("--example", "examples")] {
            if let Some(name) = after(flag)
                && !folder_of(package).join(folder).join(format!("{name}.rs")).exists()
            {
                wrong(&format!("{name} in {folder}"));
            }
        }
    }
}
