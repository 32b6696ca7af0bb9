//! A picture that was decoded.

use jrdb_types::Image;

/// A picture, with what a reader should know about it.
#[derive(Debug, Clone, PartialEq)]
pub struct Decoded {
    /// The pixels.
    pub image: Image,
    /// Why the pixels are not quite what the file should hold, where that is so.
    pub remark: Option<String>,
}

impl Decoded {
    pub(super) fn new([width, height]: [usize; 2], rgb: Vec<u8>, remark: Option<String>) -> Self {
        Self { image: Image { width, height, rgb }, remark }
    }
}
