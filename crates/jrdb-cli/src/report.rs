//! Results for people and for programs.

use std::fmt::Write as _;

use jrdb_pipeline::PipelineConfig;
use jrdb_types::answer::{CandidateTrace, Change, Check, Effect, Reply, Told, Unit};
use jrdb_types::detection::PERSON;
use jrdb_types::{
    Answer, Artefact, EntityId, FrameId, Issue, Query, Scores, Span, Task, with_causes,
};
use serde_json::{Value, json};

use crate::questions::Answered;
use crate::result::{FrameOutput, FrameResult, RunSummary};

/// How many candidates of one answer are explained on the terminal.
const EXPLAINED_MAX: usize = 6;

/// How much of an answer is told.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Detail {
    /// Who was chosen, and why, in a line each.
    #[default]
    Brief,
    /// Every condition with its number and margin, and the nearest misses.
    Full,
}

/// What is told of answers.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Telling {
    /// How much of each.
    pub detail: Detail,
    /// Of which thing it is said why it is not in the answer.
    pub why_not: Option<EntityId>,
}

/// One frame as text: what was found, and per question the answer, the truth and why.
#[must_use]
pub fn frame(result: &FrameResult, telling: &Telling) -> String {
    let mut text = String::new();
    match &result.output {
        Ok(output) => frame_text(&mut text, output, telling),
        Err(error) => {
            line(&mut text, &format!("{}\n  failed: {}\n", result.id, with_causes(error)));
        }
    }
    text
}

/// What comes after the frames, as text: questions about time, and scores.
#[must_use]
pub fn summary(summary: &RunSummary, telling: &Telling) -> String {
    let mut text = String::new();
    for answered in &summary.recordings {
        line(&mut text, &format!("{}, all frames", answered.answer.frame.sequence));
        answered_text(&mut text, answered, telling);
        text.push('\n');
    }
    if summary.unasked > 0 {
        let unasked = summary.unasked;
        line(&mut text, &format!("{unasked} questions are about frames outside this run"));
    }
    if let Some(scores) = &summary.scores {
        text.push_str(&scores_text(scores));
    }
    text
}

/// One JSON document, `{"answers": [..], "failures": [..], "scores": ..}`, printed while the run goes on: answers and scores
/// are artefacts.
#[derive(Debug, Default)]
pub struct JsonReport {
    answers: usize,
}

impl JsonReport {
    /// What an answer adds to the document.
    #[must_use]
    pub fn answer(&mut self, answer: &Answer, config: &PipelineConfig) -> String {
        let artefact = Artefact::new(json!(config.search), answer.clone());
        let before = if self.answers == 0 { "{\n  \"answers\": [\n    " } else { ",\n    " };
        self.answers += 1;
        format!("{before}{}", pretty(&json!(artefact), "    "))
    }

    /// The rest of the document.
    #[must_use]
    pub fn end(self, summary: &RunSummary, config: &PipelineConfig) -> String {
        let failure =
            |(frame, error): &(FrameId, String)| json!({ "frame": frame, "error": error });
        let failures: Vec<Value> = summary.failures.iter().map(failure).collect();
        let scores = summary.scores.clone();
        let scores = scores.map(|scores| json!(Artefact::new(json!(config.metrics), scores)));
        let answers = if self.answers == 0 { "{\n  \"answers\": []" } else { "\n  ]" };
        let (failures, scores) = (pretty(&json!(failures), "  "), pretty(&json!(scores), "  "));
        format!("{answers},\n  \"failures\": {failures},\n  \"scores\": {scores}\n}}\n")
    }
}

/// A JSON value over several lines, the second and later ones indented.
fn pretty(value: &Value, indent: &str) -> String {
    let text = serde_json::to_string_pretty(value).unwrap_or_default();
    text.replace('\n', &format!("\n{indent}"))
}

fn line(text: &mut String, words: &str) {
    text.push_str(words);
    text.push('\n');
}

fn frame_text(text: &mut String, output: &FrameOutput, telling: &Telling) {
    let FrameOutput { scene, answered } = output;
    let nodes = &scene.graph().nodes;
    let people = nodes.iter().filter(|node| node.category == PERSON).count();
    let objects = nodes.len() - people;
    let placed = nodes.iter().filter(|node| node.center.is_some()).count();
    let frame = scene.id();
    line(
        text,
        &format!("{frame}: {people} people, {objects} objects, {placed} of them placed in 3D"),
    );
    for note in notes(scene.detections().issues.iter().chain(&scene.entities().issues)) {
        line(text, &format!("  {note}"));
    }
    for answered in answered {
        answered_text(text, answered, telling);
    }
    text.push('\n');
}

