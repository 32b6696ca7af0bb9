//! Sets of node numbers, one bit each.

use std::fmt;

use smallvec::{SmallVec, smallvec};

const BITS: usize = u64::BITS as usize;

/// Sets of up to 256 numbers, as most frames have them, need no memory of their own.
const INLINE_WORDS: usize = 4;

/// A set of numbers below a fixed size, 64 of them in a word.
///
/// Sets that meet in one operation have one size.
///
/// ```
/// use jrdb_graph::BitSet;
/// let mut even = BitSet::new(100);
/// (0..100).step_by(2).for_each(|number| even.insert(number));
/// assert_eq!(even.count(), 50);
/// assert!(even.contains(4) && !even.contains(5) && !even.contains(1000));
/// ```
#[derive(PartialEq, Eq, Default)]
pub struct BitSet {
    words: SmallVec<[u64; INLINE_WORDS]>,
    size: usize,
}

impl Clone for BitSet {
    /// Copies the words at once: the derived one copies them one by one.
    #[inline]
    fn clone(&self) -> Self {
        Self { words: SmallVec::from_slice(&self.words), size: self.size }
    }
}

impl BitSet {
    /// No number below `size`.
    #[must_use]
    #[inline]
    pub fn new(size: usize) -> Self {
        Self { words: smallvec![0; size.div_ceil(BITS)], size }
    }

    /// Every number below `count`, of those below `size`.
    #[must_use]
    pub fn below(count: usize, size: usize) -> Self {
        let mut set = Self::new(size);
        let (whole, rest) = (count.min(size) / BITS, count.min(size) % BITS);
        set.words[..whole].fill(u64::MAX);
        if rest > 0 {
            set.words[whole] = (1 << rest) - 1;
        }
        set
    }

    /// How many numbers there could be.
    #[must_use]
    #[inline]
    pub fn size(&self) -> usize {
        self.size
    }

    /// The words, lowest numbers first.
    #[must_use]
    #[inline]
    pub fn words(&self) -> &[u64] {
        &self.words
    }

    /// The words, to be changed; bits at and beyond the size must stay 0.
    #[must_use]
    #[inline]
    pub fn words_mut(&mut self) -> &mut [u64] {
        &mut self.words
    }

    /// Puts a number in; one beyond the size is left out.
    #[inline]
    pub fn insert(&mut self, number: usize) {
        if number < self.size {
            self.words[number / BITS] |= 1 << (number % BITS);
        }
    }

    /// Takes a number out.
    #[inline]
    pub fn remove(&mut self, number: usize) {
        if number < self.size {
            self.words[number / BITS] &= !(1 << (number % BITS));
        }
    }

    /// Whether a number is in.
    #[inline]
    #[must_use]
    pub fn contains(&self, number: usize) -> bool {
        self.words.get(number / BITS).is_some_and(|word| word >> (number % BITS) & 1 == 1)
    }

    /// How many are in.
    #[must_use]
    pub fn count(&self) -> usize {
        self.words.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// Whether none is in.
    #[inline]
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.words.iter().all(|&word| word == 0)
    }

    /// Adds those of another set.
    #[inline]
    pub fn unite(&mut self, other: &Self) {
        self.combine(other, |mine, theirs| mine | theirs);
    }

    /// Keeps only those that another set has too.
    #[inline]
    pub fn intersect(&mut self, other: &Self) {
        self.combine(other, |mine, theirs| mine & theirs);
    }

    /// Takes out those of another set.
    #[inline]
    pub fn subtract(&mut self, other: &Self) {
        self.combine(other, |mine, theirs| mine & !theirs);
    }

    #[inline]
    fn combine(&mut self, other: &Self, with: impl Fn(u64, u64) -> u64) {
        for (mine, &theirs) in self.words.iter_mut().zip(&other.words) {
            *mine = with(*mine, theirs);
        }
    }

    /// Keeps those for which something holds.
    #[inline]
    pub fn retain(&mut self, mut holds: impl FnMut(usize) -> bool) {
        for (place, word) in self.words.iter_mut().enumerate() {
            let mut rest = *word;
            while rest != 0 {
                let bit = rest.trailing_zeros() as usize;
                rest &= rest - 1;
                if !holds(place * BITS + bit) {
                    *word &= !(1 << bit);
                }
            }
        }
    }

    /// Those that are in, in ascending order.
    pub fn iter(&self) -> impl Iterator<Item = usize> + '_ {
        self.words.iter().enumerate().flat_map(|(place, &word)| {
            std::iter::successors((word != 0).then_some(word), |rest| {
                let rest = rest & (rest - 1);
                (rest != 0).then_some(rest)
            })
            .map(move |rest| place * BITS + rest.trailing_zeros() as usize)
        })
    }
}

impl fmt::Debug for BitSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_set().entries(self.iter()).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(numbers: &[usize]) -> BitSet {
        let mut set = BitSet::new(200);
        numbers.iter().for_each(|&number| set.insert(number));
        set
    }

    #[test]
    fn sets_combine_across_word_bounds() {
        let (mut a, b) = (set(&[0, 63, 64, 130]), set(&[63, 64, 199]));
        a.unite(&b);
        assert_eq!(a.iter().collect::<Vec<_>>(), [0, 63, 64, 130, 199]);
        a.subtract(&set(&[0, 130]));
        assert_eq!(a, b);
        a.intersect(&set(&[64]));
        assert_eq!(a, set(&[64]));
    }

    #[test]
    fn the_first_ones_are_those_below_a_number_and_the_size() {
        assert_eq!(BitSet::below(65, 130).count(), 65);
        assert_eq!(BitSet::below(64, 64).iter().last(), Some(63));
        assert_eq!(BitSet::below(500, 130).count(), 130);
        assert_eq!(BitSet::below(0, 0), BitSet::new(0));
    }

    #[test]
    fn retaining_asks_of_members_only() {
        let (mut kept, mut asked) = (set(&[1, 70, 71]), Vec::new());
        kept.retain(|number| {
            asked.push(number);
            number != 70
        });
        assert_eq!((kept, asked), (set(&[1, 71]), vec![1, 70, 71]));
    }

    #[test]
    fn numbers_beyond_the_size_stay_out() {
        let mut small = BitSet::new(3);
        small.insert(3);
        small.remove(70);
        assert!(small.is_empty() && !small.contains(3));
    }
}
