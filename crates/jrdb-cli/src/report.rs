//! Results for people and for programs.

use jrdb_metrics::Outcome;
use jrdb_pipeline::PipelineConfig;
use jrdb_types::detection::PERSON;
use jrdb_types::score::QuestionScore;
use jrdb_types::{Answer, Artefact, EntityId, FrameId, Query, with_causes};
use serde_json::{Value, json};

use crate::health::{self, FrameHealth};
use crate::questions::Answered;
use crate::result::{FrameOutput, FrameResult, RunSummary};
use crate::run::metrics_config;

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
    /// How many questions are answered as the truth says, and the others with what led to it.
    Misses,
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
        text.push_str(&jrdb_render::scores(scores));
    }
    text
}

/// Results for programs, printed while the run goes on. Answers and scores are artefacts.
#[derive(Debug)]
pub struct JsonReport {
    form: JsonForm,
    answers: usize,
    frames: Vec<FrameHealth>,
}

/// How results for programs are laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JsonForm {
    /// One document: `{"answers": [..], "frames": [..], "failures": [..], "unasked": 0, "summary": {..}, "scores": ..}`.
    Document,
    /// A line for each answer, and a last line with the same document without its answers.
    Lines,
}

impl JsonReport {
    /// A report without answers yet.
    #[must_use]
    pub fn new(form: JsonForm) -> Self {
        Self { form, answers: 0, frames: Vec::new() }
    }

    /// What a frame adds to the report.
    #[must_use]
    pub fn frame(&mut self, output: &FrameOutput, config: &PipelineConfig) -> String {
        self.frames.push(FrameHealth::of(&output.scene));
        output.answered.iter().map(|one| self.answer(&one.answer, config)).collect()
    }

    /// What an answer adds to the report.
    #[must_use]
    pub fn answer(&mut self, answer: &Answer, config: &PipelineConfig) -> String {
        let artefact = Artefact::new(json!(config.search), jrdb_render::with_words(answer.clone()));
        self.answers += 1;
        match (self.form, self.answers) {
            (JsonForm::Lines, _) => format!("{}\n", json!(artefact)),
            (JsonForm::Document, 1) => {
                format!("{{\n  \"answers\": [\n    {}", pretty(&json!(artefact), "    "))
            }
            (JsonForm::Document, _) => format!(",\n    {}", pretty(&json!(artefact), "    ")),
        }
    }

    /// The rest of the report. Of lines, only the frames with issues are in it.
    #[must_use]
    pub fn end(mut self, summary: &RunSummary, config: &PipelineConfig) -> String {
        let failure =
            |(frame, error): &(FrameId, String)| json!({ "frame": frame, "error": error });
        let failures: Vec<Value> = summary.failures.iter().map(failure).collect();
        let scores = summary.scores.clone();
        let scores = scores.map(|scores| json!(Artefact::new(json!(config.metrics), scores)));
        if self.form == JsonForm::Lines {
            self.frames.retain(|frame| !frame.issues.is_empty());
        }
        let rest = [
            ("frames", json!(self.frames)),
            ("failures", json!(failures)),
            ("unasked", json!(summary.unasked)),
            ("summary", json!(summary.health)),
            ("scores", json!(scores)),
        ];
        if self.form == JsonForm::Lines {
            let rest: serde_json::Map<String, Value> =
                rest.into_iter().map(|(name, value)| (name.into(), value)).collect();
            return format!("{}\n", Value::Object(rest));
        }
        let answers = if self.answers == 0 { "{\n  \"answers\": []" } else { "\n  ]" };
        let rest = rest.map(|(name, value)| format!(",\n  \"{name}\": {}", pretty(&value, "  ")));
        format!("{answers}{}\n}}\n", rest.concat())
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
    let FrameOutput { scene, answered, .. } = output;
    let nodes = &scene.graph().nodes;
    let people = nodes.iter().filter(|node| node.category == PERSON).count();
    let objects = nodes.len() - people;
    let placed = nodes.iter().filter(|node| node.center.is_some()).count();
    let frame = scene.id();
    line(
        text,
        &format!("{frame}: {people} people, {objects} objects, {placed} of them placed in 3D"),
    );
    for note in jrdb_render::notes(&health::issues(scene)) {
        line(text, &format!("  {note}"));
    }
    if telling.detail == Detail::Misses {
        misses_text(text, output, telling);
    } else {
        answered.iter().for_each(|answered| answered_text(text, answered, telling));
    }
    text.push('\n');
}

/// How many questions are answered as the truth says, and the others with what led to it.
fn misses_text(
    text: &mut String,
    FrameOutput { scene, answered, .. }: &FrameOutput,
    telling: &Telling,
) {
    let verdict = |one: &Answered| one.score.as_ref().and_then(|score| score.exact);
    let verdicts: Vec<bool> = answered.iter().filter_map(verdict).collect();
    if !verdicts.is_empty() {
        let exact = verdicts.iter().filter(|is_exact| **is_exact).count();
        line(text, &format!("  {exact} of {} questions are answered exactly", verdicts.len()));
    }
    let detections = scene.detections();
    let config = metrics_config(scene.config(), detections.image);
    for one in answered.iter().filter(|one| verdict(one) != Some(true)) {
        answered_text(text, one, telling);
        let outcome = Outcome { question: &one.question, answer: &one.answer };
        for miss in jrdb_metrics::misses(outcome, &detections.detections, &config) {
            line(text, &format!("    because {}", jrdb_render::miss(&miss, &one.answer)));
        }
    }
}

fn answered_text(text: &mut String, asked: &Answered, telling: &Telling) {
    line(text, &format!("\n  {}", asked.question.text));
    for issue in &asked.answer.issues {
        line(text, &indent(&jrdb_render::query_issue(&asked.query.text, issue), "  "));
    }
    match telling.detail {
        Detail::Brief | Detail::Misses => brief(text, &asked.answer),
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
    if let Some(score) = &asked.score {
        truth_text(text, asked, score);
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

fn truth_text(text: &mut String, asked: &Answered, score: &QuestionScore) {
    if let Some(truth) = jrdb_render::truth(&asked.question, &asked.answer, score) {
        line(text, &format!("    truth   {truth}"));
    }
}

fn indent(text: &str, by: &str) -> String {
    text.lines().map(|line| format!("{by}{line}")).collect::<Vec<_>>().join("\n")
}
