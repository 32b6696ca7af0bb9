//! Clouds in the PLY format (Stanford's polygon format 1.0): ASCII and binary of both byte orders.

mod decode;
mod error;
mod header;

pub(super) use decode::fill;
pub use decode::parse;
pub use error::PlyError;
