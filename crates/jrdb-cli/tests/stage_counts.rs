//! How often a run does what it should do once per frame, per question or per robot.
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use jrdb_cli::source::Source;
use jrdb_cli::{Run, RunOptions};
use jrdb_pipeline::{PipelineConfig, read_query};
use jrdb_types::Query;
use tracing::span::{Attributes, Id, Record};
use tracing::{Event, Metadata, Subscriber};

/// What the stages trace, by target.
static COUNTS: Mutex<BTreeMap<&'static str, usize>> = Mutex::new(BTreeMap::new());

/// Counts events of the stages, from whichever thread.
struct Counter;

impl Subscriber for Counter {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        metadata.target().starts_with("jrdb::")
    }

    fn event(&self, event: &Event<'_>) {
        *COUNTS.lock().unwrap().entry(event.metadata().target()).or_default() += 1;
    }

    fn new_span(&self, _: &Attributes<'_>) -> Id {
        Id::from_u64(1)
    }

    fn record(&self, _: &Id, _: &Record<'_>) {}
    fn record_follows_from(&self, _: &Id, _: &Id) {}
    fn enter(&self, _: &Id) {}
    fn exit(&self, _: &Id) {}
}

fn scene(name: &str) -> Source {
    Source::Scene(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata/scenes").join(name))
}

fn queries(texts: &[&str]) -> Vec<Arc<Query>> {
    let config = PipelineConfig::default();
    texts.iter().map(|text| Arc::new(read_query(text, &config.parser).unwrap())).collect()
}

/// What a run counts, its questions' reading included.
fn counted(options: impl FnOnce() -> RunOptions) -> BTreeMap<&'static str, usize> {
    COUNTS.lock().unwrap().clear();
    let options = options();
    let summary = Run::open(&options).unwrap().execute(|_| ControlFlow::Continue(())).unwrap();
    assert!(summary.failures.is_empty());
    COUNTS.lock().unwrap().clone()
}

fn expected<const N: usize>(counts: [(&'static str, usize); N]) -> BTreeMap<&'static str, usize> {
    counts.into_iter().filter(|(_, count)| *count > 0).collect()
}

// One test: the counter is the process's.
#[test]
fn everything_is_done_once() {
    tracing::subscriber::set_global_default(Counter).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let out: PathBuf = folder.path().into();
    let three = ["Find all persons", "Who is close to me?", "How many women are there?"];
    let plaza = counted(|| RunOptions {
        sources: vec![scene("plaza")],
        queries: queries(&three),
        out: Some(out),
        ..RunOptions::default()
    });
    let once = expected([
        ("jrdb::parse", 3),
        ("jrdb::resolve_rig", 1),
        ("jrdb::merge", 1),
        ("jrdb::place", 1),
        ("jrdb::index", 1),
        ("jrdb::decode_image", 1),
    ]);
    assert_eq!(plaza, once, "one frame, three questions, pictures");
    let corridor = counted(|| RunOptions {
        sources: vec![scene("corridor")],
        queries: queries(&["Who is walking?"]),
        robot_stands: true,
        ..RunOptions::default()
    });
    let twice = expected([
        ("jrdb::parse", 1),
        ("jrdb::resolve_rig", 1),
        ("jrdb::merge", 2),
        ("jrdb::place", 2),
        ("jrdb::index", 2),
        ("jrdb::decode_image", 0),
    ]);
    assert_eq!(corridor, twice, "two frames, one question, a robot that stands");
}
