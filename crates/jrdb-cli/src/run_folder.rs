//! The folder of a run: whose it is, whether it is complete, and that no other run writes into it.

use std::fs::{File, TryLockError};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use crate::Error;
use crate::output::write;

/// File at the top of the folder that says what determines the other files.
pub const RUN_FILE: &str = "run.json";
/// File that the process holds a lock on while it writes into the folder.
const LOCK_FILE: &str = ".lock";

/// Files of a run, below its folder.
const FRAME_FILES: [&str; 9] = [
    "answer.json",
    "panorama.png",
    "top_view.png",
    "query.json",
    "detections.json",
    "entities.json",
    "scene_graph.json",
    "inputs.json",
    "scores.json",
];
/// A folder with one of these holds results, and not, for example, a dataset.
const RESULT_FILES: [&str; 3] = ["answer.json", "panorama.png", "inputs.json"];
/// How deep they lie: sequence, frame, question.
const DEPTH: usize = 3;
/// How deep the folders of frames lie.
const FRAME_DEPTH: usize = 2;
/// Digits of their names.
const FRAME_DIGITS: usize = 6;

/// What is done when the folder holds another run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Existing {
    /// It is refused.
    #[default]
    Refuse,
    /// The files of the other run are removed.
    Overwrite,
}

/// What the folder held before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Found {
    /// Nothing of a run.
    Nothing,
    /// This run, interrupted.
    Incomplete,
    /// This run, complete.
    Complete,
}

/// A folder that this run may write into, and no other does.
#[derive(Debug)]
pub struct RunFolder {
    root: PathBuf,
    run: Value,
    found: Found,
    /// Released when the process ends, however it ends.
    _lock: File,
}

impl RunFolder {
    /// Takes a folder for a run; `run` holds all that determines the bytes of its files.
    ///
    /// # Errors
    /// When the folder cannot be written into, another process writes into it, or it holds another run that is not to be
    /// overwritten.
    pub fn open(root: &Path, run: Value, existing: Existing) -> Result<Self, Error> {
        let lock = lock(root)?;
        let mut found = found(root, &run)?;
        if existing == Existing::Overwrite {
            remove_results(root)?;
            found = Ok(Found::Nothing);
        }
        let found = found.map_err(Error::Usage)?;
        remove_parts(root, 0)?;
        let folder = Self { root: root.into(), run, found, _lock: lock };
        if found != Found::Complete {
            folder.write(Completion::Partial)?;
        }
        Ok(folder)
    }

    /// What the folder held before.
    #[must_use]
    pub fn found(&self) -> Found {
        self.found
    }

    /// Notes that all files are there.
    ///
    /// # Errors
    /// When that cannot be written.
    pub fn complete(&self) -> Result<(), Error> {
        self.write(Completion::Complete)
    }

