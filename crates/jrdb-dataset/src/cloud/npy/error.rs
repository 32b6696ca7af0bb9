//! Why bytes are not an array of points.

use crate::cloud::fields::excerpt;

/// Why bytes are not an array of points.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NpyError {
    /// The bytes do not start as an `.npy` file does, or end within its header.
    #[error("expected an npy header of version 1, 2 or 3, found {found}")]
    NoHeader {
        /// What was found instead.
        found: String,
    },
    /// A part of the header is absent or not what a cloud needs.
    #[error("expected {expected} in the npy header, found {found:?}")]
    BadHeader {
        /// What the header should say.
        expected: &'static str,
        /// The header, or the part of it.
        found: String,
    },
    /// The array takes more bytes than there are.
    #[error("expected {expected} bytes for {rows} x {columns} numbers, found {found}")]
    TooShort {
        /// Bytes that the shape asks for.
        expected: u128,
        /// Points of the shape.
        rows: usize,
        /// Numbers of a point.
        columns: usize,
        /// Bytes after the header.
        found: usize,
    },
}

pub(super) fn bad(expected: &'static str, found: &str) -> NpyError {
    NpyError::BadHeader { expected, found: excerpt(found.trim_end()) }
}
