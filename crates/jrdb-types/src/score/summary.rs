//! What the judgements of several questions sum up to.

use serde::{Deserialize, Serialize};

/// Scores of a set of questions. Ratios without a denominator are 0, average precision without a
/// true box is -1; sums of questions that were not asked are absent.
///
/// Means and boxes leave out the questions whose truth is words, yes or no without boxes.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Summary {
    /// Questions scored.
    pub questions: usize,
    /// Questions answered exactly.
    pub exact: usize,
    /// Accuracy@0.5: the share of questions whose selected boxes match the true ones one to one at
    /// IoU 0.5.
    pub accuracy: f64,
    /// Mean over questions of (sum of matched IoU / number of true boxes): the headline.
    pub miou_gt: f64,
    /// Sum of matched IoU over all questions / number of matches.
    pub miou_matched: f64,
    /// Mean over questions of (sum of matched IoU / number of matches, 0 without a match).
    pub miou_query: f64,
    /// True positives / selected boxes, over all questions, at IoU 0.5.
    pub precision: f64,
    /// True positives / true boxes, over all questions, at IoU 0.5.
    pub recall: f64,
    /// 2 TP / (2 TP + FP + FN), over all questions, at IoU 0.5: the harmonic mean of precision and
    /// recall (van Rijsbergen, "Information Retrieval", 1979).
    pub f1: f64,
    /// Average precision of the complete rankings by probability, pooled over all questions, mean
    /// over IoU 0.50, 0.55 … 0.95, with COCO's 101 points (Lin et al., "Microsoft COCO", 2014).
    pub map_ranking: f64,
    /// As `map_ranking`, at IoU 0.5 only.
    pub ap50_ranking: f64,
    /// As `map_ranking`, of the selected boxes only, all with score 1, ties in the order of
    /// questions and selections: what a method without probabilities can have.
    pub map_selection: f64,
    /// As `map_selection`, at IoU 0.5 only.
    pub ap50_selection: f64,
    /// Counting questions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub counting: Option<CountSummary>,
    /// Questions whose truth is words.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub words: Option<WordSummary>,
    /// Questions whose truth is yes or no.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub yes_no: Option<YesNoSummary>,
}

/// Scores of counting questions.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CountSummary {
    /// How many were asked.
    pub asked: usize,
    /// How many were answered with a number.
    pub told: usize,
    /// Mean of |number told - true number| over those with a number; 0 without any.
    pub count_error: f64,
}

/// Scores of questions whose truth is words.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct WordSummary {
    /// How many were asked.
    pub asked: usize,
    /// How many were answered with the words of the truth, all of them and no others.
    pub right: usize,
    /// `right / asked`: the benchmark's exact match.
    pub accuracy: f64,
}

/// Scores of questions whose truth is yes or no. Risk and coverage as in selective classification
/// (El-Yaniv and Wiener, "On the foundations of noise-free selective classification", 2010).
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct YesNoSummary {
    /// How many were asked: `right + wrong + unknown`.
    pub asked: usize,
    /// How many were answered rightly.
    pub right: usize,
    /// How many were answered wrongly.
    pub wrong: usize,
    /// How many were answered with neither yes nor no.
    pub unknown: usize,
    /// `right / asked`.
    pub accuracy: f64,
    /// `(right + wrong) / asked`: how often it says yes or no.
    pub coverage: f64,
    /// `wrong / (right + wrong)`: how often it is wrong when it does; 0 when it never does.
    pub risk: f64,
}
