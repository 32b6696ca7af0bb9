//! Memory that reading one file after the other uses again.

/// A file's bytes, and what of them was compressed.
#[derive(Debug, Clone, Default)]
pub(super) struct Buffers {
    /// A file's bytes, or a piece of them.
    pub(super) bytes: Vec<u8>,
    /// What was compressed.
    pub(super) block: Vec<u8>,
}
