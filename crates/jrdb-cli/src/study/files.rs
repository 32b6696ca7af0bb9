//! What a study leaves in its folder.
//!
//! `methods/NAME/scores.json` and, for each recording, `methods/NAME/recordings/RECORDING.json`;
//! `table-N.txt`, `.md`, `.tex`, `.csv` and `study.json`; `timings.json`, which alone differs from run
//! to run.

use std::path::{Path, PathBuf};
use std::time::Duration;

use jrdb_study::{Mark, Plan, Table};
use jrdb_types::{Artefact, Scores};
use serde_json::{Value, json};

use super::result::{StudyResult, budget_text};
use crate::Error;
use crate::output::write;

/// Key of the digest of all that determines a recording's scores.
const RUN_DIGEST: &str = "run_sha256";

fn method_folder(out: &Path, method: &str) -> PathBuf {
    out.join("methods").join(method)
}

/// File of the scores of one recording.
pub(super) fn recording(out: &Path, method: &str, recording: &str) -> PathBuf {
    method_folder(out, method).join("recordings").join(format!("{recording}.json"))
}

/// The scores in a file, where they are those of a run with this digest.
pub(super) fn known_scores(path: &Path, digest: &str) -> Option<Scores> {
    let text = std::fs::read_to_string(path).ok()?;
    let artefact: Artefact<Scores> = Artefact::from_json(&text).ok()?;
    (artefact.config[RUN_DIGEST] == digest).then_some(artefact.data)
}

/// Writes the scores of a recording with the digest of its run.
pub(super) fn write_known(path: &Path, digest: &str, scores: &Scores) -> Result<(), Error> {
    let config = json!({ RUN_DIGEST: digest });
    write(path, Artefact::new(config, scores.clone()).to_json().as_bytes())
}

/// Writes the scores of a method on all recordings.
pub(super) fn write_scores(out: &Path, method: &str, scores: &Scores) -> Result<(), Error> {
    let path = method_folder(out, method).join("scores.json");
    write(&path, Artefact::new(json!({}), scores.clone()).to_json().as_bytes())
}

/// Notes how long a method took. Recordings that were there before take no time.
pub(super) fn write_timing(out: &Path, method: &str, took: Duration) -> Result<(), Error> {
    let path = out.join("timings.json");
    let there = std::fs::read_to_string(&path).unwrap_or_default();
    let mut timings: Value = serde_json::from_str(&there).unwrap_or_else(|_| json!({}));
    timings[method] = json!({ "seconds": took.as_secs_f64() });
    write_json(&path, &timings)
}

/// Writes the tables and the error budget.
pub(super) fn write_study(out: &Path, plan: &Plan, result: &StudyResult) -> Result<(), Error> {
    for (number, table) in (1..).zip(&result.tables) {
        let file = |extension: &str| out.join(format!("table-{number}.{extension}"));
        write(&file("txt"), jrdb_study::text(table).as_bytes())?;
        write(&file("md"), jrdb_study::markdown(table).as_bytes())?;
        write(&file("tex"), jrdb_study::latex(table).as_bytes())?;
        write(&file("csv"), jrdb_study::csv(table).as_bytes())?;
    }
    if !result.budget.is_empty() {
        write(&out.join("error-budget.txt"), budget_text(&result.budget).as_bytes())?;
    }
    let budget =
        result.budget.iter().map(|(metric, budget)| (metric.name().to_owned(), json!(budget)));
    let document = json!({
        "schema": "jrdb.study",
        "schema_version": 1,
        "producer": { "name": "jrdb", "version": env!("CARGO_PKG_VERSION") },
        "title": plan.title,
        "intervals": plan.intervals,
        "tables": result.tables.iter().map(with_marks).collect::<Vec<_>>(),
        "error_budget": budget.collect::<serde_json::Map<_, _>>(),
        "failures": result.failures,
    });
    write_json(&out.join("study.json"), &document)
}

/// A table with what each of its cells is among the others.
fn with_marks(table: &Table) -> Value {
    let columns = 0..table.columns().count();
    let marks = table
        .rows
        .iter()
        .map(|row| columns.clone().map(|column| table.mark(row, column)).collect::<Vec<Mark>>());
    let marks: Vec<_> = marks.collect();
    json!({ "table": table, "marks": marks })
}

fn write_json(path: &Path, value: &Value) -> Result<(), Error> {
    let text = serde_json::to_string_pretty(value).unwrap_or_default();
    write(path, format!("{text}\n").as_bytes())
}
