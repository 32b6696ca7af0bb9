//! The scores of a method on parts of the questions: where it is good and where not.

use std::collections::BTreeMap;

use jrdb_metrics::slices;
use jrdb_parser::ParserConfig;
use jrdb_pipeline::query::read_or_report;
use jrdb_study::{Cell, Origin, Role, Row, Table, Unit, heading};
use jrdb_types::score::{Metric, QuestionScore, Summary};
use jrdb_types::{Condition, FrameId, Pattern, Question, Scores};

/// What is shown of each slice.
const METRICS: [Metric; 4] =
    [Metric::Exact, Metric::MapRanking, Metric::MapSelection, Metric::MiouGt];
/// So many people are a crowd.
const CROWD: usize = 3;

/// What questions are sliced by: the name of the key, and the key of a question.
type Key = (&'static str, fn(&Question, Option<f64>) -> String);

const KEYS: [Key; 4] = [
    ("recording", |question, _| question.frame.sequence.clone()),
    ("people meant", people_meant),
    ("seam", across_the_seam),
    ("difficulty", difficulty),
];

/// A row for each recording, number of people meant, side of the seam, and difficulty.
pub(super) fn table(method: &str, questions: &[Question], scores: &Scores) -> Table {
    let by_name: BTreeMap<(&FrameId, &str), &Question> =
        questions.iter().map(|one| ((&one.frame, one.text.as_str()), one)).collect();
    let period_px = scores.protocol.period_px;
    let mut rows = Vec::new();
    for (name, key) in KEYS {
        let of = |score: &QuestionScore| {
            let question = by_name.get(&(&score.frame, score.question.as_str()))?;
            Some(key(question, period_px))
        };
        rows.extend(slices(scores, of).iter().map(|(value, summary)| row(name, value, summary)));
    }
    Table {
        title: format!("{method}: slices"),
        unit: Unit::Percent,
        categories: vec!["questions".into()],
        metrics: METRICS.map(heading).to_vec(),
        rows,
        notes: vec![
            "Difficulty counts entities (S), relations (R) and times (T), as the benchmark does."
                .into(),
        ],
    }
}

fn row(name: &str, value: &str, summary: &Summary) -> Row {
    let cell = |metric: Metric| metric.of(summary).map(|value| Cell::plain(100.0 * value));
    Row {
        method: format!("{name} {value} ({})", summary.questions),
        role: Role::Method,
        origin: Origin::Measured,
        cells: METRICS.map(cell).to_vec(),
        failure: None,
    }
}

fn people_meant(question: &Question, _: Option<f64>) -> String {
    let count = question.truth.as_ref().map_or(0, |truth| truth.boxes.len());
    if count < CROWD { count.to_string() } else { format!("{CROWD} or more") }
}

fn across_the_seam(question: &Question, period_px: Option<f64>) -> String {
    let mut boxes = question.truth.iter().flat_map(|truth| &truth.boxes);
    let crosses = period_px.is_some_and(|period| boxes.any(|bbox| bbox.x + bbox.w > period));
    if crosses { "crossed".into() } else { "not crossed".into() }
}

fn difficulty(question: &Question, _: Option<f64>) -> String {
    let query = read_or_report(&question.text, &ParserConfig::default());
    let relations = relations(&query.target);
    let times = question.slots.len().max(query.slots.len()).max(1);
    format!("S{} R{relations} T{times}", relations + 1)
}

/// How many relations a pattern asks for, those of its partners included.
fn relations(pattern: &Pattern) -> usize {
    pattern.conditions.iter().map(relations_of).sum()
}

fn relations_of(condition: &Condition) -> usize {
    match condition {
        Condition::Related(related) => 1 + relations(&related.partner),
        Condition::Is(pattern) => relations(pattern),
        Condition::Not(inner) => relations_of(inner),
        Condition::Any(parts) | Condition::All(parts) => parts.iter().map(relations_of).sum(),
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use jrdb_types::{PixelBox, Truth};

    fn asked(text: &str, x: f64) -> Question {
        let truth = Truth { boxes: vec![PixelBox::from([x, 0.0, 50.0, 90.0])], ..Truth::default() };
        Question { truth: Some(truth), ..Question::typed(text, FrameId::default()) }
    }

    #[test]
    fn questions_are_sliced_by_what_they_ask_and_where_the_answer_is() {
        let near = asked("Who is the woman left of a child?", 980.0);
        assert_eq!(difficulty(&near, None), "S2 R1 T1");
        assert_eq!(difficulty(&asked("Find all men", 0.0), None), "S1 R0 T1");
        assert_eq!(across_the_seam(&near, Some(1000.0)), "crossed");
        assert_eq!(across_the_seam(&near, None), "not crossed");
        assert_eq!(people_meant(&near, None), "1");
    }
}
