//! How points are stored.

/// How the points of a PCD file are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Encoding {
    /// One line of numbers for each point.
    Ascii,
    /// Little-endian numbers, point after point.
    Binary,
    /// Little-endian numbers, field after field, compressed with LZF. JRDB's own.
    BinaryCompressed,
}
