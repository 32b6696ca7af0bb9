//! What the numbers of a file without a header tell about its layout.
//!
//! In the right layout each column holds one kind of number: heights are small, intensities positive. In a wrong one every column is
//! a mixture. So the entropy of sign and exponent, given the column, is least in the right layout. On real and drawn sweeps
//! (KITTI, nuScenes, JRDB) it is 0.4 to 1.4 bits a number below that of any wrong layout that is not a multiple of
//! the right one, and wrong layouts differ from each other by less than 0.03.

use crate::cloud::columns::Scalar;

/// What the numbers show.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Evidence {
    /// Nothing against the layout that the name stands for.
    AsNamed,
    /// They are surely of another layout.
    Other { scalar: Scalar, columns: usize },
    /// They look like floats of another number of columns.
    PerhapsOther { columns: usize },
    /// They are not floats of points at all.
    NotFloats { percent: u32 },
}

/// Words of a block: a multiple of every number of columns that is tried, as floats and as doubles.
const BLOCK_WORDS: usize = 840;
/// Blocks that are looked at.
const MAX_BLOCKS: usize = 16;
/// Fewest blocks that tell anything.
const MIN_BLOCKS: usize = 3;
/// Numbers of columns that are tried.
const FLOATS: std::ops::RangeInclusive<usize> = 3..=8;
const DOUBLES: std::ops::RangeInclusive<usize> = 3..=6;
/// Words of the widest point that is tried.
const MAX_PERIOD: usize = 12;
/// Signs and exponents of a float.
const SYMBOLS: usize = 512;

/// Bits a number by which a layout must be better to be sure, and to be mentioned.
const SURE_BITS: f64 = 0.2;
const LIKELY_BITS: f64 = 0.1;
/// The same for a layout that is a multiple of another: sensors that fire their lasers in turn have layouts of two
/// points, too.
const SURE_MULTIPLE_BITS: f64 = 0.35;
/// Part of the numbers that may be wild in a file of floats.
const MAX_WILD: f64 = 0.2;

/// Weighs the layout that a name stands for, so many floats, against others.
pub(super) fn weigh(bytes: &[u8], named: usize) -> Evidence {
    let Some(sample) = Sample::of(bytes) else { return Evidence::AsNamed };
    if sample.has_doubles() {
        let fits = |columns: &usize| bytes.len().is_multiple_of(columns * Scalar::F64.size());
        if let Some(columns) = sample.columns_of_doubles(fits) {
            return Evidence::Other { scalar: Scalar::F64, columns };
        }
    }
    let wild = sample.part(is_wild);
    if wild > MAX_WILD && !sample.has_places(named) {
        return Evidence::NotFloats { percent: (100.0 * wild).round() as u32 };
    }
    let fits = |columns: usize| bytes.len().is_multiple_of(columns * Scalar::F32.size());
    let columns = sample.columns(named, fits);
    if columns == named {
        return Evidence::AsNamed;
    }
    let rival = if fits(named) { sample.entropy(named) } else { sample.entropy(1) };
    match rival - sample.entropy(columns) {
        gain if gain > SURE_BITS => Evidence::Other { scalar: Scalar::F32, columns },
        gain if gain > LIKELY_BITS => Evidence::PerhapsOther { columns },
        _ => Evidence::AsNamed,
    }
}

/// Blocks of words from all over a file, each with the start of a point of any layout.
struct Sample {
    blocks: Vec<Vec<u32>>,
}

impl Sample {
    fn of(bytes: &[u8]) -> Option<Self> {
        let blocks = bytes.chunks_exact(4 * BLOCK_WORDS);
        let (count, step) = (blocks.len(), blocks.len().div_ceil(MAX_BLOCKS).max(1));
        let words = |block: &[u8]| {
            let (words, _) = block.as_chunks::<4>();
            words.iter().map(|word| u32::from_le_bytes(*word)).collect()
        };
        let blocks = blocks.step_by(step).map(words).collect();
        (count >= MIN_BLOCKS).then_some(Self { blocks })
    }

    /// Part of the words of which something holds.
    fn part(&self, holds: impl Fn(u32) -> bool) -> f64 {
        let words = self.blocks.iter().flatten();
        words.clone().filter(|word| holds(**word)).count() as f64 / words.count().max(1) as f64
    }

    /// Part of every second word, from the first or second on, of which something holds.
    fn part_of_half(&self, from: usize, holds: impl Fn(u32) -> bool) -> f64 {
        let words = || self.blocks.iter().flat_map(|block| block.iter().skip(from).step_by(2));
        words().filter(|word| holds(**word)).count() as f64 / words().count().max(1) as f64
    }

