//! Pixels: resizing, cropping, and conversion to the tensors that models take.

mod crop;
mod picture;
mod resize;
mod tensor;

pub use crop::{Wrap, crop};
pub use picture::{PictureConfig, PictureSize};
pub use resize::{Filter, Region, Resizer, resize};
pub use tensor::{Layout, Normalise};
