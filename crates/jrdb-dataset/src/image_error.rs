//! Why a file is not a picture.

/// Why bytes are not a picture that can be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// Neither PNG nor JPEG.
    #[error("expected a png or jpeg, found a file that starts with {found:02x?}")]
    UnknownFormat {
        /// The first bytes, at most eight.
        found: Vec<u8>,
    },
    /// The header states a size that is too large to decode or impossible for the number of bytes.
    #[error("expected at most {limit} pixels, found a header that states {width} x {height}")]
    TooLarge {
        /// Pixels allowed for a file of this length.
        limit: u64,
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// The bytes break off or contradict themselves, or use a variant that is not supported.
    #[error("expected a well-formed {format}")]
    Malformed {
        /// `png` or `jpeg`.
        format: &'static str,
        /// What is wrong.
        #[source]
        source: Box<dyn std::error::Error + Send + Sync>,
    },
}
