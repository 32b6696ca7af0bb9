//! Parts of panoramas, across the seam.

use std::ops::Range;

use jrdb_types::{Image, PixelBox};

/// The whole pixels that a box touches, made larger by a part of its size on each side. Columns wrap around if the image does, and are
/// cut off if not; rows are cut off. None if no pixel is left.
///
/// ```
/// use jrdb_perception::crop::crop;
/// use jrdb_types::{Image, PixelBox};
/// let image = Image::filled(100, 20, [7; 3]);
/// let across = crop(&image, &PixelBox::from([90.0, 5.0, 30.0, 40.0]), 0.0, true).unwrap();
/// assert_eq!((across.width, across.height), (30, 15));
/// assert!(crop(&image, &PixelBox::from([10.0, 30.0, 5.0, 5.0]), 0.0, true).is_none());
/// ```
#[must_use]
pub fn crop(image: &Image, bbox: &PixelBox, margin: f64, wraps: bool) -> Option<Image> {
    let (across, up) = (margin * bbox.w, margin * bbox.h);
    let rows = pixels(bbox.y - up, bbox.y + bbox.h + up, image.height, false)?;
    let columns = pixels(bbox.x - across, bbox.x + bbox.w + across, image.width, wraps)?;
    let length = |range: &Range<i64>| usize::try_from(range.end - range.start).unwrap_or(0);
    let (width, height) = (length(&columns), length(&rows));
    let rgb = rows
        .clone()
        .flat_map(|y| columns.clone().map(move |x| (x, y)))
        .flat_map(|(x, y)| image.pixel(x.rem_euclid(image.width as i64) as usize, y as usize))
        .collect();
    Some(Image { width, height, rgb })
}

/// The pixels from `low` to `high`, at most once around.
fn pixels(low: f64, high: f64, size: usize, wraps: bool) -> Option<Range<i64>> {
    if !(low.is_finite() && high.is_finite()) {
        return None;
    }
    let size = size as i64;
    let (low, high) = (low.floor() as i64, high.ceil() as i64);
    let range =
        if wraps { low..high.min(low.saturating_add(size)) } else { low.max(0)..high.min(size) };
    (!range.is_empty()).then_some(range)
}
