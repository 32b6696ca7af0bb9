//! What differs between two runs over the same questions, and whether that means anything.

use std::collections::BTreeMap;

use jrdb_types::score::{Comparison, Difference, Metric, QuestionName, QuestionScore, Summary};
use jrdb_types::{FrameId, Scores};

use crate::bootstrap::BootstrapConfig;
use crate::intervals::of_category;
use crate::protocol::{ProtocolMismatch, check};
use crate::recordings::{Recordings, Sureness};

/// Why two runs cannot be compared.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CompareError {
    /// They were judged by different rules.
    #[error("the runs were judged by different rules")]
    Protocol(#[from] ProtocolMismatch),
    /// A question was not asked equally often in both.
    #[error(
        "expected the same questions in both runs, found {frame} {question:?} {a} times in the first \
         and {b} times in the second"
    )]
    Questions {
        /// The question's frame.
        frame: FrameId,
        /// The question's name, else its words.
        question: String,
        /// How often the first run asks it.
        a: usize,
        /// How often the second run asks it.
        b: usize,
    },
    /// A question has another truth or category in the second run.
    #[error(
        "expected {field} of {frame} {question:?} to be {a} in both runs, found {b} in the second"
    )]
    Question {
        /// The question's frame.
        frame: FrameId,
        /// The question's name, else its words.
        question: String,
        /// What differs.
        field: &'static str,
        /// In the first run.
        a: String,
        /// In the second run.
        b: String,
    },
}

/// Compares two runs over the same questions, in whatever order they were asked: every metric by
/// category and overall with the 95 % interval of its difference `b - a`, and the questions that
/// the second run fixes and breaks. The recordings of both runs are drawn together.
///
/// # Errors
/// [`CompareError`] names what differs when protocols or questions do.
///
/// ```
/// use jrdb_metrics::{BootstrapConfig, MetricsConfig, compare, from_judgements};
/// let run = from_judgements(MetricsConfig::default().protocol(), Vec::new());
/// let comparison = compare(&run, &run, &BootstrapConfig::default()).unwrap();
/// assert!(comparison.fixed.is_empty() && comparison.broken.is_empty());
/// ```
pub fn compare(
    a: &Scores,
    b: &Scores,
    config: &BootstrapConfig,
) -> Result<Comparison, CompareError> {
    check(&a.protocol, &b.protocol)?;
    let pairs = pairs(a, b)?;
    let (all_a, all_b) = (Side::whole(a), Side::whole(b));
    let differ = |name: &String| {
        let sides = (Side::category(a, name), Side::category(b, name));
        (name.clone(), differences(&sides.0, &sides.1, config))
    };
    Ok(Comparison {
        protocol: a.protocol.clone(),
        questions: pairs.len(),
        recordings: all_a.recordings.count,
        categories: a.categories.keys().map(differ).collect(),
        overall: differences(&all_a, &all_b, config),
        fixed: changed(pairs.iter().map(|&(a, b)| (a, b))),
        broken: changed(pairs.iter().map(|&(a, b)| (b, a))),
    })
}

/// A run's questions of a group.
struct Side<'a> {
    summary: Summary,
    recordings: Recordings<'a>,
}

impl<'a> Side<'a> {
    fn whole(scores: &'a Scores) -> Self {
        let all: Vec<&QuestionScore> = scores.questions.iter().collect();
        Self { summary: scores.overall, recordings: Recordings::new(&all) }
    }

    fn category(scores: &'a Scores, name: &str) -> Self {
        let all = of_category(&scores.questions, name);
        Self { summary: scores.categories[name], recordings: Recordings::new(&all) }
    }
}

fn differences(a: &Side<'_>, b: &Side<'_>, config: &BootstrapConfig) -> Vec<Difference> {
    let difference = |metric: Metric| {
        let (in_a, in_b) = (metric.of(&a.summary)?, metric.of(&b.summary)?);
        let Sureness { interval, recordings, warning } =
            a.recordings.sureness_of_difference(&b.recordings, metric, config);
        let contains_zero = interval.map(|interval| interval.contains(0.0));
        (recordings > 0).then_some(Difference {
            metric,
            a: in_a,
            b: in_b,
            difference: in_b - in_a,
            interval,
            contains_zero,
            recordings,
            warning,
        })
    };
    Metric::ALL.into_iter().filter_map(difference).collect()
}

/// The questions that are wrong in the first and exact in the second.
fn changed<'a>(
    pairs: impl Iterator<Item = (&'a QuestionScore, &'a QuestionScore)>,
) -> Vec<QuestionName> {
    let is_exact = |one: &QuestionScore| one.exact == Some(true);
    let changed = pairs.filter(|(from, to)| !is_exact(from) && is_exact(to));
    changed.map(|(from, _)| QuestionName::from(from)).collect()
}

/// What a question is known by.
type Key<'a> = (&'a FrameId, &'a str);

fn by_key(scores: &Scores) -> BTreeMap<Key<'_>, Vec<&QuestionScore>> {
    let mut by_key: BTreeMap<Key<'_>, Vec<&QuestionScore>> = BTreeMap::new();
    for one in &scores.questions {
        by_key.entry((&one.frame, one.name())).or_default().push(one);
    }
    by_key
}

/// Every question of the first run with the same question of the second, by frame and name.
fn pairs<'a>(
    a: &'a Scores,
    b: &'a Scores,
) -> Result<Vec<(&'a QuestionScore, &'a QuestionScore)>, CompareError> {
    let (of_a, of_b) = (by_key(a), by_key(b));
    let count =
        |of: &BTreeMap<Key<'a>, Vec<&'a QuestionScore>>, key| of.get(key).map_or(0, Vec::len);
    for key in of_a.keys().chain(of_b.keys()) {
        let (a, b) = (count(&of_a, key), count(&of_b, key));
        if a != b {
            let (frame, question) = (key.0.clone(), key.1.into());
            return Err(CompareError::Questions { frame, question, a, b });
        }
    }
    let pairs: Vec<_> = of_a.into_values().flatten().zip(of_b.into_values().flatten()).collect();
    pairs.iter().try_for_each(|(a, b)| is_same(a, b))?;
    Ok(pairs)
}

