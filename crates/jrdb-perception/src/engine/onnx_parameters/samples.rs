//! A few numbers of a tensor, by which equal tensors are known.

use std::collections::BTreeMap;
use std::io;

use super::element::Element;

/// How many numbers are looked at.
const COUNT: u64 = 32;

/// Numbers at fixed places, as their bytes.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Default)]
pub(super) struct Samples(Vec<Vec<u8>>);

impl Samples {
    /// Takes numbers of a tensor. `read` gives so many bytes from a place of it on; places ascend.
    pub(super) fn take(
        element: Element,
        shape: &[u64],
        mut read: impl FnMut(u64, usize) -> io::Result<Vec<u8>>,
    ) -> io::Result<Self> {
        let unit = (element.bits / 8).max(1);
        let places = places(&in_units(element, shape));
        let mut found = BTreeMap::new();
        places.iter().for_each(|&place| drop(found.insert(place, Vec::new())));
        for (place, bytes) in &mut found {
            *bytes = read(place * unit, unit as usize)?;
        }
        Ok(Self(places.iter().map(|place| found[place].clone()).collect()))
    }

    /// Whether all numbers that were looked at are equal.
    pub(super) fn is_uniform(&self) -> bool {
        self.0.windows(2).all(|pair| pair[0] == pair[1])
    }
}

/// The shape in numbers, or in bytes where several numbers share one.
fn in_units(element: Element, shape: &[u64]) -> Vec<u64> {
    if element.bits >= 8 {
        return shape.to_vec();
    }
    vec![element.bytes(shape.iter().product()).unwrap_or(0)]
}

/// Where numbers are looked at: in a matrix and in its transpose these are the same numbers.
fn places(shape: &[u64]) -> Vec<u64> {
    if shape.contains(&0) {
        return Vec::new();
    }
    let place = |index: u64| match *shape {
        [rows, columns] => {
            let short = scattered(index, rows.min(columns));
            let long = scattered(index + COUNT, rows.max(columns));
            let (row, column) = if rows <= columns { (short, long) } else { (long, short) };
            row * columns + column
        }
        _ => scattered(index, shape.iter().product()),
    };
    (0..COUNT).map(place).collect()
}

/// A number below `end` that looks like chance. The factor is 2^64 divided by the golden ratio.
fn scattered(index: u64, end: u64) -> u64 {
    const FACTOR: u64 = 0x9E37_79B9_7F4A_7C15;
    const HIGH: u32 = 33;
    ((index + 1).wrapping_mul(FACTOR) >> HIGH).wrapping_mul(FACTOR) % end
}