    /// Whether the words are halves of doubles: the lower halves are noise (or zeros), the upper ones all alike as floats.
    fn has_doubles(&self) -> bool {
        const MIN_NOISE: f64 = 0.15;
        const MIN_ZEROS: f64 = 0.95;
        const MAX_EMPTY: f64 = 0.7;
        const MIN_UPPER: f64 = 0.95;
        let noise = self.part_of_half(0, is_wild);
        let zeros = self.part_of_half(0, |word| word == 0);
        let upper = self.part_of_half(1, |word| word == 0 || is_upper_half(word));
        let empty = self.part_of_half(1, |word| word == 0);
        upper > MIN_UPPER && (noise > MIN_NOISE || (zeros > MIN_ZEROS && empty < MAX_EMPTY))
    }

    /// Mean entropy of sign and exponent given the place in a point of so many words, bits.
    fn entropy(&self, period: usize) -> f64 {
        let mut counts = vec![[0_u32; SYMBOLS]; period.min(MAX_PERIOD)];
        for block in &self.blocks {
            for (column, word) in (0..counts.len()).cycle().zip(block) {
                counts[column][symbol(*word)] += 1;
            }
        }
        counts.iter().map(column_entropy).sum::<f64>() / counts.len() as f64
    }

    /// Whether the first three of so many columns hold what coordinates may be.
    fn has_places(&self, columns: usize) -> bool {
        const MAX_WILD_PLACES: f64 = 0.05;
        let rows = || self.blocks.iter().flat_map(|block| block.chunks_exact(columns));
        let wild: usize = rows().map(|row| row[..3].iter().filter(|w| is_wild(**w)).count()).sum();
        wild as f64 <= MAX_WILD_PLACES * 3.0 * rows().count() as f64
    }

    /// The number of columns of doubles that is most likely: the smallest, unless another is better.
    fn columns_of_doubles(&self, fits: impl Fn(&usize) -> bool) -> Option<usize> {
        let bits = DOUBLES.filter(fits).map(|columns| (columns, self.entropy(2 * columns)));
        let better = |best: (usize, f64), other: (usize, f64)| {
            if best.1 - other.1 > LIKELY_BITS { other } else { best }
        };
        bits.reduce(better).map(|(columns, _)| columns)
    }

    /// The number of columns that is most likely, the named one unless another is better.
    fn columns(&self, named: usize, fits: impl Fn(usize) -> bool) -> usize {
        let bits: Vec<(usize, f64)> = FLOATS
            .filter(|&n| fits(n) && self.has_places(n))
            .map(|n| (n, self.entropy(n)))
            .collect();
        let mut best = bits.iter().copied().find(|(n, _)| *n == named);
        for (columns, entropy) in bits {
            let is_better = best.is_none_or(|(known, least)| {
                let is_multiple = columns.is_multiple_of(known);
                let is_twice = is_multiple && columns > known;
                let gain = least - entropy;
                if is_twice {
                    gain > SURE_MULTIPLE_BITS && !self.repeats(known)
                } else {
                    gain > LIKELY_BITS
                }
            });
            if is_better {
                best = Some((columns, entropy));
            }
        }
        best.map_or(named, |(columns, _)| columns)
    }

    /// Whether two points one after the other look in nearly the same direction, as neighbours do.
    fn repeats(&self, columns: usize) -> bool {
        const MIN_AGREEING: f64 = 0.75;
        let pairs = || {
            let rows = self.blocks.iter().flat_map(|block| block.chunks_exact(2 * columns));
            rows.flat_map(|row| [(row[0], row[columns]), (row[1], row[columns + 1])])
        };
        let agrees = |(a, b): &(u32, u32)| *a << 1 != 0 && *b << 1 != 0 && a >> 31 == b >> 31;
        let agreeing = pairs().filter(agrees).count() as f64;
        agreeing > MIN_AGREEING * pairs().count() as f64
    }
}

/// Entropy of counts, bits, corrected for their small number after Miller and Madow.
fn column_entropy(counts: &[u32; SYMBOLS]) -> f64 {
    let total = f64::from(counts.iter().sum::<u32>());
    let seen = counts.iter().filter(|&&count| count > 0);
    let part = |count: &u32| f64::from(*count) / total;
    let bits: f64 = seen.clone().map(|count| -part(count) * part(count).log2()).sum();
    let correction = (seen.count() as f64 - 1.0) / (2.0 * total * std::f64::consts::LN_2);
    bits + correction
}

/// Sign and exponent; zero has no sign.
fn symbol(word: u32) -> usize {
    if word << 1 == 0 { 0 } else { (word >> 23) as usize }
}