fn answered_text(text: &mut String, asked: &Answered, telling: &Telling) {
    line(text, &format!("\n  {}", asked.question.text));
    for issue in &asked.answer.issues {
        line(text, &indent(&query_issue_text(&asked.query.text, issue), "  "));
    }
    match telling.detail {
        Detail::Brief => brief(text, &asked.answer),
        Detail::Full => {
            line(text, &indent(&jrdb_search::explain(&asked.answer, EXPLAINED_MAX), "    "));
        }
    }
    if let Some(id) = &telling.why_not {
        line(text, &indent(&why_not_text(&asked.answer, id), "    "));
    }
    for change in &asked.answer.sensitivity {
        line(text, &format!("    {}", change_text(change)));
    }
    if let Some(score) = &asked.score {
        truth_text(text, asked, score);
    }
}

fn brief(text: &mut String, answer: &Answer) {
    let nearest = if jrdb_search::is_nearest_only(answer) { "nobody quite; nearest: " } else { "" };
    line(text, &format!("    answer  {nearest}{}", reply(answer)));
    let selected: Vec<_> = answer.trace.iter().filter(|trace| trace.selected).collect();
    for trace in selected.iter().take(EXPLAINED_MAX).filter(|trace| !trace.checks.is_empty()) {
        line(text, &format!("            {}", why(trace)));
    }
    if selected.len() > EXPLAINED_MAX && !selected[0].checks.is_empty() {
        line(text, &format!("            … and {} more", selected.len() - EXPLAINED_MAX));
    }
}

/// Why a thing is not in an answer.
fn why_not_text(answer: &Answer, id: &EntityId) -> String {
    format!("why not {}? {}", id.short(), jrdb_search::why_not(answer, id))
}

/// `would leave: #2, close distance from the robot, at 1.50 m instead of 1.32 m (1.3 standard deviations)`.
fn change_text(change: &Change) -> String {
    let effect = match change.effect {
        Effect::Enters => "would enter",
        Effect::Leaves => "would leave",
    };
    let unit = match change.measured.unit {
        Unit::Metres => " m",
        Unit::Degrees => "°",
        Unit::MetresPerSecond => " m/s",
        Unit::Probability | Unit::Count | Unit::AgeGroup => "",
    };
    let of = change.witness.as_ref().map(|id| format!(" of {}", id.short())).unwrap_or_default();
    let deviations =
        change.deviations.map(|n| format!(" ({n:.1} standard deviations)")).unwrap_or_default();
    format!(
        "{effect}: {}, {}{of}, at {:.2}{unit} instead of {:.2}{unit}{deviations}",
        change.id.short(),
        change.condition,
        change.to,
        change.measured.value
    )
}

/// An answer with its reasons: who was chosen and why, or why one thing was not.
#[must_use]
pub fn answer(query: &Query, answer: &Answer, why_not: Option<&EntityId>) -> String {
    let issues = answer.issues.iter().map(|issue| query_issue_text(&query.text, issue));
    let mut lines: Vec<String> = issues.collect();
    lines.push(match why_not {
        None => jrdb_search::explain(answer, EXPLAINED_MAX),
        Some(id) => why_not_text(answer, id),
    });
    lines.extend(answer.sensitivity.iter().map(change_text));
    lines.join("\n")
}

fn truth_text(text: &mut String, asked: &Answered, score: &jrdb_types::score::QuestionScore) {
    let Some(truth) = &asked.question.truth else { return };
    let wanted = match asked.answer.task {
        Task::Count => truth.count.map_or_else(|| ids(&truth.ids), |count| count.to_string()),
        _ if truth.ids.is_empty() => format!("{} boxes", truth.boxes.len()),
        _ => ids(&truth.ids),
    };
    let verdict = match score.exact {
        Some(true) => "exact, ",
        Some(false) => "WRONG, ",
        None => "",
    };
    let boxes = score.true_positives + score.false_negatives;
    let iou = if boxes > 0 { score.matched_iou / boxes as f64 } else { 0.0 };
    line(text, &format!("    truth   {wanted}   {verdict}IoU {iou:.3}"));
}

/// A candidate's conditions in one line.
fn why(trace: &CandidateTrace) -> String {
    let checks: Vec<String> = trace.checks.iter().map(check_text).collect();
    format!("{}: {}", trace.id.short(), checks.join("; "))
}

