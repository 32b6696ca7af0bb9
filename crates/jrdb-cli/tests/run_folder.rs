//! The folder of `--out`: one run's, whole, and completed after an interruption.
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]

mod tree;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

/// A dataset and a folder for results.
struct Place {
    folder: TempDir,
}

impl Place {
    fn new() -> Self {
        let folder = TempDir::new().unwrap();
        tree::write(&folder.path().join("scene"));
        Self { folder }
    }

    fn out(&self) -> PathBuf {
        self.folder.path().join("out")
    }

    fn command(&self, more: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_jrdb"));
        command.args(["run", "--scene"]).arg(self.folder.path().join("scene"));
        command.arg("--out").arg(self.out()).args(more);
        command
    }

    fn run(&self, more: &[&str]) -> Output {
        self.command(more).output().unwrap()
    }
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// All files with their bytes.
fn contents(root: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let files = tree::files(root, "").into_iter();
    files
        .map(|path| (path.strip_prefix(root).unwrap().into(), std::fs::read(path).unwrap()))
        .collect()
}

const NEAR: [&str; 2] = ["--query", "Who is near me?"];
const LEFT: [&str; 2] = ["--query", "Who is to my left?"];

#[test]
fn the_same_command_writes_the_same_bytes_again() {
    let place = Place::new();
    let first = place.run(&[&NEAR[..], &["--artifacts"]].concat());
    assert!(first.status.success(), "{}", text(&first.stderr));
    let written = contents(&place.out());
    let run: serde_json::Value = serde_json::from_slice(&written[Path::new("run.json")]).unwrap();
    assert_eq!(run["complete"], true);
    assert_eq!(run["run"]["frames"], serde_json::json!(["two-people/000000", "two-people/000001"]));
    let again = place.run(&[&NEAR[..], &["--artifacts", "--threads", "1"]].concat());
    assert!(again.status.success() && text(&again.stderr).contains("holds this run, complete"));
    assert_eq!(contents(&place.out()), written);
    assert_eq!(again.stdout, first.stdout);
}

#[test]
fn a_questions_files_are_where_they_are_whatever_else_is_asked() {
    let (alone, both) = (Place::new(), Place::new());
    assert!(alone.run(&NEAR).status.success());
    assert!(both.run(&[LEFT, NEAR].concat()).status.success());
    for path in tree::files(&alone.out(), "answer.json") {
        let inside = path.strip_prefix(alone.out()).unwrap();
        assert_eq!(std::fs::read(both.out().join(inside)).unwrap(), std::fs::read(path).unwrap());
    }
}

#[test]
fn another_run_is_refused_unless_it_may_be_overwritten() {
    let place = Place::new();
    assert!(place.run(&[NEAR, LEFT].concat()).status.success());
    let refused = place.run(&NEAR);
    assert_eq!(refused.status.code(), Some(2));
    let said = text(&refused.stderr);
    assert!(said.contains("another run: run.questions") && said.contains("--overwrite"), "{said}");
    assert!(place.run(&[&NEAR[..], &["--overwrite"]].concat()).status.success());
    assert_eq!(tree::files(&place.out(), "answer.json").len(), 2);
}

#[test]
fn a_changed_input_is_another_run_or_another_frame() {
    let place = Place::new();
    assert!(place.run(&NEAR).status.success());
    let labels = place.folder.path().join("scene/labels/labels_3d/two-people.json");
    let changed = std::fs::read_to_string(&labels).unwrap() + " ";
    std::fs::write(&labels, changed).unwrap();
    let refused = place.run(&NEAR);
    assert!(text(&refused.stderr).contains("labels_3d"), "{}", text(&refused.stderr));
}

#[test]
fn a_second_run_at_the_same_time_is_refused() {
    let place = Place::new();
    assert!(place.run(&NEAR).status.success());
    let lock = std::fs::File::open(place.out().join(".lock")).unwrap();
    lock.lock().unwrap();
    let refused = place.run(&NEAR);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("another run is writing"));
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_prints_what_it_has_and_is_completed() {
    let folder = TempDir::new().unwrap();
    let scene = folder.path().join("scene");
    let synth = Command::new(env!("CARGO_BIN_EXE_jrdb"))
        .args(["synth", "--people", "3", "--frames", "8", "--out"])
        .arg(&scene)
        .output()
        .unwrap();
    assert!(synth.status.success(), "{}", text(&synth.stderr));
    let command = |out: &str, more: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_jrdb"));
        command.args(["run", "--scene"]).arg(&scene).arg("--out").arg(folder.path().join(out));
        command.args(NEAR).args(["--artifacts", "--threads", "1", "--format", "json"]).args(more);
        command
    };
    let whole = command("whole", &[]).output().unwrap();
    assert!(whole.status.success(), "{}", text(&whole.stderr));
    let child = command("cut", &[])
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let cut = folder.path().join("cut");
    while !cut.is_dir() || tree::files(&cut, "inputs.json").is_empty() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-TERM", &id]).status().unwrap().success());
    let ended = child.wait_with_output().unwrap();
    assert_eq!(ended.status.code(), Some(143), "{}", text(&ended.stderr));
    let printed: serde_json::Value = serde_json::from_slice(&ended.stdout).unwrap();
    let answers = printed["answers"].as_array().unwrap().len();
    assert!((1..8).contains(&answers), "{answers}");
    let resumed = command("cut", &["--resume"]).output().unwrap();
    assert!(resumed.status.success(), "{}", text(&resumed.stderr));
    assert_eq!(resumed.stdout, whole.stdout);
    assert_eq!(contents(&cut), contents(&folder.path().join("whole")));
}
