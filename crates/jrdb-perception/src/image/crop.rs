//! Parts of images, across the seam of a panorama.

use std::ops::Range;

use jrdb_types::{Image, ImageGeometry, PixelBox};

/// Whether the last column of an image borders on the first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wrap {
    /// A panorama: columns continue across the seam.
    Circular,
    /// An image with a left and a right border.
    Bounded,
}

impl From<ImageGeometry> for Wrap {
    fn from(image: ImageGeometry) -> Self {
        Self::of(image.wraps)
    }
}

impl Wrap {
    /// The variant for a setting `wraps`.
    pub(crate) fn of(wraps: bool) -> Self {
        if wraps { Self::Circular } else { Self::Bounded }
    }
}

/// The whole pixels that a box touches, extended by a part of its size on each side.
///
/// Columns continue across the seam of a circular image and end at the borders of a bounded one;
/// rows always end at the borders. `None` if no pixel is left.
///
/// ```
/// use jrdb_perception::image::{Wrap, crop};
/// use jrdb_types::{Image, PixelBox};
/// let image = Image::filled(100, 20, [7; 3]);
/// let across = crop(&image, &PixelBox::from([90.0, 5.0, 30.0, 40.0]), 0.0, Wrap::Circular).unwrap();
/// assert_eq!((across.width, across.height), (30, 15));
/// let below = PixelBox::from([10.0, 30.0, 5.0, 5.0]);
/// assert!(crop(&image, &below, 0.0, Wrap::Circular).is_none());
/// ```
#[must_use]
pub fn crop(image: &Image, bbox: &PixelBox, margin: f64, wrap: Wrap) -> Option<Image> {
    let (across, up) = (margin * bbox.w, margin * bbox.h);
    let rows = pixels(bbox.y - up, bbox.y + bbox.h + up, image.height, Wrap::Bounded)?;
    let columns = pixels(bbox.x - across, bbox.x + bbox.w + across, image.width, wrap)?;
    let length = |range: &Range<i64>| usize::try_from(range.end - range.start).unwrap_or(0);
    let (width, height) = (length(&columns), length(&rows));
    let rgb = rows
        .clone()
        .flat_map(|y| columns.clone().map(move |x| (x, y)))
        .flat_map(|(x, y)| image.pixel(x.rem_euclid(image.width as i64) as usize, y as usize))
        .collect();
    Some(Image { width, height, rgb })
}

/// The pixels from `low` to `high`, at most one turn.
fn pixels(low: f64, high: f64, size: usize, wrap: Wrap) -> Option<Range<i64>> {
    if !(low.is_finite() && high.is_finite()) {
        return None;
    }
    let size = size as i64;
    let (low, high) = (low.floor() as i64, high.ceil() as i64);
    let range = match wrap {
        Wrap::Circular => low..high.min(low.saturating_add(size)),
        Wrap::Bounded => low.max(0)..high.min(size),
    };
    (!range.is_empty()).then_some(range)
}
