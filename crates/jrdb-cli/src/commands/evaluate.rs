//! `jrdb evaluate`: answers and truth to scores.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Result, bail};
use clap::Args;
use jrdb_cli::Error;
use jrdb_cli::answers::{Matched, load_answers, match_answers, questions_digest};
use jrdb_metrics::BootstrapConfig;
use jrdb_pipeline::PipelineConfig;
use jrdb_types::Question;
use serde_json::json;

use super::args::Iou;
use super::stage::OutputArgs;

/// Unanswered questions that are listed one by one.
const LISTED_MAX: usize = 10;

/// Flags of `evaluate`.
#[derive(Debug, Args)]
pub(crate) struct EvaluateArgs {
    /// Answers: artefacts, JSON Lines, COCO results, folders of answers or patterns like
    /// out/*/q*/answer.json; may be given several times
    #[arg(long, value_name = "FILE", required = true)]
    answers: Vec<String>,
    /// Questions with their truth, in the JRDB-Reasoning layout; may be given several times
    #[arg(long, value_name = "FILE", required = true)]
    questions: Vec<PathBuf>,
    /// Which IoU scores use
    #[arg(long, value_enum, default_value_t)]
    iou: Iou,
    /// Circumference of the panorama for circular IoU, pixels
    #[arg(long, default_value_t = 3760.0, value_name = "PX")]
    period_px: f64,
    #[command(flatten)]
    output: OutputArgs,
}

pub(crate) fn evaluate(args: &EvaluateArgs) -> Result<ExitCode> {
    let mut questions: Vec<Question> = Vec::new();
    for path in &args.questions {
        questions.extend(jrdb_dataset::read_questions(path).map_err(Error::from)?.questions);
    }
    let matched = match_answers(&questions, load_answers(&args.answers)?)?;
    if matched.answered.is_empty() {
        bail!(nothing_matches(args, &questions, &matched));
    }
    tell(&matched, questions.len());
    let mut config = PipelineConfig::default();
    args.iou.apply(&mut config);
    config.metrics.period_px = Some(args.period_px);
    config.metrics.questions_digest = Some(questions_digest(&questions));
    let mut scores = matched.scores(&config.metrics);
    let intervals = jrdb_metrics::intervals(&scores, &BootstrapConfig::default());
    let summary =
        format!("{}\n{}", jrdb_render::scores(&scores), jrdb_render::intervals(&intervals));
    scores.intervals = Some(intervals);
    args.output.give(json!(config.metrics), &scores, &summary)
}

fn nothing_matches(args: &EvaluateArgs, questions: &[Question], matched: &Matched) -> String {
    let first = matched.first_stranger.as_deref().unwrap_or("there are no answers");
    let asked = questions.first().map_or_else(
        || "they have no questions".into(),
        |question| format!("their first is {:?} about {}", question.text, question.frame),
    );
    format!(
        "expected answers to questions of {:?}, found none: the first answer is {first}; {asked}",
        args.questions
    )
}

/// Says what was left out.
fn tell(matched: &Matched, questions: usize) {
    if let Some(first) = &matched.first_stranger {
        let count = matched.strangers;
        eprintln!("note: {count} answers are to no question of the file, the first: {first}");
    }
    let unanswered = &matched.unanswered;
    if unanswered.is_empty() {
        return;
    }
    let count = unanswered.len();
    eprintln!("note: {count} of {questions} questions have no answer and count as missed:");
    for question in unanswered.iter().take(LISTED_MAX) {
        eprintln!("  {} {:?}", question.frame, question.text);
    }
    if count > LISTED_MAX {
        eprintln!("  and {} more", count - LISTED_MAX);
    }
}
