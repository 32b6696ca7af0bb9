//! Results for people and for programs.

use jrdb_types::detection::PERSON;
use jrdb_types::{Answer, Artefact, EntityId, Query};
use serde_json::{Value, json};

use crate::frame::{Asked, FrameOutput};
use crate::run::RunResult;
use crate::{PipelineConfig, with_causes};

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
        text.push_str(&jrdb_render::scores(scores));
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
        .map(|asked| jrdb_render::with_words(asked.answer.clone()))
        .map(|answer| json!(Artefact::new(json!(config.search), answer)));
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
    for note in jrdb_render::notes(output.detections.issues.iter().chain(&output.entities.issues)) {
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
        line(text, &indent(&jrdb_render::query_issue(&asked.query.text, issue), "  "));
    }
    match telling.detail {
        Detail::Brief => brief(text, &asked.answer),
        Detail::Full => {
            line(text, &indent(&jrdb_render::explain(&asked.answer, EXPLAINED_MAX), "    "));
        }
    }
    if let Some(id) = &telling.why_not {
        line(text, &indent(&why_not_text(&asked.answer, id), "    "));
    }
    for change in &asked.answer.sensitivity {
        line(text, &format!("    {}", jrdb_render::change(change)));
    }
}

fn brief(text: &mut String, answer: &Answer) {
    let labels = std::iter::once("    answer  ").chain(std::iter::repeat("            "));
    for (label, words) in labels.zip(jrdb_render::brief(answer, EXPLAINED_MAX)) {
        line(text, &format!("{label}{words}"));
    }
}

/// Why a thing is not in an answer.
fn why_not_text(answer: &Answer, id: &EntityId) -> String {
    format!("why not {}? {}", id.short(), jrdb_render::why_not(answer, id))
}

/// An answer with its reasons: who was chosen and why, or why one thing was not.
#[must_use]
pub fn answer(query: &Query, answer: &Answer, why_not: Option<&EntityId>) -> String {
    let issues = answer.issues.iter().map(|issue| jrdb_render::query_issue(&query.text, issue));
    let mut lines: Vec<String> = issues.collect();
    lines.push(match why_not {
        None => jrdb_render::explain(answer, EXPLAINED_MAX),
        Some(id) => why_not_text(answer, id),
    });
    lines.extend(answer.sensitivity.iter().map(jrdb_render::change));
    lines.join("\n")
}

fn truth_text(text: &mut String, asked: &Asked, score: &jrdb_types::score::QuestionScore) {
    if let Some(truth) = jrdb_render::truth(&asked.question, &asked.answer, score) {
        line(text, &format!("    truth   {truth}"));
    }
}

fn indent(text: &str, by: &str) -> String {
    text.lines().map(|line| format!("{by}{line}")).collect::<Vec<_>>().join("\n")
}
