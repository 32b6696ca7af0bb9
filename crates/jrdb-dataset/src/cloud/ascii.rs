//! Points as lines of numbers.

use jrdb_types::PointCloud;

use super::columns::{close_gaps, empty};
use super::fields::excerpt;

/// What a word of a line is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Word {
    /// Nothing; it need not be a number.
    Skip,
    /// A number of the point: x, y, z or intensity by this index.
    Keep(usize),
    /// The number of words that follow and are passed over.
    List,
}

/// A line that is no point.
pub(super) struct BadRow {
    /// What the line should hold.
    pub(super) expected: String,
    /// The start of the line.
    pub(super) found: String,
}

/// The lines that are not blank, one after the other.
pub(super) struct Rows<'a> {
    rest: &'a [u8],
}

impl<'a> Rows<'a> {
    pub(super) fn new(body: &'a [u8]) -> Self {
        Self { rest: body }
    }

    /// Writes x, y, z and intensity of the next line, as far as the words have them; none at the end of the body.
    pub(super) fn next_row(
        &mut self,
        words: &[Word],
        row: &mut [f32; 4],
    ) -> Option<Result<(), BadRow>> {
        self.skip_blank_lines()?;
        let line = self.rest;
        Some(self.row(words, row).map_err(|expected| {
            let line = line.split(|&b| b == b'\n').next().unwrap_or_default();
            BadRow { expected, found: excerpt(&String::from_utf8_lossy(line)) }
        }))
    }

    /// Passes over the next line; none at the end of the body.
    pub(super) fn skip_row(&mut self) -> Option<()> {
        self.skip_blank_lines()?;
        let end = self.rest.iter().position(|&b| b == b'\n').unwrap_or(self.rest.len());
        self.rest = &self.rest[end..];
        Some(())
    }

    fn skip_blank_lines(&mut self) -> Option<()> {
        while let [blank, rest @ ..] = self.rest
            && blank.is_ascii_whitespace()
        {
            self.rest = rest;
        }
        (!self.rest.is_empty()).then_some(())
    }

    fn row(&mut self, words: &[Word], row: &mut [f32; 4]) -> Result<(), String> {
        let mut rest = self.rest;
        let columns = || format!("{} columns", words.len());
        for word in words {
            rest = skip_blanks(rest);
            if matches!(rest, [] | [b'\n', ..]) {
                return Err(columns());
            }
            match *word {
                Word::Skip => rest = split_word(rest).1,
                Word::Keep(slot) => (row[slot], rest) = number(rest).ok_or("a number")?,
                Word::List => {
                    rest = skip_list(rest).ok_or("a list with as many words as it says")?;
                }
            }
        }
        rest = skip_blanks(rest);
        if !matches!(rest, [] | [b'\n', ..]) {
            return Err(columns());
        }
        self.rest = rest;
        Ok(())
    }
}

/// The points of the rows read so far, in a cloud that had none.
pub(super) struct Points<'a> {
    cloud: &'a mut PointCloud,
    has_intensity: bool,
}

impl<'a> Points<'a> {
    pub(super) fn new(cloud: &'a mut PointCloud, has_intensity: bool) -> Self {
        empty(cloud);
        Self { cloud, has_intensity }
    }

    pub(super) fn push(&mut self, &[x, y, z, intensity]: &[f32; 4]) {
        self.cloud.x.push(x);
        self.cloud.y.push(y);
        self.cloud.z.push(z);
        if self.has_intensity {
            self.cloud.intensity.push(intensity);
        }
    }

    pub(super) fn finish(self) {
        close_gaps(self.cloud);
    }
}

fn skip_blanks(mut text: &[u8]) -> &[u8] {
    while let [b' ' | b'\t' | b'\r' | b'\x0c', rest @ ..] = text {
        text = rest;
    }
    text
}

fn split_word(text: &[u8]) -> (&[u8], &[u8]) {
    let end = text.iter().position(u8::is_ascii_whitespace).unwrap_or(text.len());
    text.split_at(end)
}

fn skip_list(text: &[u8]) -> Option<&[u8]> {
    let (count, mut rest) = split_word(text);
    let count: usize = std::str::from_utf8(count).ok()?.parse().ok()?;
    for _ in 0..count {
        let word;
        (word, rest) = split_word(skip_blanks(rest));
        if word.is_empty() {
            return None;
        }
    }
    Some(rest)
}

/// The number at the start of a text, and what follows it.
fn number(text: &[u8]) -> Option<(f32, &[u8])> {
    short_decimal(text).or_else(|| {
        let (word, rest) = split_word(text);
        let word = std::str::from_utf8(word).ok()?;
        Some((word.parse().ok().or_else(|| no_number(word))?, rest))
    })
}

/// What C libraries print for a number that is none: glibc's `nan(0x7)`, Microsoft's `-nan(ind)`, `1.#QNAN`, `-1.#IND`, `1.#INF00`.
fn no_number(word: &str) -> Option<f32> {
    let word = word.strip_prefix(['-', '+']).unwrap_or(word).to_ascii_lowercase();
    let name = word.strip_prefix("1.#").unwrap_or(&word);
    let name = name.trim_end_matches('0');
    let payload = |name: &str| name.is_empty() || (name.starts_with('(') && name.ends_with(')'));
    let is_nan = ["nan", "qnan", "snan", "ind"]
        .iter()
        .any(|known| name.strip_prefix(known).is_some_and(payload));
    let is_known = is_nan || ["inf", "infinity"].contains(&name) || ["na", "n/a"].contains(&name);
    is_known.then_some(f32::NAN)
}

