//! Why a text is not notation.

use jrdb_types::Span;

/// A text that is not notation: what was expected, what was found, and where.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("expected {expected}, found {found} at byte {}", span.start)]
pub struct NotationError {
    /// What was expected.
    pub expected: String,
    /// What was found.
    pub found: String,
    /// The bytes of the text where it was found.
    pub span: Span,
}