/// Whether a float is of no use for anything that a LiDAR gives: larger than a thousand kilometres, or next to nothing.
fn is_wild(word: u32) -> bool {
    const LARGEST: f32 = 1e6;
    const LEAST: f32 = 1e-12;
    let size = f32::from_bits(word).abs();
    size.is_finite() && (size > LARGEST || (size > 0.0 && size < LEAST))
}

/// Whether the upper half of a double between 1e-6 and 1e6 may be this word.
fn is_upper_half(word: u32) -> bool {
    const LEAST_EXPONENT: u32 = 1023 - 20;
    const LARGEST_EXPONENT: u32 = 1023 + 20;
    (LEAST_EXPONENT..=LARGEST_EXPONENT).contains(&(word >> 20 & 0x7ff))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sweep around the sensor: x, y, z, intensity, and four more numbers of other kinds.
    fn points(count: usize) -> Vec<[f64; 8]> {
        let point = |i: usize| {
            let (turn, noise) = (i as f64 * 0.01, (i * 7919 % 1009) as f64 / 1009.0);
            let range = 4.0 + 8.0 * noise;
            let (x, y) = (range * turn.cos(), range * turn.sin());
            [
                x,
                y,
                -1.2 + 0.2 * noise,
                noise.powi(2),
                (i % 32) as f64,
                1e-4 * i as f64,
                0.5,
                0.25 * noise,
            ]
        };
        (0..count).map(point).collect()
    }

    fn floats(points: &[[f64; 8]], columns: usize) -> Vec<u8> {
        let numbers = points.iter().flat_map(|point| point[..columns].iter());
        numbers.flat_map(|n| (*n as f32).to_le_bytes()).collect()
    }

    fn doubles(points: &[[f64; 8]], columns: usize) -> Vec<u8> {
        let numbers = points.iter().flat_map(|point| point[..columns].iter());
        numbers.flat_map(|n| n.to_le_bytes()).collect()
    }

    /// A number of points that divides by everything, so that every layout is possible.
    const COUNT: usize = 2520;

    #[test]
    fn floats_of_another_number_of_columns_are_known() {
        let points = points(COUNT);
        for columns in FLOATS {
            for named in [4, 5] {
                let expected = if columns == named {
                    Evidence::AsNamed
                } else {
                    Evidence::Other { scalar: Scalar::F32, columns }
                };
                assert_eq!(weigh(&floats(&points, columns), named), expected, "{columns}, {named}");
            }
        }
    }

    #[test]
    fn doubles_are_known() {
        let mut points = points(COUNT);
        let check = |of_what: &str, points: &[[f64; 8]]| {
            for columns in 3..=5 {
                let expected = Evidence::Other { scalar: Scalar::F64, columns };
                assert_eq!(weigh(&doubles(points, columns), 4), expected, "{of_what}");
            }
        };
        check("doubles", &points);
        points.iter_mut().flatten().for_each(|n| *n = f64::from(*n as f32));
        check("doubles of floats", &points);
        points.iter_mut().for_each(|point| point[3] = point[3].round());
        check("with whole intensities", &points);
    }

    #[test]
    fn sound_files_stay_what_they_are() {
        let points = points(COUNT);
        let shuffled: Vec<_> = (0..COUNT).map(|i| points[i * 1009 % COUNT]).collect();
        assert_eq!(weigh(&floats(&shuffled, 4), 4), Evidence::AsNamed, "in any order");
        let mut in_turn = points.clone();
        in_turn
            .iter_mut()
            .step_by(2)
            .for_each(|p| (p[0], p[1], p[2]) = (8.0 * p[0], 8.0 * p[1], 1.5));
        assert_eq!(weigh(&floats(&in_turn, 4), 4), Evidence::AsNamed, "two lasers in turn");
        let mut gaps = points.clone();
        gaps.iter_mut().step_by(3).for_each(|p| p[..4].fill(f64::NAN));
        assert_eq!(weigh(&floats(&gaps, 4), 4), Evidence::AsNamed, "points without a place");
        gaps.iter_mut().for_each(|p| p[..4].fill(0.0));
        assert_eq!(weigh(&floats(&gaps, 4), 4), Evidence::AsNamed, "nothing but zeros");
        assert_eq!(weigh(&floats(&points[..100], 5), 4), Evidence::AsNamed, "too few to tell");
    }

    #[test]
    fn numbers_of_no_kind_are_refused() {
        let noise = (0..40_000_u32).map(|i| i.wrapping_mul(2_654_435_761) ^ (i << 13));
        let bytes: Vec<u8> = noise.flat_map(u32::to_le_bytes).collect();
        assert!(matches!(weigh(&bytes, 4), Evidence::NotFloats { .. }));
    }
}
