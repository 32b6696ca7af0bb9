//! Resampling of 8-bit pictures, equal to Pillow's byte for byte.
//!
//! Two passes, columns first, with 8-bit values between them; filters widen when shrinking (antialias);
//! weights are rounded to 22 fractional bits. Models are trained on pictures scaled this way.

use jrdb_types::Image;

/// The shape of the filter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Filter {
    /// Triangle, reaching 1 pixel to each side.
    Bilinear,
    /// Cubic convolution with a = -1/2 (Keys 1981), reaching 2 pixels to each side.
    Bicubic,
}

impl Filter {
    fn reach(self) -> f64 {
        match self {
            Self::Bilinear => 1.0,
            Self::Bicubic => 2.0,
        }
    }

    fn weight(self, x: f64) -> f64 {
        const A: f64 = -0.5;
        let x = x.abs();
        match self {
            Self::Bilinear => (1.0 - x).max(0.0),
            Self::Bicubic if x < 1.0 => ((A + 2.0) * x - (A + 3.0)) * x * x + 1.0,
            Self::Bicubic if x < 2.0 => (((x - 5.0) * x + 8.0) * x - 4.0) * A,
            Self::Bicubic => 0.0,
        }
    }
}

/// The picture scaled to another size. A picture without pixels gives black.
///
/// # Panics
/// When the picture has pixels, but not `3 · width · height` bytes.
///
/// ```
/// use jrdb_perception::resize::{Filter, resize};
/// use jrdb_types::Image;
/// let grey = Image::filled(40, 30, [90, 90, 90]);
/// assert_eq!(resize(&grey, 7, 9, Filter::Bicubic), Image::filled(7, 9, [90, 90, 90]));
/// ```
#[must_use]
pub fn resize(image: &Image, width: usize, height: usize, filter: Filter) -> Image {
    if image.rgb.is_empty() {
        return Image::filled(width, height, [0; 3]);
    }
    let narrow = resample_rows(image, &taps(image.width, width, filter));
    resample_columns(&narrow, &taps(image.height, height, filter))
}

const FRACTION_BITS: u32 = 22;

/// Which inputs make one output, and how much of each.
struct Taps {
    first: usize,
    /// In units of 2⁻²²; their magnitudes sum to less than 2, so that 255 times their sum fits 32 bits.
    weights: Vec<i32>,
}

fn taps(input: usize, output: usize, filter: Filter) -> Vec<Taps> {
    let scale = input as f64 / output as f64;
    let stretch = scale.max(1.0);
    let reach = filter.reach() * stretch;
    let one_output = |i: usize| {
        let center = (i as f64 + 0.5) * scale;
        // Conversions to integers cut the fraction off, and negative numbers to 0.
        let first = (center - reach + 0.5) as usize;
        let end = ((center + reach + 0.5) as usize).min(input);
        let squeeze = 1.0 / stretch;
        let weight = |j: usize| filter.weight((j as f64 - center + 0.5) * squeeze);
        let exact: Vec<f64> = (first..end).map(weight).collect();
        let sum: f64 = exact.iter().sum();
        let unit = f64::from(1_u32 << FRACTION_BITS);
        let weights = exact.iter().map(|w| (w / sum * unit).round() as i32).collect();
        Taps { first, weights }
    };
    (0..output).map(one_output).collect()
}

fn weighted(taps: &Taps, input: impl Fn(usize) -> u8) -> u8 {
    let half = 1 << (FRACTION_BITS - 1);
    let parts = taps.weights.iter().zip(taps.first..).map(|(w, at)| w * i32::from(input(at)));
    (parts.fold(half, |sum, part| sum + part) >> FRACTION_BITS).clamp(0, 255) as u8
}

fn resample_rows(image: &Image, taps: &[Taps]) -> Image {
    let mut rgb = Vec::with_capacity(3 * taps.len() * image.height);
    for row in image.rgb.chunks_exact(3 * image.width) {
        for t in taps {
            rgb.extend([0, 1, 2].map(|channel| weighted(t, |x| row[3 * x + channel])));
        }
    }
    Image { width: taps.len(), height: image.height, rgb }
}

fn resample_columns(image: &Image, taps: &[Taps]) -> Image {
    let stride = 3 * image.width;
    let mut rgb = Vec::with_capacity(stride * taps.len());
    for t in taps {
        rgb.extend((0..stride).map(|at| weighted(t, |y| image.rgb[y * stride + at])));
    }
    Image { width: image.width, height: taps.len(), rgb }
}

#[cfg(test)]
mod tests {
    use super::*;

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
