//! Pixels as the numbers that models take.

/// Mean and standard deviation of each channel, of values in `[0, 1]`: the subtrahend and the
/// divisor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Normalise {
    /// Of red, green and blue.
    pub mean: [f32; 3],
    /// Of red, green and blue.
    pub std: [f32; 3],
}

/// The order of a picture's numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layout {
    /// All of red, row by row from the top, then green, then blue.
    Chw,
    /// Red, green and blue of each pixel together.
    Hwc,
}

impl Normalise {
    /// ImageNet's, which most models of pictures are trained with.
    pub const IMAGENET: Self = Self { mean: [0.485, 0.456, 0.406], std: [0.229, 0.224, 0.225] };

    /// The number of a value of a channel, 0 for red: `(value / 255 - mean) / std`, each step
    /// rounded to 32 bits, as the image processors of Python's transformers that work on arrays
    /// compute it.
    ///
    /// # Panics
    /// When there is no such channel.
    ///
    /// ```
    /// use jrdb_perception::image::Normalise;
    /// assert_eq!(Normalise { mean: [0.5; 3], std: [0.25; 3] }.value(255, 0), 2.0);
    /// ```
    #[must_use]
    pub fn value(&self, value: u8, channel: usize) -> f32 {
        (f32::from(value) / 255.0 - self.mean[channel]) / self.std[channel]
    }

    /// The numbers of all values: dividing takes longer than looking up.
    pub(crate) fn table(&self) -> Table {
        Table(
            [0, 1, 2].map(|channel| std::array::from_fn(|value| self.value(value as u8, channel))),
        )
    }
}

/// The number of each value of each channel.
pub(crate) struct Table([[f32; 256]; 3]);

impl Table {
    /// Writes a row of pixels into the three planes of a tensor, at a place in each.
    pub(crate) fn put_planes(&self, row: &[u8], tensor: &mut [f32], plane: usize, at: usize) {
        let pixels = row.as_chunks::<3>().0;
        let (red, others) = tensor.split_at_mut(plane);
        let (green, blue) = others.split_at_mut(plane);
        let [red, green, blue] = [red, green, blue].map(|plane| &mut plane[at..][..pixels.len()]);
        for (((pixel, red), green), blue) in pixels.iter().zip(red).zip(green).zip(blue) {
            [*red, *green, *blue] = self.numbers(*pixel);
        }
    }

    /// Writes a row of pixels.
    pub(crate) fn put_row(&self, row: &[u8], tensor: &mut [f32]) {
        let to = tensor.as_chunks_mut::<3>().0;
        for (pixel, to) in row.as_chunks::<3>().0.iter().zip(to) {
            *to = self.numbers(*pixel);
        }
    }

    #[inline(always)]
    fn numbers(&self, [red, green, blue]: [u8; 3]) -> [f32; 3] {
        let [reds, greens, blues] = &self.0;
        [reds[usize::from(red)], greens[usize::from(green)], blues[usize::from(blue)]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rescaling_with_64_bits_and_a_factor_is_dividing_with_32() {
        // As configuration files of models write it.
        const FACTOR: f64 = 0.003_921_568_627_450_98;
        for value in 0..=u8::MAX {
            let plain = Normalise { mean: [0.0; 3], std: [1.0; 3] }.value(value, 0);
            assert_eq!((f64::from(value) * FACTOR) as f32, plain, "{value}");
        }
    }
}
