//! One question's answer, judged against its truth: all that scores need, without boxes.

use serde::{Deserialize, Serialize};

use crate::answer::{Reply, Status};
use crate::id::FrameId;

/// At which of COCO's ten IoU thresholds a candidate matches a true box; as JSON a number whose bit
/// 0 stands for IoU 0.50, bit 1 for 0.55 … bit 9 for 0.95.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(transparent)]
pub struct MatchMask(u16);

impl MatchMask {
    /// How many thresholds there are.
    pub const THRESHOLDS: usize = 10;

    /// It matches at the thresholds with these indices; others than 0 to 9 do not count.
    ///
    /// ```
    /// use jrdb_types::score::MatchMask;
    /// let mask = MatchMask::of([0, 2]);
    /// assert!(mask.at(2) && !mask.at(1));
    /// ```
    #[must_use]
    pub fn of(thresholds: impl IntoIterator<Item = usize>) -> Self {
        let known = thresholds.into_iter().filter(|&index| index < Self::THRESHOLDS);
        Self(known.fold(0, |mask, index| mask | 1 << index))
    }

    /// Whether it matches at the threshold with this index.
    #[must_use]
    pub const fn at(self, threshold: usize) -> bool {
        threshold < Self::THRESHOLDS && self.0 >> threshold & 1 == 1
    }
}

/// A candidate of an answer's ranking, judged.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Candidate {
    /// What it is ranked by: its probability.
    pub score: f64,
    /// At which thresholds it matches a true box that no better candidate has taken.
    pub matches: MatchMask,
}

/// In which form an answer was given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum ReplyKind {
    /// Things, by their boxes.
    Things,
    /// A number.
    Number,
    /// Yes or no.
    YesNo,
    /// Words: values of properties, or places.
    Told,
}

impl ReplyKind {
    /// The form of a reply.
    #[must_use]
    pub const fn of(reply: &Reply) -> Self {
        match reply {
            Reply::Things => Self::Things,
            Reply::Number(_) => Self::Number,
            Reply::YesNo(_) => Self::YesNo,
            Reply::Properties(_) => Self::Told,
        }
    }
}

/// A number that was asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CountJudged {
    /// How many there are.
    pub truth: usize,
    /// How many the answer says there are; absent when it does not say one number.
    #[serde(default)]
    pub told: Option<usize>,
}

/// Yes or no, where that was asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct YesNoJudged {
    /// What is the case.
    pub truth: bool,
    /// What the answer says; absent when it says neither.
    #[serde(default)]
    pub told: Option<bool>,
}

/// One question's judgement.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct QuestionScore {
    /// The frame.
    pub frame: FrameId,
    /// The question's name in its file, where it has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub question_id: Option<String>,
    /// The question's words.
    pub question: String,
    /// The question's category.
    pub category: String,
    /// The status of the answer; absent when there is no answer.
    #[serde(default)]
    pub status: Option<Status>,
    /// The form of the answer; absent when there is no answer.
    #[serde(default)]
    pub reply: Option<ReplyKind>,
    /// Whether the answer is exactly the truth: the number, yes or no, the words, where the truth
    /// has one; else the ids as sets; where the truth has boxes without ids, the boxes one to one.
    #[serde(default)]
    pub exact: Option<bool>,
    /// True boxes with a selected box of at least the protocol's IoU.
    pub true_positives: usize,
    /// Selected things without a true box.
    pub false_positives: usize,
    /// True boxes without a selected box.
    pub false_negatives: usize,
    /// Sum of the IoU of the matched boxes.
    pub matched_iou: f64,
    /// The ranking, best first, at most COCO's 100 candidates.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ranking: Vec<Candidate>,
    /// The boxes of the selection in its order, at most COCO's 100, as candidates of equal score.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub selection: Vec<MatchMask>,
    /// The number, where the truth has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub count: Option<CountJudged>,
    /// Yes or no, where the truth has it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub yes_no: Option<YesNoJudged>,
    /// Whether the words told are those of the truth, where the truth has words.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub words: Option<bool>,
}

impl QuestionScore {
    /// How many boxes the truth has.
    #[must_use]
    pub const fn true_boxes(&self) -> usize {
        self.true_positives + self.false_negatives
    }

    /// Whether boxes are what the truth consists of: not so of yes, no and words without boxes.
    #[must_use]
    pub const fn is_about_boxes(&self) -> bool {
        self.true_boxes() > 0 || (self.yes_no.is_none() && self.words.is_none())
    }

    /// Whether there is an answer, and its boxes match those of the truth one to one.
    #[must_use]
    pub const fn is_one_to_one(&self) -> bool {
        self.status.is_some() && self.false_positives == 0 && self.false_negatives == 0
    }

    /// How the question is told from others of its frame: its name, else its words.
    #[must_use]
    pub fn name(&self) -> &str {
        self.question_id.as_deref().unwrap_or(&self.question)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mask_is_a_number_in_json() {
        let mask = MatchMask::of([0, 1, 9, 12]);
        assert_eq!(serde_json::to_string(&mask).unwrap(), "515");
        let back: MatchMask = serde_json::from_str("515").unwrap();
        assert!(back == mask && back.at(9) && !back.at(8) && !back.at(12));
    }
}