/// `close distance from the robot (close, 1.05 m)`, `NOT age young (child)`,
/// `has a person to its left (#3: close, 1.21 m; left, +88°)`.
fn check_text(check: &Check) -> String {
    let mark = if check.holds { "" } else { "NOT " };
    let found = check.found.as_deref().unwrap_or("unknown");
    // Each of the relations with the partner is in what was found; left are the partner's own conditions.
    let is_new = |part: &&Check| {
        part.found != check.found
            && (part.witnesses.is_empty() || part.witnesses != check.witnesses)
    };
    let parts = check.parts.iter().filter(is_new).map(check_text);
    let inner: Vec<String> = std::iter::once(found.to_owned()).chain(parts).collect();
    let inner = inner.join("; ");
    if check.witnesses.is_empty() {
        let says_itself = check.holds && check.parts.is_empty() && check.asked.ends_with(found);
        return if says_itself {
            check.asked.clone()
        } else {
            format!("{mark}{} ({inner})", check.asked)
        };
    }
    format!("{mark}{} ({}: {inner})", check.asked, ids(&check.witnesses))
}

/// The reply, and who is meant.
fn reply(answer: &Answer) -> String {
    match &answer.reply {
        Reply::Things => ids(&answer.selection),
        Reply::Number(number) => format!("{number}: {}", ids(&answer.selection)),
        Reply::YesNo(true) => format!("yes: {}", ids(&answer.selection)),
        Reply::YesNo(false) => "no".into(),
        Reply::Told(told) => {
            let words = |told: &Told| {
                if told.words.is_empty() { "unknown".into() } else { told.words.join("; ") }
            };
            let told: Vec<String> =
                told.iter().map(|told| format!("{} {}", told.id.short(), words(told))).collect();
            if told.is_empty() { "nobody".into() } else { told.join("\n            ") }
        }
    }
}

fn ids(ids: &[EntityId]) -> String {
    if ids.is_empty() {
        "none".into()
    } else {
        ids.iter().map(EntityId::short).collect::<Vec<_>>().join(" ")
    }
}

/// Issues as lines: one message told once, with all the things it is about, in the order of the first.
pub fn notes<'a>(issues: impl IntoIterator<Item = &'a Issue>) -> Vec<String> {
    let mut told: Vec<(&str, Vec<String>)> = Vec::new();
    for issue in issues {
        let at = told.iter().position(|(message, _)| *message == issue.message);
        let at = at.unwrap_or_else(|| {
            told.push((&issue.message, Vec::new()));
            told.len() - 1
        });
        told[at].1.extend(issue.subject.as_ref().map(EntityId::short));
    }
    let line = |(message, subjects): &(&str, Vec<String>)| {
        let colon = if subjects.is_empty() { "" } else { ": " };
        format!("note: {}{colon}{message}", subjects.join(" "))
    };
    told.iter().map(line).collect()
}

/// An issue of a query with the words it is about underlined.
#[must_use]
pub fn query_issue_text(query: &str, issue: &Issue) -> String {
    let hint = issue
        .suggestion
        .as_ref()
        .map(|word| format!("; did you mean {word:?}?"))
        .unwrap_or_default();
    let marks = issue.span.and_then(|span| underline(query, span));
    let marks = marks.map(|marks| format!("{marks}\n")).unwrap_or_default();
    format!("{marks}note: {}{hint}", issue.message)
}

fn underline(query: &str, span: Span) -> Option<String> {
    let before = query.get(..span.start)?.chars().count();
    let under = query.get(span.start..span.end)?.chars().count();
    Some(format!("{}{}", " ".repeat(before), "^".repeat(under)))
}

fn indent(text: &str, by: &str) -> String {
    text.lines().map(|line| format!("{by}{line}")).collect::<Vec<_>>().join("\n")
}

/// Scores as a table, one row per category.
#[must_use]
pub fn scores_text(scores: &Scores) -> String {
    let mut text = format!(
        "{:<32} {:>9} {:>8} {:>12} {:>10} {:>6} {:>6}\n",
        "category", "exact", "miou_gt", "miou_matched", "miou_query", "AP50", "mAP"
    );
    let all = [("all", &scores.overall)];
    let rows = scores.categories.iter().map(|(name, summary)| (name.as_str(), summary));
    for (name, s) in rows.chain(all) {
        // Writing to a String does not fail.
        let _ = writeln!(
            text,
            "{name:<32} {:>9} {:>8.3} {:>12.3} {:>10.3} {:>6.3} {:>6.3}",
            format!("{}/{}", s.exact, s.questions),
            s.miou_gt,
            s.miou_matched,
            s.miou_query,
            s.ap50,
            s.map
        );
    }
    let kind = serde_json::to_value(scores.iou).ok();
    let kind = kind.as_ref().and_then(Value::as_str).unwrap_or_default();
    let _ = writeln!(text, "IoU is {kind}");
    text
}
