//! Why bytes are not a PLY file with points.

/// Why bytes are not a point cloud that can be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PlyError {
    /// The bytes do not start as a PLY file does, or end within its header.
    #[error("expected a ply header, found {found}")]
    NoHeader {
        /// What was found instead.
        found: &'static str,
    },
    /// A header line that is not understood.
    #[error("expected {expected} in the ply header, found {found:?}")]
    BadHeader {
        /// What the line should say.
        expected: &'static str,
        /// The line, or the lack of it.
        found: String,
    },
    /// There are fewer things of a kind than the header states.
    #[error("expected {expected} of element {element:?}, found the end of the file after {found}")]
    TooShort {
        /// Name of the element.
        element: String,
        /// How many the header states.
        expected: u64,
        /// How many are there.
        found: u64,
    },
    /// A line of an ASCII cloud that is not a point.
    #[error("expected {expected} in point {point}, found {found:?}")]
    BadRow {
        /// What the line should hold.
        expected: String,
        /// Which point, from 0.
        point: u64,
        /// The line.
        found: String,
    },
}
