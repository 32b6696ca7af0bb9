//! One camera's view of a frame.

use jrdb_types::{Image, ImageGeometry};

/// One camera's view of a frame.
#[derive(Debug, Clone, Copy)]
pub struct View<'a> {
    /// Size of the camera's images and whether they wrap.
    pub geometry: ImageGeometry,
    /// The pixels; absent when they cannot be read, or when perception does not look at them.
    pub image: Option<&'a Image>,
}
