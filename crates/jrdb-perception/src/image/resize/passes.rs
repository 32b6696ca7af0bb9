//! The two passes over pixels, compiled for the widest registers that the machine has.

use super::taps::{FRACTION_BITS, Taps};

/// Half of the last bit that is kept: sums are rounded.
const HALF: i32 = 1 << (FRACTION_BITS - 1);

/// Scales a row of pixels. Both rows have a byte behind their last pixel: pixels are read and
/// written four bytes at a time.
pub(super) fn across(taps: &Taps, from: &[u8], to: &mut [u8]) {
    pulp::Arch::new().dispatch(Across { taps, from, to });
}

struct Across<'a> {
    taps: &'a Taps,
    from: &'a [u8],
    to: &'a mut [u8],
}

impl pulp::NullaryFnOnce for Across<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        match self.taps.count {
            2 => self.of::<2>(),
            3 => self.of::<3>(),
            4 => self.of::<4>(),
            _ => self.of_any(),
        }
    }
}

impl Across<'_> {
    /// With so many inputs of each output: the usual case when a picture is enlarged.
    #[inline(always)]
    fn of<const COUNT: usize>(self) {
        let weights = self.taps.weights.as_chunks::<COUNT>().0;
        for (at, (first, weights)) in self.taps.firsts.iter().zip(weights).enumerate() {
            let pixels = &self.from[3 * first..][..3 * COUNT + 1];
            let mut sums = [HALF; 4];
            for (k, weight) in weights.iter().enumerate() {
                add(&mut sums, *weight, &pixels[3 * k..]);
            }
            self.to[3 * at..][..4].copy_from_slice(&sums.map(rounded));
        }
    }

    #[inline(always)]
    fn of_any(self) {
        let weights = self.taps.weights.chunks_exact(self.taps.count);
        for (at, (first, weights)) in self.taps.firsts.iter().zip(weights).enumerate() {
            let mut sums = [HALF; 4];
            for (pixel, weight) in (*first..).zip(weights) {
                add(&mut sums, *weight, &self.from[3 * pixel..]);
            }
            self.to[3 * at..][..4].copy_from_slice(&sums.map(rounded));
        }
    }
}

/// Adds a pixel, and the byte behind it, multiplied by a weight.
#[inline(always)]
fn add(sums: &mut [i32; 4], weight: i32, pixel: &[u8]) {
    for (sum, byte) in sums.iter_mut().zip(&pixel[..4]) {
        *sum += weight * i32::from(*byte);
    }
}

#[inline(always)]
fn rounded(sum: i32) -> u8 {
    (sum >> FRACTION_BITS).clamp(0, 255) as u8
}

/// Makes one row of outputs of rows of inputs, which stand one behind the other.
pub(super) fn down(taps: &Taps, at: usize, rows: &[u8], to: &mut [u8]) {
    let weights = &taps.weights[at * taps.count..][..taps.count];
    let rows = &rows[taps.firsts[at] * to.len()..];
    pulp::Arch::new().dispatch(Down { weights, rows, to });
}

struct Down<'a> {
    weights: &'a [i32],
    rows: &'a [u8],
    to: &'a mut [u8],
}

impl pulp::NullaryFnOnce for Down<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        match *self.weights {
            [a, b] => self.of([a, b]),
            [a, b, c] => self.of([a, b, c]),
            [a, b, c, d] => self.of([a, b, c, d]),
            _ => self.of_any(),
        }
    }
}

impl Down<'_> {
    #[inline(always)]
    fn of<const COUNT: usize>(self, weights: [i32; COUNT]) {
        let length = self.to.len();
        let rows: [&[u8]; COUNT] = std::array::from_fn(|k| &self.rows[k * length..][..length]);
        for (at, to) in self.to.iter_mut().enumerate() {
            let mut sum = HALF;
            for (weight, row) in weights.iter().zip(&rows) {
                sum += weight * i32::from(row[at]);
            }
            *to = rounded(sum);
        }
    }

    /// With any number of inputs: so few columns at a time that their sums need no memory.
    #[inline(always)]
    fn of_any(self) {
        const COLUMNS: usize = 32;
        let length = self.to.len();
        for (first, to) in (0..length).step_by(COLUMNS).zip(self.to.chunks_mut(COLUMNS)) {
            let mut sums = [HALF; COLUMNS];
            for (k, weight) in self.weights.iter().enumerate() {
                let row = &self.rows[k * length + first..][..to.len()];
                for (sum, byte) in sums.iter_mut().zip(row) {
                    *sum += weight * i32::from(*byte);
                }
            }
            for (to, sum) in to.iter_mut().zip(sums) {
                *to = rounded(sum);
            }
        }
    }
}
