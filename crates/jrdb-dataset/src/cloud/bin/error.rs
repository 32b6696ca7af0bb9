//! Why bytes are not points without a header.

use super::layout::BinLayout;

/// Why bytes are not points of a layout.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BinError {
    /// The length is not that of whole points.
    #[error("expected a multiple of {} bytes ({expected}), found {found} bytes{}", .expected.row_bytes(), hint(*.fits))]
    Length {
        /// Layout that was asked for.
        expected: BinLayout,
        /// Bytes found.
        found: usize,
        /// The layout of whose points the bytes are a whole number.
        fits: Option<BinLayout>,
    },
    /// The length is not that of whole points of the columns that were stated.
    #[error("expected a multiple of {expected} bytes ({columns} as stated), found {found} bytes")]
    Stated {
        /// Bytes of a point.
        expected: usize,
        /// The columns that were stated.
        columns: String,
        /// Bytes found.
        found: usize,
    },
    /// The numbers are not those of points.
    #[error(
        "expected {expected} as 4-byte floats, found {percent} % of numbers that no LiDAR gives; if the \
         file has other columns, state them"
    )]
    NotFloats {
        /// Layout that was asked for.
        expected: BinLayout,
        /// Part of the numbers that are too large or too small, percent.
        percent: u32,
    },
    /// A text that names no columns.
    #[error("expected columns such as x,y,z,intensity,ring or x:f64,y:f64,z:f64, found {found:?}")]
    Columns {
        /// The text.
        found: String,
    },
}

fn hint(fits: Option<BinLayout>) -> String {
    let name = |layout| if layout == BinLayout::Kitti { ".bin" } else { ".pcd.bin" };
    fits.map_or_else(String::new, |layout| {
        format!("; they are whole points of {layout}, whose files end in {}", name(layout))
    })
}