/// Most digits of which any number is exact as `f64`.
const MAX_DIGITS: usize = 15;

/// Powers of ten, which are exact as `f64`.
const POWERS_OF_TEN: [f64; MAX_DIGITS + 1] =
    [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];

/// The usual number of a cloud, `-12.345678`, without the generality that makes `str::parse` slow; none for
/// any other, which `str::parse` may still know.
///
/// Digits and power of ten are exact as `f64`, so their quotient is the `f64` nearest to the number. Its
/// nearest `f32` is the number's, unless the `f64` lies exactly between two `f32`: then the number may lie on
/// either side.
fn short_decimal(text: &[u8]) -> Option<(f32, &[u8])> {
    // Half of all coordinates are negative: a branch would be guessed wrong as often.
    let negative = text.first() == Some(&b'-');
    let unsigned = text.get(usize::from(negative)..)?;
    let (mut digits, mut point, mut end) = (0_u64, None, unsigned.len());
    for (at, byte) in unsigned.iter().enumerate() {
        let digit = byte.wrapping_sub(b'0');
        if digit < 10 {
            digits = digits.wrapping_mul(10).wrapping_add(digit.into());
        } else if *byte == b'.' && point.is_none() {
            point = Some(at);
        } else {
            end = at;
            break;
        }
    }
    let decimals = point.map_or(0, |point| end - point - 1);
    let count = end - usize::from(point.is_some());
    let rest = &unsigned[end..];
    if !(1..=MAX_DIGITS).contains(&count) || !rest.first().is_none_or(u8::is_ascii_whitespace) {
        return None;
    }
    let value = digits as f64 / POWERS_OF_TEN[decimals];
    const BELOW_F32: u64 = (1 << 29) - 1;
    const HALFWAY: u64 = 1 << 28;
    if value.to_bits() & BELOW_F32 == HALFWAY {
        return None;
    }
    Some((f32::from_bits((value as f32).to_bits() | u32::from(negative) << 31), rest))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn rows(text: &str, words: &[Word]) -> Vec<Result<[f32; 4], String>> {
        let mut rows = Rows::new(text.as_bytes());
        let next = || {
            let mut row = [0.0; 4];
            let read = rows.next_row(words, &mut row)?;
            Some(read.map(|()| row).map_err(|bad| format!("{}: {}", bad.expected, bad.found)))
        };
        std::iter::from_fn(next).take(9).collect()
    }

    const XY: [Word; 3] = [Word::Keep(0), Word::Skip, Word::Keep(1)];

    #[test]
    fn words_are_kept_skipped_or_lists() {
        let read = rows("\n 1 red -2.5 \r\n\r\n+3e1\tblue .5", &XY);
        assert_eq!(read, [Ok([1.0, -2.5, 0.0, 0.0]), Ok([30.0, 0.5, 0.0, 0.0])]);
        let with_list = rows("3 a b c 7\n0 8\n", &[Word::List, Word::Keep(2)]);
        assert_eq!(with_list, [Ok([0.0, 0.0, 7.0, 0.0]), Ok([0.0, 0.0, 8.0, 0.0])]);
    }

    #[test]
    fn a_line_that_is_no_point_is_quoted() {
        assert_eq!(rows("1 2\n1 2 3", &XY)[0], Err("3 columns: 1 2".into()));
        assert_eq!(rows("1 2 3 4\n", &XY)[0], Err("3 columns: 1 2 3 4".into()));
        assert_eq!(rows("1 2 3x\n", &XY)[0], Err("a number: 1 2 3x".into()));
        let list = rows("3 a b\n1", &[Word::List]);
        assert_eq!(list[0], Err("a list with as many words as it says: 3 a b".into()));
    }

    #[test]
    fn a_number_that_is_none_is_known_by_every_c_library_s_name() {
        let words = "nan -nan NaN nan(ind) -nan(ind) -nan(snan) nan(0x7) 1.#QNAN 1.#QNAN0 -1.#IND -1.#IND00 1.#INF -1.#INF00 1.#SNAN";
        for word in words.split(' ') {
            let (number, _) = number(word.as_bytes()).unwrap();
            assert!(!number.is_finite(), "{word}");
        }
        for word in ["nan(", "1.#", "none", "1.#x", "ind(x"] {
            assert!(number(word.as_bytes()).is_none(), "{word}");
        }
    }

    #[test]
    fn numbers_that_round_differently_through_f64_are_right() {
        // 1 + 2^-24 lies between two f32; with a little more it must not be rounded down.
        for text in
            ["1.000000059604644775390625", "1.00000005960465", "1.00000005960464", "0.1", "-0"]
        {
            let expected: f32 = text.parse().unwrap();
            assert_eq!(number(text.as_bytes()).unwrap().0.to_bits(), expected.to_bits(), "{text}");
        }
    }

    proptest! {
        #[test]
        fn numbers_are_those_of_the_standard_library(text in "[-+]?[0-9]{0,12}\\.?[0-9]{0,12}(e-?[0-9]{1,2})?") {
            let found = number(text.as_bytes()).map(|(number, _)| number.to_bits());
            prop_assert_eq!(found, text.parse::<f32>().ok().map(f32::to_bits));
        }

        #[test]
        fn usual_numbers_are_those_of_the_standard_library(value in -200.0..200_f64, decimals in 0..9_usize) {
            let text = format!("{value:.decimals$}");
            let found = short_decimal(text.as_bytes()).map_or(f32::NAN, |(number, _)| number);
            prop_assert_eq!(found.to_bits(), text.parse::<f32>().unwrap().to_bits());
        }
    }
}
