//! What the sensors gave at one moment.

use std::fmt;
use std::sync::OnceLock;

use jrdb_types::{FrameId, Image, Issue, PointCloud};

/// What the sensors gave at one moment: images, sweeps, and what of them is missing.
///
/// ```
/// use jrdb_pipeline::Frame;
/// use jrdb_types::{FrameId, Image};
///
/// let id = FrameId { sequence: "lab".into(), frame: 0 };
/// let frame = Frame::new(id, Image::filled(3760, 480, [90; 3]), Vec::new());
/// assert_eq!(frame.images.len(), 1);
/// ```
#[derive(Debug, Default)]
#[non_exhaustive]
pub struct Frame {
    /// Which frame.
    pub id: FrameId,
    /// Images, each from one camera. The pipeline uses the first.
    pub images: Vec<CameraImage>,
    /// One sweep per LiDAR, in the sensors' frames.
    pub sweeps: Vec<PointCloud>,
    /// What is missing of the sweeps.
    pub issues: Vec<Issue>,
}

impl Frame {
    /// A frame with one image and some sweeps.
    #[must_use]
    pub fn new(id: FrameId, image: Image, sweeps: Vec<PointCloud>) -> Self {
        Self { id, images: vec![CameraImage::ready(image)], sweeps, issues: Vec::new() }
    }

    /// A frame without an image: perception must not need one.
    #[must_use]
    pub fn without_image(id: FrameId, sweeps: Vec<PointCloud>) -> Self {
        Self { id, sweeps, ..Self::default() }
    }

    /// Decodes all images now, so that trouble with them is known.
    pub fn decode(&self) {
        for image in &self.images {
            let _ = image.pixels();
        }
    }

    /// The pixels of the first image, decoded now if they have not been; `None` when there are none.
    #[must_use]
    pub fn pixels(&self) -> Option<&Image> {
        self.images.first().and_then(|image| image.pixels().ok())
    }
}

/// An image with what there is to remark about it, or why there is none.
type Loaded = Result<(Image, Option<Issue>), Issue>;
type Load = Box<dyn Fn() -> Loaded + Send + Sync>;

/// One camera's image, decoded when it is first needed.
pub struct CameraImage {
    /// Which camera of the rig; the camera in use when absent.
    pub camera: Option<String>,
    decoded: OnceLock<Loaded>,
    load: Load,
}

impl CameraImage {
    /// An image that is there.
    #[must_use]
    pub fn ready(image: Image) -> Self {
        Self::known(Ok((image, None)))
    }

    /// An image that `load` reads when something needs its pixels, at most once. A remark about it is an issue that
    /// comes beside the pixels.
    #[must_use]
    pub fn on_demand(
        load: impl Fn() -> Result<(Image, Option<Issue>), Issue> + Send + Sync + 'static,
    ) -> Self {
        Self { camera: None, decoded: OnceLock::new(), load: Box::new(load) }
    }

    /// An image that should be there and cannot be used.
    #[must_use]
    pub fn missing(why: Issue) -> Self {
        Self::known(Err(why))
    }

    /// An image with what there is to remark about it, or why there is none.
    #[must_use]
    pub fn known(loaded: Result<(Image, Option<Issue>), Issue>) -> Self {
        // Never called: the pixels are there.
        let load = Box::new(|| Ok((Image::filled(0, 0, [0; 3]), None)));
        Self { camera: None, decoded: OnceLock::from(loaded), load }
    }

    /// The pixels.
    ///
    /// # Errors
    /// The issue that says why there are none.
    pub fn pixels(&self) -> Result<&Image, &Issue> {
        self.decoded.get_or_init(&self.load).as_ref().map(|(image, _)| image)
    }

    /// Why there are no pixels, or what there is to remark about them, as far as that is known without decoding.
    #[must_use]
    pub fn known_issue(&self) -> Option<&Issue> {
        match self.decoded.get()? {
            Ok((_, remark)) => remark.as_ref(),
            Err(issue) => Some(issue),
        }
    }
}

impl fmt::Debug for CameraImage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let state = match self.decoded.get() {
            Some(Ok(_)) => "decoded",
            Some(Err(_)) => "missing",
            None => "not decoded yet",
        };
        f.debug_struct("CameraImage").field("camera", &self.camera).field("pixels", &state).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn an_image_is_decoded_when_it_is_needed_and_once() {
        let count = Arc::new(AtomicUsize::new(0));
        let counted = Arc::clone(&count);
        let image = CameraImage::on_demand(move || {
            counted.fetch_add(1, Ordering::Relaxed);
            Ok((Image::filled(2, 1, [7; 3]), None))
        });
        assert!(image.known_issue().is_none() && count.load(Ordering::Relaxed) == 0);
        assert!(image.pixels().is_ok() && image.pixels().is_ok());
        assert_eq!(count.load(Ordering::Relaxed), 1);
    }
}
