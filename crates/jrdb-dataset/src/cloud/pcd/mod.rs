//! Point clouds in the PCD format (versions .5, .6 and .7): ASCII, binary and LZF-compressed.

mod decode;
mod encoding;
mod error;
mod header;
mod lzf;
mod stream;
mod write;

pub(super) use decode::fill;
pub use decode::parse;
pub use encoding::Encoding;
pub use error::PcdError;
pub(super) use stream::read;
pub use write::write;
