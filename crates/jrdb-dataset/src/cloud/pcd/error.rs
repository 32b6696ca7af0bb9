//! Why bytes are not a PCD file.

/// Why bytes are not a point cloud that can be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PcdError {
    /// The header ends before its `DATA` line.
    #[error("expected a pcd header with a DATA line, found {found}")]
    NoHeader {
        /// What was found instead.
        found: String,
    },
    /// A header line that is not understood.
    #[error("expected {expected} in the pcd header, found {found:?}")]
    BadHeader {
        /// What the line should say.
        expected: &'static str,
        /// The line, or the lack of it.
        found: String,
    },
    /// The points take more bytes than there are.
    #[error("expected {expected} bytes for {points} points, found {found}")]
    TooShort {
        /// Bytes that the header asks for.
        expected: u128,
        /// Points that the header states.
        points: u64,
        /// Bytes after the header.
        found: usize,
    },
    /// The compressed block does not hold what it should.
    #[error("expected an lzf block of {expected} bytes, found {found}")]
    BadCompression {
        /// Bytes that the header asks for.
        expected: usize,
        /// What the block says or gives.
        found: String,
    },
    /// A line of an ASCII cloud has a wrong number of columns, or one that is not a number.
    #[error("expected {expected} in point {point}, found {found:?}")]
    BadRow {
        /// What the line should hold.
        expected: String,
        /// Which point, from 0.
        point: usize,
        /// The line.
        found: String,
    },
    /// An ASCII cloud has another number of lines than the header states.
    #[error("expected {expected} points, found {found}")]
    WrongCount {
        /// Points that the header states.
        expected: u64,
        /// Lines found.
        found: usize,
    },
}
