//! What perception looks at.

use jrdb_types::issue::IssueKind;
use jrdb_types::{Image, ImageGeometry, Issue};

/// One camera's view of a frame.
#[derive(Debug, Clone, Copy)]
pub struct View<'a> {
    /// Size of the camera's images and whether they wrap.
    pub geometry: ImageGeometry,
    /// The pixels; absent when they cannot be read, or when perception does not look at them.
    pub image: Option<&'a Image>,
}

impl View<'_> {
    /// The pixels, for a model that cannot do without.
    ///
    /// # Errors
    /// An issue where there are none.
    pub fn pixels(&self) -> Result<&Image, Issue> {
        let why = "the model had no picture to look at";
        self.image.ok_or_else(|| Issue::new(IssueKind::MissingInput, why))
    }
}
