//! Resampling of 8-bit pictures, equal to Pillow's byte for byte.
//!
//! Two passes, columns first, with 8-bit values between them; filters widen when shrinking
//! (antialias); weights are rounded to 22 fractional bits. Models are trained on pictures scaled
//! this way.

mod filter;
mod passes;
mod taps;

use jrdb_types::Image;

use super::tensor::{Layout, Normalise};
pub use filter::Filter;
use taps::Taps;

/// A rectangle of a picture. Its columns may go on at column 0, across the seam of a panorama.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Region {
    /// First column, below the picture's width.
    pub x_px: usize,
    /// First row.
    pub y_px: usize,
    /// Number of columns, at most the picture's.
    pub width_px: usize,
    /// Number of rows, all of them in the picture.
    pub height_px: usize,
}

impl Region {
    /// All of a picture.
    #[must_use]
    pub fn whole(image: &Image) -> Self {
        Self { x_px: 0, y_px: 0, width_px: image.width, height_px: image.height }
    }

    fn has_pixels(self) -> bool {
        self.width_px > 0 && self.height_px > 0
    }

    /// Copies one of its rows, with a byte behind it that may be anything.
    fn copy_row(self, image: &Image, row: usize, to: &mut [u8]) {
        let from = &image.rgb[3 * image.width * (self.y_px + row)..][..3 * image.width];
        let before_seam = 3 * self.width_px.min(image.width - self.x_px);
        let (first, second) = to[..3 * self.width_px].split_at_mut(before_seam);
        first.copy_from_slice(&from[3 * self.x_px..][..before_seam]);
        second.copy_from_slice(&from[..second.len()]);
    }
}

/// The picture scaled to another size. The result is black if the picture has no pixels.
///
/// # Panics
/// When the picture has pixels, but not `3 · width · height` bytes.
///
/// ```
/// use jrdb_perception::image::{Filter, resize};
/// use jrdb_types::Image;
/// let grey = Image::filled(40, 30, [90, 90, 90]);
/// assert_eq!(resize(&grey, 7, 9, Filter::Bicubic), Image::filled(7, 9, [90, 90, 90]));
/// ```
#[must_use]
pub fn resize(image: &Image, width: usize, height: usize, filter: Filter) -> Image {
    Resizer::new(filter, width, height).resize(image, Region::whole(image))
}

/// Scales parts of pictures to one size, and uses its memory and the weights of the last part's
/// size again.
///
/// ```
/// use jrdb_perception::image::{Filter, Region, Resizer, resize};
/// use jrdb_perception::image::{Layout, Normalise};
/// use jrdb_types::Image;
/// let panorama = Image::filled(400, 100, [255, 0, 0]);
/// let mut resizer = Resizer::new(Filter::Bilinear, 20, 10);
/// let across_the_seam = Region { x_px: 350, y_px: 0, width_px: 100, height_px: 100 };
/// assert_eq!(resizer.resize(&panorama, across_the_seam), Image::filled(20, 10, [255, 0, 0]));
/// let mut tensor = vec![0.0; 3 * 20 * 10];
/// let normalise = Normalise { mean: [0.5; 3], std: [0.5; 3] };
/// resizer.tensor(&panorama, across_the_seam, &normalise, Layout::Chw, &mut tensor);
/// assert_eq!((tensor[0], tensor[200]), (1.0, -1.0));
/// ```
#[derive(Debug, Clone)]
pub struct Resizer {
    filter: Filter,
    width: usize,
    height: usize,
    across: Taps,
    down: Taps,
    /// A row of the region, and one of the result.
    rows: [Vec<u8>; 2],
    /// The region at its new width and its old height.
    narrow: Vec<u8>,
}

impl Resizer {
    /// For pictures of so many columns and rows.
    #[must_use]
    pub fn new(filter: Filter, width: usize, height: usize) -> Self {
        let (across, down, rows, narrow) = Default::default();
        Self { filter, width, height, across, down, rows, narrow }
    }

