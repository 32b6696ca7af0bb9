//! Whether a question has an answer, and why it has none.

use serde::{Deserialize, Serialize};

use crate::id::EntityId;
use crate::issue::Span;

/// Whether a question could be answered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// The reply is an answer.
    #[default]
    Answered,
    /// No candidate satisfies the question. The selection holds the nearest ones, which are not an answer.
    Nearest,
    /// It cannot be determined; [`crate::Answer::because`] gives the causes. The selection holds the best guess,
    /// which is not an answer.
    Unknown,
    /// The text holds neither a target nor a form of question.
    NotUnderstood,
}

impl Status {
    /// Whether the question is open: nothing can be concluded from the reply.
    #[must_use]
    pub const fn is_open(self) -> bool {
        matches!(self, Self::Unknown | Self::NotUnderstood)
    }
}

/// Where the cause of an open answer lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum CauseKind {
    /// Words of the question were not understood.
    Word,
    /// Perception cannot see what is asked, or did not see it of these candidates.
    Perception,
    /// A sensor's data is missing or unusable.
    Sensor,
    /// A label file is missing or unusable.
    Label,
}

/// Why a question could not be answered.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Cause {
    /// Where it lies.
    pub kind: CauseKind,
    /// What it is, for a person to read; names files without host paths.
    pub message: String,
    /// The words concerned.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub span: Option<Span>,
}

/// A candidate that may be meant: nothing that is known excludes it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Possible {
    /// Which candidate.
    pub id: EntityId,
    /// Probability that it satisfies the question, in `[0, 1]`, as far as it can be stated.
    pub probability: f64,
}

/// A number of things, or the bounds that it lies between. As JSON a number, or
/// `{"at_least": 2, "at_most": 5}`; without `at_most` there is no upper bound.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(untagged)]
pub enum Count {
    /// Exactly so many.
    Exact(usize),
    /// Between two numbers.
    Between {
        /// At least so many.
        at_least: usize,
        /// At most so many.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        at_most: Option<usize>,
    },
}

impl Count {
    /// The number between two bounds.
    #[must_use]
    pub fn between(at_least: usize, at_most: Option<usize>) -> Self {
        if at_most == Some(at_least) {
            Self::Exact(at_least)
        } else {
            Self::Between { at_least, at_most }
        }
    }

    /// The number, if it is known.
    #[must_use]
    pub const fn exact(self) -> Option<usize> {
        match self {
            Self::Exact(number) => Some(number),
            Self::Between { .. } => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_known_number_is_a_number_and_others_are_bounds() {
        let json = |count: Count| serde_json::to_string(&count).unwrap();
        assert_eq!(json(Count::between(2, Some(2))), "2");
        assert_eq!(json(Count::between(2, Some(5))), r#"{"at_least":2,"at_most":5}"#);
        assert_eq!(json(Count::between(0, None)), r#"{"at_least":0}"#);
        for count in [Count::Exact(3), Count::between(1, None)] {
            assert_eq!(serde_json::from_str::<Count>(&json(count)).unwrap(), count);
        }
    }
}
