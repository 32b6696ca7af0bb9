//! Trouble that is part of the data: something was left out or not understood, and the rest went on.

use serde::{Deserialize, Serialize};

use crate::id::EntityId;

/// What kind of trouble.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum IssueKind {
    /// A file of the frame is absent or unreadable; what depends on it is absent too.
    MissingInput,
    /// A label file of the sequence is absent; what it holds is unknown.
    MissingLabels,
    /// A file of the frame is odd but was used; the message says what is odd and how it was taken.
    DoubtfulInput,
    /// An object of a label file could not be used.
    BadLabel,
    /// A model could not describe a person: its attributes are unknown.
    NotDescribed,
    /// A box lies outside the image or has no area.
    BadBox,
    /// Points without a finite position were skipped.
    SkippedPoints,
    /// No LiDAR point of the box: the thing has no position.
    NoPoints,
    /// Too few points for a trustworthy position.
    FewPoints,
    /// The heading is unknown: the person has no left and right.
    NoHeading,
    /// A word of the query was not understood and not used.
    UnknownWord,
    /// A word is known but fits nowhere where it stands; it was not used.
    MisplacedWord,
    /// A word was read as the known one that is one edit away.
    MisspelledWord,
    /// The query is written in the notation, and does not fit together.
    BadNotation,
    /// A phrase could be read in more than one way; the message says which way was taken.
    Ambiguous,
    /// The text holds neither a target nor a form of question.
    NotUnderstood,
    /// The query asks for something that this scene graph cannot hold.
    NotInGraph,
}

impl IssueKind {
    /// Whether a part of the input is lost: a file of the frame or of its labels, or an object in one.
    #[must_use]
    pub const fn loses_input(self) -> bool {
        matches!(self, Self::MissingInput | Self::MissingLabels | Self::BadLabel | Self::BadBox)
    }
}

/// A stretch of the query text, in bytes, end exclusive.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Span {
    /// First byte.
    pub start: usize,
    /// One past the last byte.
    pub end: usize,
}

/// One piece of trouble.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Issue {
    /// What kind.
    pub kind: IssueKind,
    /// What happened, for a person to read; names files without host paths.
    pub message: String,
    /// The thing concerned.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub subject: Option<EntityId>,
    /// The words concerned.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub span: Option<Span>,
    /// What was probably meant.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub suggestion: Option<String>,
}

impl Issue {
    /// Trouble that concerns the whole input.
    #[must_use]
    pub fn new(kind: IssueKind, message: impl Into<String>) -> Self {
        Self { kind, message: message.into(), subject: None, span: None, suggestion: None }
    }

    /// Trouble with one thing.
    #[must_use]
    pub fn about(kind: IssueKind, subject: &EntityId, message: impl Into<String>) -> Self {
        Self { subject: Some(subject.clone()), ..Self::new(kind, message) }
    }

    /// Trouble with some words of the query.
    #[must_use]
    pub fn at(kind: IssueKind, span: Span, message: impl Into<String>) -> Self {
        Self { span: Some(span), ..Self::new(kind, message) }
    }
}