/// Refuses a question whose category or truth is another.
fn is_same(a: &QuestionScore, b: &QuestionScore) -> Result<(), CompareError> {
    let truth = |value: Option<String>| value.unwrap_or_else(|| "none".into());
    let fields = |of: &QuestionScore| {
        [
            ("the category", of.category.clone()),
            ("the number of true boxes", of.true_boxes().to_string()),
            ("the true count", truth(of.count.map(|count| count.truth.to_string()))),
            ("the true yes or no", truth(of.yes_no.map(|yes_no| yes_no.truth.to_string()))),
        ]
    };
    for ((field, in_a), (_, in_b)) in fields(a).into_iter().zip(fields(b)) {
        if in_a != in_b {
            let (frame, question) = (a.frame.clone(), a.name().into());
            return Err(CompareError::Question { frame, question, field, a: in_a, b: in_b });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::example::judgement;
    use crate::{MetricsConfig, from_judgements};
    use jrdb_types::score::IntervalWarning;

    /// A run of twelve recordings with three questions each, of which those chosen are answered.
    fn run(is_right: impl Fn(u32) -> bool) -> Scores {
        let question = |n: u32| {
            let ranked = if is_right(n) { [(0.9, 10)] } else { [(0.3, 10)] };
            let mut one = judgement(&format!("recording {}", n / 3), n % 3, &ranked, 0);
            one.category = if n.is_multiple_of(3) { "age" } else { "gender" }.into();
            one
        };
        from_judgements(MetricsConfig::default().protocol(), (0..36).map(question).collect())
    }

    fn compared(a: &Scores, b: &Scores) -> Comparison {
        compare(a, b, &BootstrapConfig::default()).unwrap()
    }

    fn exact(differences: &[Difference]) -> Difference {
        *differences.iter().find(|one| one.metric == Metric::Exact).unwrap()
    }

    #[test]
    fn a_run_compared_with_itself_does_not_differ() {
        let run = run(|n| n % 5 > 1);
        let comparison = compared(&run, &run);
        let all = comparison.categories.values().flatten().chain(&comparison.overall);
        for one in all {
            let interval = one.interval.unwrap();
            assert_eq!([one.difference, interval.low, interval.high], [0.0; 3], "{one:?}");
            assert_eq!(one.contains_zero, Some(true));
        }
        assert_eq!(comparison.overall.len(), 12);
        assert!(comparison.fixed.is_empty() && comparison.broken.is_empty());
    }

    #[test]
    fn what_is_fixed_and_broken_is_named_whatever_the_order() {
        let (a, mut b) = (run(|n| n != 4), run(|n| n != 7));
        b.questions.reverse();
        let comparison = compared(&a, &b);
        let frame = |of: &[QuestionName]| of[0].frame.to_string();
        assert_eq!(frame(&comparison.fixed), "recording 1/000001");
        assert_eq!(frame(&comparison.broken), "recording 2/000001");
        assert_eq!((comparison.questions, comparison.recordings), (36, 12));
        assert_eq!(exact(&comparison.overall).contains_zero, Some(true));
    }

    #[test]
    fn a_gain_in_nearly_every_recording_is_distinguishable() {
        let difference = exact(&compared(&run(|n| n % 4 == 0), &run(|n| n % 7 != 0)).overall);
        assert!(difference.difference > 0.5 && difference.contains_zero == Some(false));
    }

    #[test]
    fn where_one_run_has_no_value_there_is_no_interval() {
        let difference = compared(&run(|_| false), &run(|_| true)).overall;
        let matched = difference.iter().find(|one| one.metric == Metric::MiouMatched).unwrap();
        assert_eq!((matched.interval, matched.contains_zero), (None, None));
        assert_eq!(matched.warning, Some(IntervalWarning::NoValue));
    }

    #[test]
    fn few_recordings_are_said_and_one_has_no_interval() {
        let of = |recordings: u32| {
            let mut run = run(|n| n % 2 == 0);
            run.questions.truncate(recordings as usize * 3);
            let run = from_judgements(run.protocol, run.questions);
            exact(&compared(&run, &run).overall)
        };
        assert_eq!(of(9).warning, Some(IntervalWarning::FewRecordings));
        assert_eq!((of(1).interval, of(1).warning), (None, Some(IntervalWarning::OneRecording)));
        assert_eq!(of(10).warning, None);
    }

    #[test]
    fn other_questions_and_protocols_are_refused_by_name() {
        let (a, mut b) = (run(|_| true), run(|_| true));
        let error = |b: &Scores| compare(&a, b, &BootstrapConfig::default()).unwrap_err();
        b.questions[5].question = "Find her".into();
        let words = "expected the same questions in both runs, found recording 1/000002 \"Find them\" \
                     1 times in the first and 0 times in the second";
        assert_eq!(error(&b).to_string(), words);
        b = run(|_| true);
        b.questions[5].false_negatives += 1;
        let words = "expected the number of true boxes of recording 1/000002 \"Find them\" to be 1 \
                     in both runs, found 2 in the second";
        assert_eq!(error(&b).to_string(), words);
        b.protocol.match_iou = 0.7;
        assert!(matches!(error(&b), CompareError::Protocol(m) if m.field == "match_iou"));
    }
}
