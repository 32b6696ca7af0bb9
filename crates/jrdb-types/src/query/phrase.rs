//! Words that were not understood.

use serde::{Deserialize, Serialize};

use crate::issue::Span;

/// Words of the question that no condition of the algebra can express.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Phrase {
    /// The words as they stand in the question.
    pub words: String,
    /// Where they stand; absent when the query was not read from a question.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub span: Option<Span>,
}
