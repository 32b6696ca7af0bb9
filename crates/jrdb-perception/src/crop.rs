//! A box of a panorama as a picture of its own.

use jrdb_types::{Image, PixelBox};

/// The part of the image that a box covers, to whole pixels; on a circle of columns where the image wraps. Nothing where the
/// box has no pixel in the image.
pub(crate) fn crop(image: &Image, bbox: &PixelBox, wraps: bool) -> Option<Image> {
    let (top, bottom) = span(bbox.y, bbox.h, image.height, false)?;
    let (left, right) = span(bbox.x, bbox.w, image.width, wraps)?;
    let column = |x: i64| x.rem_euclid(image.width as i64) as usize;
    let columns: Vec<usize> = (left..right).map(column).collect();
    let mut rgb = Vec::with_capacity(3 * columns.len() * (bottom - top) as usize);
    for y in top..bottom {
        for &x in &columns {
            rgb.extend(image.pixel(x, y as usize));
        }
    }
    Some(Image { width: columns.len(), height: (bottom - top) as usize, rgb })
}

/// First pixel and one past the last; on a circle at most one turn, else inside the image.
fn span(start: f64, length: f64, size: usize, wraps: bool) -> Option<(i64, i64)> {
    let (from, to) = (start.round() as i64, (start + length).round() as i64);
    let size = i64::try_from(size).ok()?;
    let (from, to) = match wraps {
        true => (from, to.min(from.saturating_add(size))),
        false => (from.clamp(0, size), to.clamp(0, size)),
    };
    (from < to && start.is_finite() && length.is_finite()).then_some((from, to))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn striped() -> Image {
        Image { width: 6, height: 2, rgb: (0..12).flat_map(|i| [i; 3]).collect() }
    }

    #[test]
    fn a_box_across_the_seam_goes_on_at_column_0_and_ends_at_the_last_row() {
        let bbox = PixelBox::from([4.6, 1.0, 2.0, 9.0]);
        assert_eq!(crop(&striped(), &bbox, true).unwrap().rgb, [11, 11, 11, 6, 6, 6]);
        assert_eq!(crop(&striped(), &bbox, false).unwrap().rgb, [11, 11, 11]);
    }

    #[test]
    fn what_is_outside_or_no_box_gives_nothing() {
        for bbox in [[1.0, 5.0, 2.0, 2.0], [1.0, 0.0, 0.2, 1.0], [f64::NAN, 0.0, 2.0, 2.0]] {
            assert_eq!(crop(&striped(), &PixelBox::from(bbox), true), None);
        }
        let endless = PixelBox::from([0.0, 0.0, f64::INFINITY, 1.0]);
        assert_eq!(crop(&striped(), &endless, true), None);
    }
}
