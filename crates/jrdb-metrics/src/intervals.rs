//! Scores with their intervals.

use jrdb_types::Scores;
use jrdb_types::score::{Estimate, Intervals, Metric, QuestionScore, Summary};

use crate::bootstrap::BootstrapConfig;
use crate::recordings::{Recordings, Sureness};

/// Every metric of a run with its 95 % interval, by category and overall.
///
/// Recordings, not frames, are what varies independently. Ratios have studentised bootstrap
/// intervals (Student's quantile with fewer than ten recordings, and where almost none differs),
/// average precisions jackknife intervals. With one recording there is none.
///
/// ```
/// use jrdb_metrics::{BootstrapConfig, MetricsConfig, from_judgements, intervals};
/// let scores = from_judgements(MetricsConfig::default().protocol(), Vec::new());
/// let sure = intervals(&scores, &BootstrapConfig::default());
/// assert!(sure.overall.is_empty());
/// ```
#[must_use]
pub fn intervals(scores: &Scores, config: &BootstrapConfig) -> Intervals {
    let all: Vec<&QuestionScore> = scores.questions.iter().collect();
    let of = |name: &String, summary| {
        let questions = of_category(&scores.questions, name);
        with_intervals(&questions, summary, config)
    };
    let categories =
        scores.categories.iter().map(|(name, s)| (name.clone(), of(name, s))).collect();
    Intervals { categories, overall: with_intervals(&all, &scores.overall, config) }
}

fn with_intervals(
    questions: &[&QuestionScore],
    summary: &Summary,
    config: &BootstrapConfig,
) -> Vec<Estimate> {
    let recordings = Recordings::new(questions);
    let estimate = |metric: Metric| {
        let value = metric.of(summary)?;
        let Sureness { interval, recordings, warning } = recordings.sureness(metric, config);
        let estimate = Estimate { metric, value, interval, recordings, warning };
        (recordings > 0).then_some(estimate)
    };
    Metric::ALL.into_iter().filter_map(estimate).collect()
}

/// The questions of a category, in their order.
pub(crate) fn of_category<'a>(
    questions: &'a [QuestionScore],
    category: &str,
) -> Vec<&'a QuestionScore> {
    questions.iter().filter(|one| one.category == category).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::example::judgement;
    use crate::{MetricsConfig, from_judgements};
    use jrdb_types::score::{IntervalMethod, IntervalWarning};

    fn scores(recordings: usize) -> Scores {
        let one = |n: usize| {
            let ranked = [(0.9, n % 11), (0.2, n % 7)];
            let mut one = judgement(&format!("recording {}", n / 4), n as u32, &ranked, n % 2);
            one.category = if n < 4 { "age" } else { "gender" }.into();
            one
        };
        let questions = (0..4 * recordings).map(one).collect();
        from_judgements(MetricsConfig::default().protocol(), questions)
    }

    #[test]
    fn values_are_those_of_the_summary_and_lie_in_their_intervals() {
        let scores = scores(12);
        let sure = intervals(&scores, &BootstrapConfig::default());
        assert_eq!(sure.overall.len(), 12);
        for estimate in &sure.overall {
            assert_eq!(Some(estimate.value), estimate.metric.of(&scores.overall));
            let interval = estimate.interval.unwrap();
            let reach = interval.low - 1e-12..interval.high + 1e-12;
            assert!(reach.contains(&estimate.value) && estimate.warning.is_none(), "{estimate:?}");
        }
    }

    #[test]
    fn a_category_of_one_recording_has_values_without_intervals() {
        let sure = intervals(&scores(12), &BootstrapConfig::default());
        let warning = Some(IntervalWarning::OneRecording);
        let is_alone = |one: &Estimate| one.interval.is_none() && one.warning == warning;
        assert!(sure.categories["age"].iter().all(is_alone));
        assert!(!sure.categories["age"].is_empty());
    }

    #[test]
    fn few_recordings_are_said_and_have_students_intervals() {
        let sure = intervals(&scores(5), &BootstrapConfig::default());
        assert_eq!(sure.overall[0].interval.unwrap().method, IntervalMethod::StudentT);
        assert_eq!(sure.overall[0].warning, Some(IntervalWarning::FewRecordings));
    }
}
