//! What a study leaves in its folder.
//!
//! `methods/NAME/scores.json` and, for each recording, `methods/NAME/recordings/RECORDING.json`;
//! there, too, `slices` and `places` as tables, `sides.txt`, `reliability.txt` and `.svg`;
//! `table-N.txt`, `.md`, `.tex`, `.csv`, the same of `parameters`, `error-budget.txt` and `.svg`, and
//! `study.json`; `timings.json`, which alone differs from run to run.

use jrdb_study::{Mark, Placements, Plan, Table};
use jrdb_types::score::{Budget, Metric};
use jrdb_types::{Artefact, Scores};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

use super::result::{StudyResult, Timing, budget_text};
use crate::Error;
use crate::output::write;

/// Key of the digest of all that determines a recording's scores.
const RUN_DIGEST: &str = "run_sha256";
/// Key of how people were placed.
const PLACEMENTS: &str = "placements";

fn method_folder(out: &Path, method: &str) -> PathBuf {
    out.join("methods").join(method)
}

/// File of the scores of one recording.
pub(super) fn recording(out: &Path, method: &str, recording: &str) -> PathBuf {
    method_folder(out, method).join("recordings").join(format!("{recording}.json"))
}

/// The scores in a file and how people were placed, where they are those of a run with this digest.
pub(super) fn known(path: &Path, digest: &str) -> Option<(Scores, Placements)> {
    let text = std::fs::read_to_string(path).ok()?;
    let artefact: Artefact<Scores> = Artefact::from_json(&text).ok()?;
    let placements = serde_json::from_value(artefact.config[PLACEMENTS].clone()).ok()?;
    (artefact.config[RUN_DIGEST] == digest).then_some((artefact.data, placements))
}

/// Writes the scores of a recording and how people were placed, with the digest of its run.
pub(super) fn write_known(
    path: &Path,
    digest: &str,
    scores: &Scores,
    placements: &Placements,
) -> Result<(), Error> {
    let config = json!({ RUN_DIGEST: digest, PLACEMENTS: placements });
    write(path, Artefact::new(config, scores.clone()).to_json().as_bytes())
}

/// Writes the scores of a method on all recordings.
pub(super) fn write_scores(out: &Path, method: &str, scores: &Scores) -> Result<(), Error> {
    let path = method_folder(out, method).join("scores.json");
    write(&path, Artefact::new(json!({}), scores.clone()).to_json().as_bytes())
}

/// Writes what a method came to on parts of the questions, and whether its probabilities are what
/// they say.
pub(super) fn write_slices(
    out: &Path,
    method: &str,
    slices: &Table,
    scores: &Scores,
) -> Result<(), Error> {
    let folder = method_folder(out, method);
    write_table(&folder, "slices", slices)?;
    let reliability = jrdb_metrics::reliability(&scores.questions);
    write(&folder.join("reliability.txt"), jrdb_render::reliability(&reliability).as_bytes())?;
    let chart = jrdb_render::reliability_chart(&reliability);
    write(&folder.join("reliability.svg"), chart.as_bytes())
}

/// Writes how far from the truth people were placed and turned, and which sides were taken for which.
pub(super) fn write_places(out: &Path, method: &str, placements: &Placements) -> Result<(), Error> {
    let folder = method_folder(out, method);
    write_table(&folder, "places", &placements.table(method))?;
    let of_robot = jrdb_metrics::confusion(placements.sides_of_robot());
    let of_people = jrdb_metrics::confusion(placements.sides_of_people());
    let [of_robot, of_people] = [&of_robot, &of_people].map(jrdb_render::confusion);
    let text = format!("sides of the robot\n{of_robot}\nsides of people\n{of_people}");
    write(&folder.join("sides.txt"), text.as_bytes())
}

/// Notes how long a method took for so many frames and questions, and the peak memory of the
/// process so far. Recordings that were there before are not noted.
pub(super) fn write_timing(out: &Path, method: &str, timing: &Timing) -> Result<(), Error> {
    if timing.frames == 0 {
        return Ok(());
    }
    let path = out.join("timings.json");
    let there = std::fs::read_to_string(&path).unwrap_or_default();
    let mut timings: Value = serde_json::from_str(&there).unwrap_or_else(|_| json!({}));
    let ms = timing.took.as_secs_f64() * 1e3;
    timings[method] = json!({
        "seconds": timing.took.as_secs_f64(),
        "frames": timing.frames,
        "questions": timing.questions,
        "ms_per_frame": ms / timing.frames as f64,
        "ms_per_question": ms / timing.questions.max(1) as f64,
        "peak_memory_bytes": jrdb_models::profile::peak_memory(),
    });
    write_json(&path, &timings)
}

/// Writes the tables and the error budget.
pub(super) fn write_study(out: &Path, plan: &Plan, result: &StudyResult) -> Result<(), Error> {
    for (number, table) in (1..).zip(&result.tables) {
        write_table(out, &format!("table-{number}"), table)?;
    }
    write_table(out, "parameters", &result.parameters)?;
    if !result.budget.is_empty() {
        write(&out.join("error-budget.txt"), budget_text(&result.budget).as_bytes())?;
        let named =
            |(metric, budget): &(Metric, Budget)| (metric.name().to_owned(), budget.clone());
        let named: Vec<_> = result.budget.iter().map(named).collect();
        write(&out.join("error-budget.svg"), jrdb_render::budget_chart(&named).as_bytes())?;
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
        "parameters": with_marks(&result.parameters),
        "error_budget": budget.collect::<serde_json::Map<_, _>>(),
        "failures": result.failures,
    });
    write_json(&out.join("study.json"), &document)
}

fn write_table(out: &Path, name: &str, table: &Table) -> Result<(), Error> {
    let file = |extension: &str| out.join(format!("{name}.{extension}"));
    write(&file("txt"), jrdb_study::text(table).as_bytes())?;
    write(&file("md"), jrdb_study::markdown(table).as_bytes())?;
    write(&file("tex"), jrdb_study::latex(table).as_bytes())?;
    write(&file("csv"), jrdb_study::csv(table).as_bytes())
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