    fn write(&self, completion: Completion) -> Result<(), Error> {
        let document = document(&self.run, completion);
        let text = serde_json::to_string_pretty(&document).unwrap_or_default();
        write(&self.root.join(RUN_FILE), format!("{text}\n").as_bytes())
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Completion {
    Partial,
    Complete,
}

fn document(run: &Value, completion: Completion) -> Value {
    json!({
        "schema": "jrdb.run",
        "schema_version": 1,
        "producer": { "name": "jrdb", "version": env!("CARGO_PKG_VERSION") },
        "complete": completion == Completion::Complete,
        "run": run,
    })
}

/// Makes the folder and locks it. That the folder can be written into is known then.
pub(crate) fn lock(root: &Path) -> Result<File, Error> {
    let fail = |source| Error::file("write", root, source);
    std::fs::create_dir_all(root).map_err(fail)?;
    let path = root.join(LOCK_FILE);
    let file = File::options().create(true).truncate(false).write(true).open(&path);
    let file = file.map_err(|source| Error::file("write", &path, source))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(Error::Usage(format!(
            "expected a folder for this run alone, found that another run is writing into {root:?}: \
             wait for its end, or name another --out"
        ))),
        Err(TryLockError::Error(source)) => Err(Error::file("write", &path, source)),
    }
}

/// What the folder holds; the inner error says that it is something else.
fn found(root: &Path, run: &Value) -> Result<Result<Found, String>, Error> {
    let refused = |what: &str| {
        format!(
            "expected an empty folder or this run in {root:?}, found {what}: name another --out, or \
             add --overwrite, which removes that run's files"
        )
    };
    let path = root.join(RUN_FILE);
    let text = match std::fs::read_to_string(&path) {
        Ok(text) => text,
        Err(error) if error.kind() == ErrorKind::NotFound => {
            let is_earlier = !result_folders(root, 0)?.is_empty();
            let what = format!("results of an earlier run without {RUN_FILE}");
            return Ok(if is_earlier { Err(refused(&what)) } else { Ok(Found::Nothing) });
        }
        Err(error) => return Err(Error::file("read", &path, error)),
    };
    let there: Value = serde_json::from_str(&text).unwrap_or_default();
    if there == document(run, Completion::Complete) {
        return Ok(Ok(Found::Complete));
    }
    if there == document(run, Completion::Partial) {
        return Ok(Ok(Found::Incomplete));
    }
    let differing = differing(&there, run);
    Ok(Err(refused(&format!("another run: {differing} of its {RUN_FILE} differs"))))
}

/// The first place where two runs differ.
fn differing(there: &Value, run: &Value) -> String {
    let ours = document(run, Completion::Partial);
    for key in ["schema", "schema_version", "producer"] {
        if there.get(key) != ours.get(key) {
            return key.into();
        }
    }
    let (mut place, mut one, mut two) = (String::from("run"), &there["run"], run);
    loop {
        let (Value::Object(map), Value::Object(other)) = (one, two) else { return place };
        let mut keys = map.keys().chain(other.keys());
        let Some(key) = keys.find(|key| map.get(*key) != other.get(*key)) else { return place };
        place = format!("{place}.{key}");
        let (Some(next), Some(other)) = (map.get(key), other.get(key)) else { return place };
        (one, two) = (next, other);
    }
}

/// Folders below, links not followed.
fn folders(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    let fail = |source| Error::file("read", folder, source);
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(fail)? {
        let entry = entry.map_err(fail)?;
        if entry.file_type().map_err(fail)?.is_dir() {
            found.push(entry.path());
        }
    }
    found.sort();
    Ok(found)
}

/// Whether a folder is named like a frame's.
fn is_frame(folder: &Path) -> bool {
    let name = folder.file_name().unwrap_or_default().as_encoded_bytes();
    name.len() >= FRAME_DIGITS && name.iter().all(u8::is_ascii_digit)
}

/// The folder and those below that hold results, the deepest first.
fn result_folders(folder: &Path, depth: usize) -> Result<Vec<PathBuf>, Error> {
    let mut all = Vec::new();
    if depth < DEPTH {
        for below in folders(folder)? {
            all.extend(result_folders(&below, depth + 1)?);
        }
    }
    let has = |names: &[&str]| names.iter().any(|name| folder.join(name).is_file());
    // A frame that was not completed may have artefacts only; a folder above results is empty without them.
    let is_begun = depth == FRAME_DEPTH && is_frame(folder) && has(&FRAME_FILES);
    if has(&RESULT_FILES) || is_begun || (depth > 0 && !all.is_empty()) {
        all.push(folder.into());
    }
    Ok(all)
}

/// Removes the files of a run that are known by name, and folders that are empty then. Others stay.
fn remove_results(root: &Path) -> Result<(), Error> {
    let holding = result_folders(root, 0)?;
    let is_run = !holding.is_empty() || root.join(RUN_FILE).is_file();
    for folder in holding {
        for name in FRAME_FILES {
            remove(&folder.join(name))?;
        }
        if folder != root {
            // Not empty where it holds files of others.
            let _ = std::fs::remove_dir(&folder);
        }
    }
    if is_run {
        remove(&root.join("scores.json"))?;
        remove(&root.join(RUN_FILE))?;
    }
    Ok(())
}

/// Removes files that a process left half-written when it was killed.
fn remove_parts(folder: &Path, depth: usize) -> Result<(), Error> {
    let fail = |source| Error::file("read", folder, source);
    for entry in std::fs::read_dir(folder).map_err(fail)? {
        let path = entry.map_err(fail)?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let known = || FRAME_FILES.iter().chain([&RUN_FILE]);
        let is_of = |file: &&str| name.strip_prefix('.').is_some_and(|n| n.starts_with(*file));
        if name.ends_with(jrdb_dataset::PART) && known().any(is_of) {
            remove(&path)?;
        }
    }
    if depth < DEPTH {
        for below in folders(folder)? {
            remove_parts(&below, depth + 1)?;
        }
    }
    Ok(())
}

fn remove(path: &Path) -> Result<(), Error> {
    match std::fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(Error::file("write", path, error)),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(question: &str) -> Value {
        json!({ "questions": [question], "config": { "near_m": 2.0 } })
    }

    fn open(root: &Path, question: &str, existing: Existing) -> Result<RunFolder, String> {
        RunFolder::open(root, run(question), existing).map_err(|error| error.to_string())
    }

    #[test]
    fn a_run_continues_in_its_own_folder_and_completes_it() {
        let root = tempfile::tempdir().unwrap();
        let folder = open(root.path(), "who?", Existing::Refuse).unwrap();
        assert_eq!(folder.found(), Found::Nothing);
        drop(folder);
        let again = open(root.path(), "who?", Existing::Refuse).unwrap();
        assert_eq!(again.found(), Found::Incomplete);
        again.complete().unwrap();
        drop(again);
        assert_eq!(open(root.path(), "who?", Existing::Refuse).unwrap().found(), Found::Complete);
    }

    #[test]
    fn another_run_is_refused_by_what_differs_and_overwritten_when_asked_for() {
        let root = tempfile::tempdir().unwrap();
        let stale = root.path().join("plaza_0/000000/q1/answer.json");
        let own = root.path().join("plaza_0/notes.txt");
        write(&stale, b"{}").unwrap();
        write(&own, b"mine").unwrap();
        drop(open(root.path(), "who?", Existing::Overwrite).unwrap());
        write(&stale, b"{}").unwrap();
        let begun = root.path().join("plaza_0/000005/detections.json");
        write(&begun, b"{}").unwrap();
        let error = open(root.path(), "where?", Existing::Refuse).unwrap_err();
        assert!(error.contains("another run: run.questions"), "{error}");
        assert!(error.contains("--overwrite") && stale.exists());
        drop(open(root.path(), "where?", Existing::Overwrite).unwrap());
        assert!(!begun.exists());
        assert!(!stale.exists() && !stale.parent().unwrap().exists() && own.exists());
    }

    #[test]
    fn results_without_a_run_file_are_another_run_and_a_dataset_is_not() {
        let root = tempfile::tempdir().unwrap();
        write(&root.path().join("detections.json"), b"[]").unwrap();
        drop(open(root.path(), "who?", Existing::Overwrite).unwrap());
        assert!(root.path().join("detections.json").exists());
        let other = tempfile::tempdir().unwrap();
        write(&other.path().join("answer.json"), b"{}").unwrap();
        let error = open(other.path(), "who?", Existing::Refuse).unwrap_err();
        assert!(error.contains("results of an earlier run"), "{error}");
    }

    #[test]
    fn a_second_run_at_the_same_time_is_refused() {
        let root = tempfile::tempdir().unwrap();
        let first = open(root.path(), "who?", Existing::Refuse).unwrap();
        let error = open(root.path(), "who?", Existing::Overwrite).unwrap_err();
        assert!(error.contains("another run is writing"), "{error}");
        drop(first);
        assert!(open(root.path(), "who?", Existing::Refuse).is_ok());
    }

    #[test]
    fn half_written_files_of_a_killed_run_are_removed() {
        let root = tempfile::tempdir().unwrap();
        let part = root.path().join("plaza_0/000000/.panorama.png.77.1.part");
        let other = root.path().join("plaza_0/000000/.mine.part");
        write(&part, b"\x89PNG").unwrap();
        write(&other, b"x").unwrap();
        drop(open(root.path(), "who?", Existing::Refuse).unwrap());
        assert!(!part.exists() && other.exists());
    }
}
