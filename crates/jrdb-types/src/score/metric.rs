//! The metrics by name.

use serde::{Deserialize, Serialize};

use super::Summary;

/// A number of a [`Summary`]; its fields define them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Metric {
    /// Questions answered exactly / questions.
    Exact,
    /// [`Summary::accuracy`].
    Accuracy,
    /// [`Summary::miou_gt`].
    MiouGt,
    /// [`Summary::miou_matched`].
    MiouMatched,
    /// [`Summary::miou_query`].
    MiouQuery,
    /// [`Summary::precision`].
    Precision,
    /// [`Summary::recall`].
    Recall,
    /// [`Summary::f1`].
    F1,
    /// [`Summary::map_ranking`].
    MapRanking,
    /// [`Summary::ap50_ranking`].
    Ap50Ranking,
    /// [`Summary::map_selection`].
    MapSelection,
    /// [`Summary::ap50_selection`].
    Ap50Selection,
    /// [`super::CountSummary::count_error`].
    CountError,
    /// [`super::WordSummary::accuracy`].
    WordAccuracy,
    /// [`super::YesNoSummary::accuracy`].
    YesNoAccuracy,
    /// [`super::YesNoSummary::coverage`].
    YesNoCoverage,
    /// [`super::YesNoSummary::risk`].
    YesNoRisk,
}

impl Metric {
    /// Every metric, in the order of tables.
    pub const ALL: [Self; 17] = [
        Self::Exact,
        Self::Accuracy,
        Self::MiouGt,
        Self::MiouMatched,
        Self::MiouQuery,
        Self::Precision,
        Self::Recall,
        Self::F1,
        Self::MapRanking,
        Self::Ap50Ranking,
        Self::MapSelection,
        Self::Ap50Selection,
        Self::CountError,
        Self::WordAccuracy,
        Self::YesNoAccuracy,
        Self::YesNoCoverage,
        Self::YesNoRisk,
    ];

    /// Its name, as in JSON.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Accuracy => "accuracy",
            Self::MiouGt => "miou_gt",
            Self::MiouMatched => "miou_matched",
            Self::MiouQuery => "miou_query",
            Self::Precision => "precision",
            Self::Recall => "recall",
            Self::F1 => "f1",
            Self::MapRanking => "map_ranking",
            Self::Ap50Ranking => "ap50_ranking",
            Self::MapSelection => "map_selection",
            Self::Ap50Selection => "ap50_selection",
            Self::CountError => "count_error",
            Self::WordAccuracy => "word_accuracy",
            Self::YesNoAccuracy => "yes_no_accuracy",
            Self::YesNoCoverage => "yes_no_coverage",
            Self::YesNoRisk => "yes_no_risk",
        }
    }

    /// Its value; absent where no question can tell it.
    #[must_use]
    pub fn of(self, summary: &Summary) -> Option<f64> {
        let s = summary;
        let has_truth = |ap: f64| (ap >= 0.0).then_some(ap);
        match self {
            Self::Exact => (s.questions > 0).then(|| s.exact as f64 / s.questions as f64),
            Self::Accuracy => Some(s.accuracy),
            Self::MiouGt => Some(s.miou_gt),
            Self::MiouMatched => Some(s.miou_matched),
            Self::MiouQuery => Some(s.miou_query),
            Self::Precision => Some(s.precision),
            Self::Recall => Some(s.recall),
            Self::F1 => Some(s.f1),
            Self::MapRanking => has_truth(s.map_ranking),
            Self::Ap50Ranking => has_truth(s.ap50_ranking),
            Self::MapSelection => has_truth(s.map_selection),
            Self::Ap50Selection => has_truth(s.ap50_selection),
            Self::CountError => s.counting.filter(|c| c.told > 0).map(|c| c.count_error),
            Self::WordAccuracy => s.words.map(|w| w.accuracy),
            Self::YesNoAccuracy => s.yes_no.map(|y| y.accuracy),
            Self::YesNoCoverage => s.yes_no.map(|y| y.coverage),
            Self::YesNoRisk => s.yes_no.filter(|y| y.right + y.wrong > 0).map(|y| y.risk),
        }
    }

    /// Least and greatest possible value.
    #[must_use]
    pub const fn range(self) -> [f64; 2] {
        match self {
            Self::CountError => [0.0, f64::INFINITY],
            _ => [0.0, 1.0],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_json() {
        for metric in Metric::ALL {
            assert_eq!(serde_json::to_value(metric).unwrap(), metric.name());
        }
    }

    #[test]
    fn what_nobody_asked_has_no_value() {
        let nothing = Summary { map_ranking: -1.0, ..Summary::default() };
        for metric in [Metric::Exact, Metric::MapRanking, Metric::CountError, Metric::YesNoRisk] {
            assert_eq!(metric.of(&nothing), None);
        }
    }
}
