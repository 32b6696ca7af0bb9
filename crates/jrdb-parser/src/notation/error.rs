//! Why a text is not notation.

use jrdb_types::Span;

/// A text that is no notation: what was expected, what stands there, and where.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("expected {expected}, found {found} at byte {}", span.start)]
pub struct NotationError {
    /// What could stand there.
    pub expected: String,
    /// What does.
    pub found: String,
    /// Where, bytes of the text.
    pub span: Span,
}
