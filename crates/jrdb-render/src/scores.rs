//! Scores, in words.

use std::fmt::Write as _;

use jrdb_types::score::{
    Estimate, Interval, IntervalWarning, Intervals, IouKind, Metric, QuestionScore, Scores, Summary,
};
use jrdb_types::{Answer, Question, Task};

use crate::brief::ids;

/// The metrics of the table, each in a column headed by its name.
const COLUMNS: [Metric; 7] = [
    Metric::Accuracy,
    Metric::MiouGt,
    Metric::MiouMatched,
    Metric::MiouQuery,
    Metric::F1,
    Metric::MapRanking,
    Metric::MapSelection,
];

/// Scores as a table, one row per category; below it what questions for numbers, words, yes and no
/// came to.
#[must_use]
pub fn scores(scores: &Scores) -> String {
    let names = COLUMNS.map(|metric| format!("{:>1$}", metric.name(), width(metric)));
    let mut text = format!("{:<32} {:>9}{}\n", "category", "exact", names.concat());
    for (name, summary) in rows(scores) {
        let exact = format!("{}/{}", summary.exact, summary.questions);
        let cells =
            COLUMNS.map(|metric| format!("{:>1$}", number(metric.of(summary)), width(metric)));
        // Writing to a String does not fail.
        let _ = writeln!(text, "{name:<32} {exact:>9}{}", cells.concat());
    }
    for (name, summary) in rows(scores) {
        text += &replies(name, summary);
    }
    text + &iou(scores.protocol.iou)
}

/// Columns of a metric: its name or a number, and a blank.
fn width(metric: Metric) -> usize {
    const NUMBER: usize = 5;
    metric.name().len().max(NUMBER) + 1
}

/// The categories, then all.
fn rows(scores: &Scores) -> impl Iterator<Item = (&str, &Summary)> {
    let categories = scores.categories.iter().map(|(name, summary)| (name.as_str(), summary));
    categories.chain([("all", &scores.overall)])
}

/// A number of a table; a dash where there is none.
pub(crate) fn number(value: Option<f64>) -> String {
    value.map_or_else(|| "-".into(), |value| format!("{value:.3}"))
}

fn iou(kind: IouKind) -> String {
    let kind = match kind {
        IouKind::Planar => "planar",
        IouKind::Circular => "circular",
    };
    format!("IoU is {kind}\n")
}

/// A line for each of numbers, words, yes and no that was asked.
fn replies(name: &str, summary: &Summary) -> String {
    let counting = summary.counting.map(|of| {
        let unknown = of.asked - of.told;
        format!("{name}: numbers are off by {:.3} in the mean, {unknown} unknown\n", of.count_error)
    });
    let words = summary.words.map(|of| format!("{name}: words right {}/{}\n", of.right, of.asked));
    let yes_no = summary.yes_no.map(|of| {
        format!(
            "{name}: yes or no right {}/{}, unknown {}; coverage {:.3}, risk {:.3}\n",
            of.right, of.asked, of.unknown, of.coverage, of.risk
        )
    });
    counting.into_iter().chain(words).chain(yes_no).collect()
}

/// Scores with their 95 % intervals, a line for each metric of each category: `0.512 ± 0.070` is
/// the value and half the width of the interval, whose ends follow.
#[must_use]
pub fn intervals(intervals: &Intervals) -> String {
    let mut text = format!("{:<32} {:<16} {:>13}  95 % interval\n", "category", "metric", "value");
    let categories = intervals.categories.iter().map(|(name, all)| (name.as_str(), all));
    for (name, all) in categories.chain([("all", &intervals.overall)]) {
        for estimate in all {
            text += &estimate_line(name, estimate);
        }
    }
    text
}

fn estimate_line(name: &str, of: &Estimate) -> String {
    let reach = of.interval.map(|interval| format!(" ± {:.3}", interval.half_width()));
    let value = format!("{:.3}{}", of.value, reach.unwrap_or_default());
    let ends = of.interval.as_ref().map(ends).unwrap_or_default();
    let warning = warning(of.warning, of.recordings);
    let tail = format!("{value:>13}  {ends}{warning}");
    format!("{name:<32} {:<16} {}\n", of.metric.name(), tail.trim_end())
}

/// `[0.441, 0.580]`.
pub(crate) fn ends(interval: &Interval) -> String {
    format!("[{:.3}, {:.3}]", interval.low, interval.high)
}

/// What to know before an interval is trusted.
pub(crate) fn warning(warning: Option<IntervalWarning>, recordings: usize) -> String {
    match warning {
        None => String::new(),
        Some(IntervalWarning::OneRecording) => "no interval: one recording".into(),
        Some(IntervalWarning::NoValue) => "no interval: no value".into(),
        Some(_) => format!("  only {recordings} recordings"),
    }
}

/// The known answer of a question beside its score: `#1 #2   exact, IoU 1.000`; nothing where no
/// answer is known.
#[must_use]
pub fn truth(question: &Question, answer: &Answer, score: &QuestionScore) -> Option<String> {
    let truth = question.truth.as_ref()?;
    let wanted = match answer.task {
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
    Some(format!("{wanted}   {verdict}IoU {iou:.3}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use jrdb_types::score::{CountSummary, IntervalMethod, Protocol, WordSummary, YesNoSummary};
    use std::collections::BTreeMap;

    fn summary(map_ranking: f64) -> Summary {
        Summary {
            questions: 12,
            exact: 9,
            accuracy: 0.75,
            miou_gt: 0.7011,
            miou_matched: 0.9,
            miou_query: 0.71,
            f1: 0.8,
            map_ranking,
            map_selection: 0.3,
            ..Summary::default()
        }
    }

    #[test]
    fn scores_are_a_table_with_a_dash_where_nothing_was_to_be_found() {
        let counting = Some(CountSummary { asked: 4, told: 3, count_error: 0.5 });
        let words = Some(WordSummary { asked: 5, right: 4, accuracy: 0.8 });
        let (asked, right, wrong, unknown) = (4, 2, 1, 1);
        let (accuracy, coverage, risk) = (0.5, 0.75, 1.0 / 3.0);
        let yes_no = YesNoSummary { asked, right, wrong, unknown, accuracy, coverage, risk };
        let overall = Summary { counting, words, yes_no: Some(yes_no), ..summary(0.4321) };
        let categories = BTreeMap::from([("gender-age".into(), summary(-1.0))]);
        let (iou, period_px, questions_digest) = (IouKind::Planar, None, None);
        let version = Protocol::VERSION;
        let protocol = Protocol { version, iou, period_px, match_iou: 0.5, questions_digest };
        let (questions, intervals) = (vec![], None);
        let all = Scores { protocol, questions, categories, overall, intervals };
        insta::assert_snapshot!(scores(&all));
    }

    #[test]
    fn intervals_have_their_half_width_their_ends_and_their_warnings() {
        let method = IntervalMethod::BootstrapT;
        let estimate = |metric, interval: Option<[f64; 2]>, recordings, warning| Estimate {
            metric,
            value: 0.512,
            interval: interval.map(|[low, high]| Interval { low, high, method }),
            recordings,
            warning,
        };
        let few = Some(IntervalWarning::FewRecordings);
        let one = Some(IntervalWarning::OneRecording);
        let overall = vec![
            estimate(Metric::MiouGt, Some([0.441, 0.58]), 27, None),
            estimate(Metric::MapRanking, Some([0.3, 0.7]), 4, few),
        ];
        let categories =
            BTreeMap::from([("age".into(), vec![estimate(Metric::Exact, None, 1, one)])]);
        insta::assert_snapshot!(intervals(&Intervals { categories, overall }));
    }
}
