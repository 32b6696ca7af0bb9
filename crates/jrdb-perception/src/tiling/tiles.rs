//! Upright tiles over a panorama: as high as the image, overlapping, going on across the seam.

use jrdb_types::{Image, ImageGeometry, PixelBox};

use crate::image::Region;

/// A part of an image: all rows, `width_px` columns from `x_px` on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tile {
    /// First column, in `[0, W)`.
    pub x_px: u32,
    /// Number of columns, at most `W`; in a wrapping image the tile may go on at column 0.
    pub width_px: u32,
}

/// Tiles of one width that cover the image, from left to right.
///
/// Neighbours share at least the part `overlap` in `[0, 1)` of their width. In a wrapping image of
/// `W` columns everything up to `overlap · width - 1` pixels wide therefore lies whole in some
/// tile, wherever it is; without wrapping the first and last tile end at the image's borders.
///
/// ```
/// use jrdb_perception::tiling::tiles;
/// use jrdb_types::ImageGeometry;
/// let panorama = ImageGeometry { width_px: 400, height_px: 100, wraps: true };
/// let starts: Vec<u32> = tiles(panorama, 200, 0.5).iter().map(|t| t.x_px).collect();
/// assert_eq!(starts, [0, 100, 200, 300]); // the last one covers the seam
/// ```
#[must_use]
pub fn tiles(image: ImageGeometry, width_px: u32, overlap: f64) -> Vec<Tile> {
    let width_px = width_px.clamp(1, image.width_px.max(1));
    let stride = (f64::from(width_px) * (1.0 - overlap)).max(1.0);
    // On a circle as many tiles as steps; on a strip one more, since the last one ends at the
    // border.
    let (span_px, fewest, closing) = match image.wraps {
        true => (image.width_px, 1, 0),
        false => (image.width_px.saturating_sub(width_px), 0, 1),
    };
    let steps = ((f64::from(span_px) / stride).ceil() as u32).max(fewest);
    let start_px = |i: u32| u64::from(i) * u64::from(span_px) / u64::from(steps.max(1));
    (0..steps + closing).map(|i| Tile { x_px: start_px(i) as u32, width_px }).collect()
}

impl Tile {
    /// The rectangle of the image that the tile shows.
    #[must_use]
    pub fn region(&self, image: &Image) -> Region {
        let (x_px, width_px) = (self.x_px as usize, self.width_px as usize);
        Region { x_px, width_px, ..Region::whole(image) }
    }

    /// The tile's picture.
    ///
    /// # Panics
    /// When the tile was made for an image of another size, or the image has fewer bytes than its
    /// size requires.
    #[must_use]
    pub fn crop(&self, image: &Image) -> Image {
        let (x, width) = (self.x_px as usize, self.width_px as usize);
        let before_seam = width.min(image.width - x);
        let mut rgb = Vec::with_capacity(3 * width * image.height);
        for row in image.rgb.chunks_exact(3 * image.width) {
            rgb.extend(&row[3 * x..3 * (x + before_seam)]);
            rgb.extend(&row[..3 * (width - before_seam)]);
        }
        Image { width, height: image.height, rgb }
    }

    /// Whether a box, in pixels of the tile, comes closer than `margin_px` to a border behind which
    /// the image goes on: it may be the part of something that a neighbouring tile shows whole.
    #[must_use]
    pub fn cuts(&self, bbox: &PixelBox, margin_px: f64, image: ImageGeometry) -> bool {
        let goes_on_left = image.wraps || self.x_px > 0;
        let goes_on_right = image.wraps || self.x_px + self.width_px < image.width_px;
        let right_px = f64::from(self.width_px) - (bbox.x + bbox.w);
        (goes_on_left && bbox.x < margin_px) || (goes_on_right && right_px < margin_px)
    }

    /// A box in pixels of the tile as a box in pixels of the image.
    #[must_use]
    pub fn to_image(&self, bbox: PixelBox, image: ImageGeometry) -> PixelBox {
        let moved = PixelBox { x: bbox.x + f64::from(self.x_px), ..bbox };
        image.period_px().map_or(moved, |period_px| moved.wrapped(period_px))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn geometry(width_px: u32, wraps: bool) -> ImageGeometry {
        ImageGeometry { width_px, height_px: 10, wraps }
    }

    /// Columns with distinct numbers.
    fn striped(width: usize) -> Image {
        Image { width, height: 1, rgb: (0..width).flat_map(|x| [x as u8; 3]).collect() }
    }

    #[test]
    fn a_tile_across_the_seam_goes_on_at_column_0() {
        let crop = Tile { x_px: 4, width_px: 3 }.crop(&striped(6));
        assert_eq!(crop.rgb, [4, 4, 4, 5, 5, 5, 0, 0, 0]);
    }

    #[test]
    fn a_box_is_cut_at_inner_borders_only() {
        let (tile, bbox) =
            (Tile { x_px: 0, width_px: 100 }, PixelBox::from([0.0, 0.0, 20.0, 10.0]));
        assert!(!tile.cuts(&bbox, 1.0, geometry(300, false)));
        assert!(tile.cuts(&bbox, 1.0, geometry(300, true)));
        assert!(tile.cuts(&PixelBox { x: 80.0, ..bbox }, 1.0, geometry(300, false)));
        assert!(!tile.cuts(&PixelBox { x: 40.0, ..bbox }, 1.0, geometry(300, true)));
    }

    #[test]
    fn a_small_photograph_is_one_tile() {
        assert_eq!(tiles(geometry(200, false), 320, 0.5), [Tile { x_px: 0, width_px: 200 }]);
    }

    proptest! {
        #[test]
        fn every_column_is_covered(width in 1_u32..4000, tile in 1_u32..1000, overlap in 0.0..0.9, wraps: bool) {
            let image = geometry(width, wraps);
            let mut seen = vec![false; width as usize];
            for t in tiles(image, tile, overlap) {
                prop_assert!(t.x_px < width && (wraps || t.x_px + t.width_px <= width));
                (t.x_px..t.x_px + t.width_px).for_each(|x| seen[(x % width) as usize] = true);
            }
            prop_assert!(seen.iter().all(|s| *s));
        }

        #[test]
        fn a_person_narrower_than_the_overlap_lies_whole_in_some_tile(
            x in 0.0..3760.0, part in 0.0..1.0, wraps: bool, tile in prop::sample::select(vec![320_u32, 640]),
        ) {
            let (image, overlap, margin_px) = (geometry(3760, wraps), 0.75, 0.01 * f64::from(tile));
            let widest = overlap * f64::from(tile) - 2.0 * margin_px - 1.0;
            let person = PixelBox::from([x, 0.0, part * widest, 10.0]);
            prop_assume!(wraps || person.x + person.w <= 3760.0);
            let whole = |t: &Tile| {
                let start = person.x - f64::from(t.x_px);
                let start = if wraps { start.rem_euclid(3760.0) } else { start };
                let inside = PixelBox { x: start, ..person };
                start >= 0.0 && start + person.w <= f64::from(tile) && !t.cuts(&inside, margin_px, image)
            };
            prop_assert!(tiles(image, tile, overlap).iter().any(whole));
        }

        #[test]
        fn boxes_keep_their_pixels(x in 0_u32..300, at in 0_u32..100) {
            let (image, tile) = (striped(256), Tile { x_px: x % 256, width_px: 100 });
            let bbox = PixelBox::from([f64::from(at), 0.0, 1.0, 1.0]);
            let there = tile.to_image(bbox, geometry(256, true));
            prop_assert_eq!(image.pixel(there.x as usize, 0), tile.crop(&image).pixel(at as usize, 0));
        }
    }
}