    /// A part of a picture, scaled; black where it has no pixels.
    ///
    /// # Panics
    /// When the region is not in the picture, or the picture has not `3 · width · height` bytes.
    #[must_use]
    pub fn resize(&mut self, image: &Image, region: Region) -> Image {
        let mut scaled = Image::filled(self.width, self.height, [0; 3]);
        let stride = 3 * self.width;
        self.each_row(image, region, |y, row| {
            scaled.rgb[y * stride..][..stride].copy_from_slice(row);
        });
        scaled
    }

    /// A part of a picture, scaled and normalised, as a model takes it: `3 · height · width`
    /// numbers.
    ///
    /// # Panics
    /// When the tensor has another length, the region is not in the picture, or the picture has not
    /// `3 · width · height` bytes.
    pub fn tensor(
        &mut self,
        image: &Image,
        region: Region,
        normalise: &Normalise,
        layout: Layout,
        tensor: &mut [f32],
    ) {
        let plane = self.width * self.height;
        assert_eq!(tensor.len(), 3 * plane, "a tensor has a number for each channel of each pixel");
        let table = normalise.table();
        let width = self.width;
        self.each_row(image, region, |y, row| match layout {
            Layout::Chw => table.put_planes(row, tensor, plane, y * width),
            Layout::Hwc => table.put_row(row, &mut tensor[3 * y * width..][..3 * width]),
        });
    }

