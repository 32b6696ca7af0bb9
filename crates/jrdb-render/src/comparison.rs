//! Two runs side by side, in words.

use jrdb_types::score::{Comparison, Difference, QuestionName};

use crate::scores::{ends, warning};

/// So many questions are listed.
const LISTED_MAX: usize = 20;

/// Whether a difference means anything, in a sentence.
///
/// ```
/// use jrdb_types::score::{Difference, Interval, IntervalMethod, Metric};
/// let interval = Interval { low: -0.01, high: 0.05, method: IntervalMethod::BootstrapT };
/// let mut difference = Difference {
///     metric: Metric::MiouGt, a: 0.5, b: 0.52, difference: 0.02,
///     interval: Some(interval), contains_zero: Some(true), recordings: 27, warning: None,
/// };
/// let text = jrdb_render::distinguishable(&difference);
/// assert_eq!(text, "the difference is not distinguishable from zero");
/// difference.contains_zero = Some(false);
/// let text = jrdb_render::distinguishable(&difference);
/// assert_eq!(text, "the difference is distinguishable from zero");
/// ```
#[must_use]
pub fn distinguishable(difference: &Difference) -> &'static str {
    match difference.contains_zero {
        Some(true) => "the difference is not distinguishable from zero",
        Some(false) => "the difference is distinguishable from zero",
        None => "whether the difference is distinguishable from zero cannot be told",
    }
}

/// A comparison: a table of every metric by category, what it comes to overall, and the questions
/// that were fixed and broken.
#[must_use]
pub fn comparison(of: &Comparison) -> String {
    let mut text = format!(
        "{:<32} {:<16} {:>7} {:>7} {:>8}  95 % interval, * without zero\n",
        "category", "metric", "a", "b", "b - a"
    );
    let categories = of.categories.iter().map(|(name, all)| (name.as_str(), all));
    for (name, all) in categories.chain([("all", &of.overall)]) {
        all.iter().for_each(|one| text += &row(name, one));
    }
    text += &format!(
        "{}, {}\n",
        counted(of.questions, "question"),
        counted(of.recordings, "recording")
    );
    for one in &of.overall {
        text += &format!("{}: {}\n", one.metric.name(), distinguishable(one));
    }
    text + &listed("fixed", &of.fixed) + &listed("broken", &of.broken)
}

fn row(name: &str, of: &Difference) -> String {
    let mark = if of.contains_zero == Some(false) { " *" } else { "" };
    let ends = of.interval.as_ref().map(ends).unwrap_or_default();
    let tail = format!("{ends}{mark}{}", warning(of.warning, of.recordings));
    let line = format!(
        "{name:<32} {:<16} {:>7.3} {:>7.3} {:>+8.3}  {tail}",
        of.metric.name(),
        of.a,
        of.b,
        of.difference
    );
    format!("{}\n", line.trim_end())
}

fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// The questions in a list with a head: `fixed: 2 questions`.
fn listed(head: &str, questions: &[QuestionName]) -> String {
    let mut text = format!("{head}: {}\n", counted(questions.len(), "question"));
    for one in questions.iter().take(LISTED_MAX) {
        let id = one.question_id.as_ref().map(|id| format!(" {id}")).unwrap_or_default();
        text += &format!("  {}{id} {:?}\n", one.frame, one.question);
    }
    if questions.len() > LISTED_MAX {
        text += &format!("  and {} more\n", questions.len() - LISTED_MAX);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use jrdb_types::FrameId;
    use jrdb_types::score::{Interval, IntervalMethod, IntervalWarning, IouKind, Metric, Protocol};
    use std::collections::BTreeMap;

    fn difference(metric: Metric, a: f64, b: f64, reach: Option<f64>) -> Difference {
        let (difference, method) = (b - a, IntervalMethod::BootstrapT);
        let interval = reach.map(|reach| {
            let (low, high) = (difference - reach, difference + reach);
            Interval { low, high, method }
        });
        Difference {
            metric,
            a,
            b,
            difference,
            interval,
            contains_zero: interval.map(|interval| interval.contains(0.0)),
            recordings: if interval.is_some() { 27 } else { 1 },
            warning: interval.is_none().then_some(IntervalWarning::OneRecording),
        }
    }

    fn name(question: &str) -> QuestionName {
        let frame = FrameId { sequence: "cafe_0".into(), frame: 12 };
        let (question, category) = (question.into(), "age".into());
        QuestionName { frame, question_id: None, question, category }
    }

    #[test]
    fn a_comparison_says_which_differences_mean_anything() {
        let (iou, period_px) = (IouKind::Circular, Some(3760.0));
        let version = Protocol::VERSION;
        let protocol = Protocol { version, iou, period_px, match_iou: 0.5, questions_digest: None };
        let overall = vec![
            difference(Metric::Exact, 0.5, 0.625, Some(0.1)),
            difference(Metric::MiouGt, 0.5, 0.48, Some(0.03)),
        ];
        let age = vec![difference(Metric::MapRanking, 0.25, 0.5, None)];
        let of = Comparison {
            protocol,
            questions: 800,
            recordings: 27,
            categories: BTreeMap::from([("age".into(), age)]),
            overall,
            fixed: vec![name("Find child persons"); 22],
            broken: vec![QuestionName { question_id: Some("q7".into()), ..name("Find him") }],
        };
        insta::assert_snapshot!(comparison(&of));
    }
}
