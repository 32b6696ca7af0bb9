//! Scores with their intervals.

use jrdb_types::Scores;
use jrdb_types::score::{Estimate, Intervals, Metric, QuestionScore, Summary};

use crate::bootstrap::BootstrapConfig;
use crate::recordings::{Recordings, Sureness};

/// Every metric of a run with its 95 % interval, by category and overall.
///
/// Recordings, not frames, are what varies independently. Ratios have studentised bootstrap intervals
/// (Student's quantile with fewer than ten recordings, and where almost none differs), average
/// precisions jackknife intervals. With one recording there is none.
///
/// ```
/// use jrdb_metrics::{BootstrapConfig, MetricsConfig, from_judgements, intervals};
/// let scores = from_judgements(MetricsConfig::default().protocol(), Vec::new());
/// let sure = intervals(&scores, &BootstrapConfig::default());
/// assert!(sure.overall.iter().all(|estimate| estimate.interval.is_none()));
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
        Some(Estimate { metric, value, interval, recordings, warning })
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
