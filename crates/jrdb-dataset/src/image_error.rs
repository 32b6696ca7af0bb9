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
    /// The header states another size than the one that the picture must have.
    #[error("expected an image of {expected:?} px as in the calibration, found {found:?}")]
    OtherSize {
        /// Columns and rows of the camera.
        expected: [usize; 2],
        /// Columns and rows of the picture.
        found: [usize; 2],
    },
    /// Viewers turn or mirror the picture as EXIF says; its boxes and calibration would not fit.
    #[error(
        "expected an upright picture, found EXIF orientation {orientation}, which turns or mirrors \
         it: write the pixels upright, as `mogrify -auto-orient FILE` does"
    )]
    Turned {
        /// EXIF's number, from 2 to 8.
        orientation: u16,
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

impl ImageError {
    /// A maker of [`ImageError::Malformed`] for `map_err`.
    pub(crate) fn malformed<E>(format: &'static str) -> impl FnOnce(E) -> Self
    where
        E: Into<Box<dyn std::error::Error + Send + Sync>>,
    {
        move |source| Self::Malformed { format, source: source.into() }
    }
}
