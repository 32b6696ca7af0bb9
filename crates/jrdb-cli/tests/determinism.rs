//! Same input, same bytes: twice, and with one and two threads.
#![allow(clippy::panic, clippy::unwrap_used, reason = "a failing helper should panic")]

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use jrdb_cli::report::Telling;
use jrdb_cli::report::{JsonForm, JsonReport};
use jrdb_cli::source::Source;
use jrdb_cli::{Run, RunOptions, report};

fn scenes() -> Vec<Source> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata/scenes");
    let mut paths: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    paths.sort();
    paths.into_iter().map(Source::Scene).collect()
}

/// Every file below a folder, by its path in it.
fn files(folder: &Path, root: &Path, found: &mut BTreeMap<PathBuf, Vec<u8>>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files(&path, root, found);
        } else {
            found.insert(path.strip_prefix(root).unwrap().into(), std::fs::read(&path).unwrap());
        }
    }
}

/// Everything a run leaves, and what it prints.
fn outcome(threads: usize) -> (BTreeMap<PathBuf, Vec<u8>>, String) {
    let folder = tempfile::TempDir::new().unwrap();
    let options = RunOptions {
        sources: scenes(),
        threads: Some(threads),
        out: Some(folder.path().into()),
        artifacts: true,
        ..RunOptions::default()
    };
    let run = Run::open(&options).unwrap();
    let (mut text, mut json) = (run.notes().concat(), JsonReport::new(JsonForm::Document));
    let telling = Telling::default();
    let summary = run.execute(|result| {
        text += &report::frame(&result, &telling);
        for answered in &result.output.as_ref().unwrap().answered {
            text += &json.answer(&answered.answer, &options.config);
        }
        ControlFlow::Continue(())
    });
    let summary = summary.unwrap();
    text += &report::summary(&summary, &telling);
    text += &json.end(&summary, &options.config);
    let mut found = BTreeMap::new();
    files(folder.path(), folder.path(), &mut found);
    (found, text)
}

#[test]
fn runs_are_byte_identical_at_any_number_of_threads() {
    let (first, text) = outcome(1);
    assert!(first.keys().any(|path| path.ends_with("panorama.png")));
    for threads in [1, 2] {
        let (again, text_again) = outcome(threads);
        assert_eq!(text, text_again);
        assert!(first.keys().eq(again.keys()));
        for (path, bytes) in &first {
            assert!(*bytes == again[path], "{} differs with {threads} threads", path.display());
        }
    }
}