    /// Hands on the rows of the result from the top, `3 · width` bytes each.
    fn each_row(&mut self, image: &Image, region: Region, mut put: impl FnMut(usize, &[u8])) {
        if self.width == 0 || self.height == 0 {
            return;
        }
        let stride = 3 * self.width;
        let [from, to] = &mut self.rows;
        to.clear();
        to.resize(stride + 1, 0);
        if !region.has_pixels() {
            return (0..self.height).for_each(|y| put(y, &to[..stride]));
        }
        self.across.set(region.width_px, self.width, self.filter);
        self.down.set(region.height_px, self.height, self.filter);
        from.resize(3 * region.width_px + 1, 0);
        self.narrow.resize(stride * region.height_px, 0);
        for (y, narrow) in self.narrow.chunks_exact_mut(stride).enumerate() {
            region.copy_row(image, y, from);
            passes::across(&self.across, &from[..=3 * region.width_px], to);
            narrow.copy_from_slice(&to[..stride]);
        }
        for y in 0..self.height {
            passes::down(&self.down, y, &self.narrow, &mut to[..stride]);
            put(y, &to[..stride]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A picture of 7 x 5 pixels with strong contrasts: byte `i` is `i * i * 37 mod 256`.
    fn picture() -> Image {
        let rgb = (0..105_usize).map(|i| (i * i * 37 % 256) as u8).collect();
        Image { width: 7, height: 5, rgb }
    }

    /// What Pillow 13.0 makes of the picture: `Image.resize((width, height), filter)`.
    const PILLOW: [(Filter, usize, usize, &[u8]); 6] = [
        (
            Filter::Bilinear,
            3,
            2,
            &[
                104, 105, 137, 110, 113, 97, 142, 92, 148, 164, 104, 148, 101, 110, 120, 119, 116,
                93,
            ],
        ),
        (
            Filter::Bilinear,
            4,
            5,
            &[
                35, 55, 148, 93, 59, 100, 185, 89, 118, 178, 29, 197, 131, 168, 145, 67, 123, 109,
                74, 119, 43, 151, 129, 206, 202, 123, 143, 101, 103, 128, 156, 96, 110, 111, 132,
                93, 151, 90, 128, 63, 83, 126, 166, 124, 156, 84, 123, 102, 223, 70, 223, 146, 133,
                112, 32, 141, 57, 155, 90, 74,
            ],
        ),
        (
            Filter::Bilinear,
            9,
            8,
            &[
                0, 37, 148, 51, 66, 154, 66, 54, 116, 81, 42, 78, 181, 116, 125, 202, 111, 93, 166,
                48, 147, 159, 15, 201, 212, 45, 208, 83, 128, 134, 75, 98, 156, 71, 67, 137, 79,
                73, 92, 111, 165, 70, 150, 91, 57, 132, 85, 129, 144, 82, 201, 212, 53, 224, 192,
                233, 123, 112, 140, 156, 78, 85, 158, 76, 109, 111, 34, 228, 16, 87, 67, 16, 92,
                127, 102, 124, 165, 194, 205, 73, 239, 227, 118, 180, 169, 155, 129, 90, 108, 103,
                61, 70, 118, 169, 215, 174, 124, 80, 76, 120, 77, 64, 125, 124, 111, 122, 161, 178,
                219, 42, 195, 184, 154, 113, 96, 125, 87, 48, 51, 128, 183, 160, 210, 164, 114,
                139, 142, 65, 64, 111, 94, 66, 77, 207, 156, 170, 4, 168, 157, 139, 108, 95, 136,
                109, 38, 52, 141, 75, 63, 125, 207, 169, 204, 157, 92, 101, 82, 76, 59, 70, 212,
                171, 189, 34, 209, 198, 95, 173, 163, 135, 135, 97, 122, 110, 35, 34, 108, 94, 179,
                113, 113, 124, 80, 121, 79, 72, 131, 141, 112, 208, 61, 244, 233, 63, 223, 216,
                134, 154, 143, 176, 85, 13, 20, 101, 3, 183, 38, 78, 146, 61, 154, 82, 83, 180, 85,
                64,
            ],
        ),
        (
            Filter::Bicubic,
            3,
            2,
            &[98, 106, 138, 109, 107, 89, 148, 92, 154, 172, 101, 152, 96, 114, 119, 118, 119, 88],
        ),
        (
            Filter::Bicubic,
            4,
            5,
            &[
                30, 53, 151, 95, 62, 96, 190, 93, 114, 177, 23, 203, 135, 167, 151, 61, 120, 107,
                68, 123, 29, 156, 129, 218, 205, 123, 139, 96, 108, 131, 163, 93, 113, 107, 130,
                87, 157, 94, 127, 54, 84, 126, 172, 120, 158, 81, 123, 98, 232, 68, 231, 143, 134,
                109, 18, 142, 54, 163, 89, 75,
            ],
        ),
        (
            Filter::Bicubic,
            9,
            8,
            &[
                0, 19, 150, 51, 65, 161, 63, 51, 110, 71, 29, 66, 193, 108, 134, 220, 124, 91, 167,
                36, 148, 155, 0, 209, 216, 46, 206, 74, 131, 129, 68, 94, 164, 67, 54, 144, 78, 68,
                87, 107, 162, 63, 159, 88, 46, 128, 84, 133, 140, 82, 218, 224, 43, 229, 202, 251,
                117, 107, 139, 161, 73, 66, 172, 79, 109, 115, 24, 232, 6, 85, 45, 1, 84, 133, 100,
                121, 187, 208, 214, 63, 246, 245, 119, 190, 184, 171, 127, 78, 104, 88, 46, 53,
                116, 185, 229, 190, 114, 63, 63, 114, 60, 41, 130, 133, 107, 116, 169, 179, 227,
                23, 207, 201, 177, 102, 81, 135, 60, 22, 21, 128, 208, 165, 235, 176, 117, 152,
                149, 38, 41, 109, 82, 45, 60, 231, 158, 168, 0, 169, 162, 154, 99, 90, 152, 103,
                20, 34, 147, 72, 60, 122, 235, 191, 232, 169, 83, 95, 67, 58, 38, 65, 226, 183,
                186, 34, 213, 206, 89, 180, 176, 149, 136, 98, 133, 105, 24, 25, 100, 96, 203, 116,
                115, 131, 78, 123, 63, 68, 137, 140, 111, 209, 65, 250, 243, 45, 241, 239, 142,
                155, 156, 204, 71, 9, 18, 100, 0, 199, 16, 70, 160, 56, 171, 72, 93, 190, 75, 55,
            ],
        ),
    ];

    #[test]
    fn every_byte_is_pillows() {
        for (filter, width, height, expected) in PILLOW {
            let found = resize(&picture(), width, height, filter);
            assert_eq!(found.rgb, expected, "{filter:?} to {width} x {height}");
        }
    }

    proptest! {
        #[test]
        fn a_region_is_its_crop_whether_it_crosses_the_seam_or_not(
            x in 0_usize..23, y in 0_usize..9, width in 1_usize..=23, height in 1_usize..9,
            [to_width, to_height] in [1_usize..40, 1_usize..40], bicubic: bool,
        ) {
            let rgb = (0..3 * 23 * 17_usize).map(|i| (i * i * 37 % 251) as u8).collect();
            let image = Image { width: 23, height: 17, rgb };
            let mut crop = Image::filled(width, height, [0; 3]);
            for (at, pixel) in crop.rgb.as_chunks_mut::<3>().0.iter_mut().enumerate() {
                *pixel = image.pixel((x + at % width) % 23, y + at / width);
            }
            let filter = if bicubic { Filter::Bicubic } else { Filter::Bilinear };
            let region = Region { x_px: x, y_px: y, width_px: width, height_px: height };
            let mut resizer = Resizer::new(filter, to_width, to_height);
            let found = resizer.resize(&image, region);
            prop_assert_eq!(&found, &resize(&crop, to_width, to_height, filter));
            // Memory that is used again does not show.
            let whole = resizer.resize(&image, Region::whole(&image));
            prop_assert_eq!(whole, resize(&image, to_width, to_height, filter));
            let normalise = Normalise { mean: [0.0; 3], std: [1.0 / 255.0; 3] };
            let (mut chw, mut hwc) = (vec![0.0; found.rgb.len()], vec![0.0; found.rgb.len()]);
            resizer.tensor(&image, region, &normalise, Layout::Chw, &mut chw);
            resizer.tensor(&image, region, &normalise, Layout::Hwc, &mut hwc);
            for (at, byte) in found.rgb.iter().enumerate() {
                let planar = chw[at % 3 * to_width * to_height + at / 3];
                prop_assert_eq!((planar.round() as u8, hwc[at]), (*byte, planar));
            }
        }
    }

    #[test]
    fn a_part_without_pixels_is_black_and_a_result_without_pixels_is_none() {
        let nothing = Region { x_px: 0, y_px: 0, width_px: 0, height_px: 5 };
        let mut resizer = Resizer::new(Filter::Bilinear, 2, 2);
        assert_eq!(resizer.resize(&picture(), nothing), Image::filled(2, 2, [0; 3]));
        assert!(resize(&picture(), 0, 4, Filter::Bicubic).rgb.is_empty());
        assert!(resize(&picture(), 4, 0, Filter::Bicubic).rgb.is_empty());
    }

    #[test]
    fn the_same_size_changes_nothing() {
        for filter in [Filter::Bilinear, Filter::Bicubic] {
            assert_eq!(resize(&picture(), 7, 5, filter), picture());
        }
    }

    #[test]
    fn contrast_beyond_the_range_of_bytes_is_cut_off() {
        let mut edge = Image::filled(8, 1, [0; 3]);
        edge.rgb[12..].fill(255);
        let wide = resize(&edge, 32, 1, Filter::Bicubic);
        assert_eq!((wide.pixel(0, 0), wide.pixel(31, 0)), ([0; 3], [255; 3]));
        assert!(wide.rgb.is_sorted());
    }
}
