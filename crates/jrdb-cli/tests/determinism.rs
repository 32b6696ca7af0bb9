//! Same input, same bytes: twice, and with one and two threads.
#![allow(clippy::panic, clippy::unwrap_used, reason = "a failing helper should panic")]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use jrdb_cli::report::Telling;
use jrdb_cli::source::Source;
use jrdb_cli::{RunOptions, report, run};

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
    let result = run(&options, &|| ()).unwrap();
    let mut found = BTreeMap::new();
    files(folder.path(), folder.path(), &mut found);
    (found, report::text(&result, &Telling::default()) + &report::json(&result, &options.config))
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
