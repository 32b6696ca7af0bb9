//! Results for people and for programs.

use std::fmt::Write as _;

use jrdb_types::answer::{CandidateTrace, Change, Check, Effect, Reply, Told, Unit};
use jrdb_types::detection::PERSON;
use jrdb_types::{Answer, Artefact, EntityId, Issue, Query, Scores, Span, Task};
use serde_json::{Value, json};

use crate::run::RunResult;
use jrdb_pipeline::{Asked, FrameOutput, PipelineConfig, with_causes};

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

/// The result as text: per frame what was found, per question the answer, the truth and why.
#[must_use]
pub fn text(result: &RunResult, telling: &Telling) -> String {
    let mut text = String::new();
    for note in &result.notes {
        line(&mut text, note);
    }
    let mut scores = result.scores.iter().flat_map(|scores| &scores.questions);
    for frame in &result.frames {
        match &frame.output {
            Ok(output) => frame_text(&mut text, output, telling, &mut scores),
            Err(error) => {
                line(&mut text, &format!("{}\n  failed: {}\n", frame.id, with_causes(error)));
            }
        }
    }
    for asked in &result.recordings {
        line(&mut text, &format!("{}, all frames", asked.answer.frame.sequence));
        asked_text(&mut text, asked, telling);
        if asked.question.truth.is_some()
            && let Some(score) = scores.next()
        {
            truth_text(&mut text, asked, score);
        }
        text.push('\n');
    }
    if result.unasked > 0 {
        line(&mut text, &format!("{} questions are about frames outside this run", result.unasked));
    }
    if let Some(scores) = &result.scores {
        text.push_str(&scores_text(scores));
    }
    text
}

/// The result as one JSON document: `{"answers": [..], "failures": [..], "scores": ..}`, answers and
/// scores as artefacts.
#[must_use]
pub fn json(result: &RunResult, config: &PipelineConfig) -> String {
    let outputs = result.frames.iter().filter_map(|frame| frame.output.as_ref().ok());
    let answers = outputs
        .flat_map(|output| &output.asked)
        .chain(&result.recordings)
        .map(|asked| json!(Artefact::new(json!(config.search), asked.answer.clone())));
    let failures = result.frames.iter().filter_map(|frame| {
        let error = frame.output.as_ref().err()?;
        Some(json!({ "frame": frame.id, "error": with_causes(error) }))
    });
    let scores = result.scores.clone().map(|s| json!(Artefact::new(json!(config.metrics), s)));
    let document = json!({
        "answers": answers.collect::<Vec<Value>>(),
        "failures": failures.collect::<Vec<Value>>(),
        "scores": scores,
    });
    let mut text = serde_json::to_string_pretty(&document).unwrap_or_default();
    text.push('\n');
    text
}

fn line(text: &mut String, words: &str) {
    text.push_str(words);
    text.push('\n');
}

fn frame_text<'a>(
    text: &mut String,
    output: &FrameOutput,
    telling: &Telling,
    scores: &mut impl Iterator<Item = &'a jrdb_types::score::QuestionScore>,
) {
    let people = output.graph.nodes.iter().filter(|node| node.category == PERSON).count();
    let objects = output.graph.nodes.len() - people;
    let placed = output.graph.nodes.iter().filter(|node| node.center.is_some()).count();
    let frame = &output.detections.frame;
    line(
        text,
        &format!("{frame}: {people} people, {objects} objects, {placed} of them placed in 3D"),
    );
    for note in notes(output.detections.issues.iter().chain(&output.entities.issues)) {
        line(text, &format!("  {note}"));
    }
    for asked in &output.asked {
        asked_text(text, asked, telling);
        if asked.question.truth.is_some()
            && let Some(score) = scores.next()
        {
            truth_text(text, asked, score);
        }
    }
    text.push('\n');
}

fn asked_text(text: &mut String, asked: &Asked, telling: &Telling) {
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

fn truth_text(text: &mut String, asked: &Asked, score: &jrdb_types::score::QuestionScore) {
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
