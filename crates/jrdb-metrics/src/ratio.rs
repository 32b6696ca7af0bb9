//! Metrics that are a sum over questions divided by another.

use std::iter::Sum;
use std::ops::AddAssign;

use jrdb_types::score::{Metric, QuestionScore};

/// A numerator and a denominator, to be summed over questions before they are divided.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Ratio {
    pub(crate) part: f64,
    pub(crate) whole: f64,
}

impl Ratio {
    fn new(part: usize, whole: usize) -> Self {
        Self { part: part as f64, whole: whole as f64 }
    }

    /// One question of a mean.
    fn mean(part: f64) -> Self {
        Self { part, whole: 1.0 }
    }

    /// One question of a share.
    fn share(holds: bool) -> Self {
        Self::mean(if holds { 1.0 } else { 0.0 })
    }

    /// The quotient; `None` without a denominator.
    pub(crate) fn value(self) -> Option<f64> {
        (self.whole > 0.0).then(|| self.part / self.whole)
    }
}

impl AddAssign for Ratio {
    fn add_assign(&mut self, other: Self) {
        self.part += other.part;
        self.whole += other.whole;
    }
}

impl Sum for Ratio {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::default(), |mut sum, one| {
            sum += one;
            sum
        })
    }
}

/// A question's part in a metric; nothing of a metric that does not ask it, or that is no ratio.
pub(crate) fn ratio(metric: Metric, of: &QuestionScore) -> Ratio {
    match metric {
        Metric::Exact => Ratio::share(of.exact == Some(true)),
        Metric::CountError => count_error(of).map_or_else(Ratio::default, Ratio::mean),
        Metric::WordAccuracy => of.words.map_or_else(Ratio::default, Ratio::share),
        Metric::YesNoAccuracy | Metric::YesNoCoverage | Metric::YesNoRisk => yes_no(metric, of),
        _ if of.is_about_boxes() => boxes(metric, of),
        _ => Ratio::default(),
    }
}

fn boxes(metric: Metric, of: &QuestionScore) -> Ratio {
    let (right, false_positives) = (of.true_positives, of.false_positives);
    let per = |boxes: usize| if boxes == 0 { 0.0 } else { of.matched_iou / boxes as f64 };
    match metric {
        Metric::Accuracy => Ratio::share(of.is_one_to_one()),
        Metric::MiouGt => Ratio::mean(per(of.true_boxes())),
        Metric::MiouQuery => Ratio::mean(per(right)),
        Metric::MiouMatched => Ratio { part: of.matched_iou, whole: right as f64 },
        Metric::Precision => Ratio::new(right, right + false_positives),
        Metric::Recall => Ratio::new(right, of.true_boxes()),
        Metric::F1 => Ratio::new(2 * right, right + false_positives + of.true_boxes()),
        _ => Ratio::default(),
    }
}

fn count_error(of: &QuestionScore) -> Option<f64> {
    let count = of.count?;
    count.told.map(|told| told.abs_diff(count.truth) as f64)
}

fn yes_no(metric: Metric, of: &QuestionScore) -> Ratio {
    let Some(judged) = of.yes_no else { return Ratio::default() };
    let is_right = judged.told == Some(judged.truth);
    match (metric, judged.told) {
        (Metric::YesNoCoverage, told) => Ratio::share(told.is_some()),
        (Metric::YesNoRisk, None) => Ratio::default(),
        (Metric::YesNoRisk, Some(_)) => Ratio::share(!is_right),
        _ => Ratio::share(is_right),
    }
}

/// The sum over questions.
pub(crate) fn total<'a>(
    metric: Metric,
    questions: impl IntoIterator<Item = &'a QuestionScore>,
) -> Ratio {
    questions.into_iter().map(|one| ratio(metric, one)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::example::judgement;
    use jrdb_types::score::YesNoJudged;

    #[test]
    fn f1_is_the_harmonic_mean_of_precision_and_recall() {
        let of = judgement("a", 0, &[(0.9, 10), (0.8, 0), (0.7, 0), (0.3, 10)], 2);
        let value = |metric| ratio(metric, &of).value().unwrap();
        let (precision, recall) = (value(Metric::Precision), value(Metric::Recall));
        assert_eq!((precision, recall), (1.0 / 3.0, 0.25));
        assert!(
            (value(Metric::F1) - 2.0 * precision * recall / (precision + recall)).abs() < 1e-12
        );
    }

    #[test]
    fn unknown_lowers_the_coverage_and_not_the_risk() {
        let mut of = judgement("a", 0, &[], 0);
        of.yes_no = Some(YesNoJudged { truth: true, told: None });
        assert_eq!(ratio(Metric::YesNoCoverage, &of).value(), Some(0.0));
        assert_eq!(ratio(Metric::YesNoAccuracy, &of).value(), Some(0.0));
        assert_eq!(ratio(Metric::YesNoRisk, &of).value(), None);
        of.yes_no = Some(YesNoJudged { truth: true, told: Some(false) });
        assert_eq!(ratio(Metric::YesNoRisk, &of).value(), Some(1.0));
        assert_eq!(ratio(Metric::MiouGt, &of), Ratio::default());
    }
}
