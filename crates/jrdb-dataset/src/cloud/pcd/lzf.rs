//! LZF, the compression of `binary_compressed` point clouds.
//!
//! A stream is a list of chunks. A control byte under 32 is followed by that many plus one bytes to
//! copy. Otherwise its upper three bits are a length less two (7: the next byte is added) and its
//! lower five bits, with one more byte, a distance less one into what was already written.

/// Most bytes that one byte of a stream can stand for: 264 from a chunk of three.
pub(crate) const MAX_RATIO: usize = 88;

const MAX_LITERALS: usize = 32;
const MIN_MATCH: usize = 3;
const MAX_MATCH: usize = 264;
const MAX_DISTANCE: usize = 1 << 13;
const LONG_MATCH: u8 = 7;
const HASH_BITS: u32 = 14;

/// Bytes of a match that are copied at once where there is room; what is too much is written over later. Most
/// matches of floats are shorter.
const STEP: usize = 8;

/// A stream and how far it is decompressed.
pub(crate) struct Decompressor<'a> {
    rest: &'a [u8],
    out: &'a mut [u8],
    /// Bytes of `out` that are written; a copy may have written a little beyond them.
    at: usize,
    expected: usize,
}

impl<'a> Decompressor<'a> {
    /// Of a stream that should stand for `expected` bytes, of which the first `wanted` may be asked for. Nothing is
    /// allocated for an expectation that the stream cannot fulfil.
    ///
    /// They are written to `block`, whose memory is used again.
    pub(crate) fn new(
        stream: &'a [u8],
        expected: usize,
        wanted: usize,
        block: &'a mut Vec<u8>,
    ) -> Option<Self> {
        if expected > stream.len().saturating_mul(MAX_RATIO) {
            return None;
        }
        // A copy may write a little beyond what is wanted.
        block.resize(expected.min(wanted.saturating_add(MAX_MATCH + MAX_LITERALS)), 0);
        Some(Self { rest: stream, out: block, at: 0, expected })
    }

    /// The first `wanted` bytes; what the stream says beyond them is not looked at. When they are all that is
    /// expected, the stream must stand for exactly so many.
    pub(crate) fn first(&mut self, wanted: usize) -> Option<&[u8]> {
        let stop = if wanted < self.expected { wanted } else { usize::MAX };
        let (mut rest, mut at, out) = (self.rest, self.at, &mut *self.out);
        while let [control, after @ ..] = rest {
            if at >= stop {
                break;
            }
            let high = control >> 5;
            if high == 0 {
                let length = usize::from(*control) + 1;
                copy_literals(after, length, out, at)?;
                rest = after.get(length..)?;
                at += length;
            } else {
                let (more, after) = match high {
                    LONG_MATCH => {
                        after.split_first().map(|(&more, after)| (usize::from(more), after))?
                    }
                    _ => (0, after),
                };
                let (&low, after) = after.split_first()?;
                let length = usize::from(high) + more + 2;
                let distance = (usize::from(control & 0x1f) << 8 | usize::from(low)) + 1;
                copy_match(length, distance, out, at)?;
                rest = after;
                at += length;
            }
        }
        (self.rest, self.at) = (rest, at);
        let is_enough = if wanted < self.expected { at >= wanted } else { at == self.expected };
        if is_enough { self.out.get(..wanted) } else { None }
    }
}

// The three copies are inlined by force: as calls they take a third longer.
#[inline(always)]
fn copy_literals(stream: &[u8], length: usize, out: &mut [u8], at: usize) -> Option<()> {
    let room = out.get_mut(at..)?;
    match (room.first_chunk_mut::<MAX_LITERALS>(), stream.first_chunk()) {
        (Some(room), Some(literals)) => *room = *literals, // what is too much is written over later
        _ => room.get_mut(..length)?.copy_from_slice(stream.get(..length)?),
    }
    Some(())
}

#[inline(always)]
fn copy_match(length: usize, distance: usize, out: &mut [u8], at: usize) -> Option<()> {
    let start = at.checked_sub(distance)?;
    let end = at + length;
    if distance >= STEP && end + STEP <= out.len() {
        copy_step(out, start, at)?;
        let mut done = STEP;
        while done < length {
            copy_step(out, start + done, at + done)?;
            done += STEP;
        }
    } else {
        let (from, to) = out.get_mut(start..end)?.split_at_mut_checked(distance)?;
        // A match may overlap what it writes: it goes round in what was there before.
        for (to, from) in to.iter_mut().zip(from.iter().cycle()) {
            *to = *from;
        }
    }
    Some(())
}

#[inline(always)]
fn copy_step(out: &mut [u8], from: usize, to: usize) -> Option<()> {
    let bytes: [u8; STEP] = *out.get(from..)?.first_chunk()?;
    *out.get_mut(to..)?.first_chunk_mut()? = bytes;
    Some(())
}

/// A stream that stands for the bytes. Greedy: takes the latest earlier place with the same three bytes.
pub(crate) fn compress(bytes: &[u8]) -> Vec<u8> {
    let mut out = Vec::with_capacity(bytes.len());
    let mut latest = vec![usize::MAX; 1 << HASH_BITS];
    let (mut at, mut literals_from) = (0, 0);
    while at + MIN_MATCH <= bytes.len() {
        let slot = &mut latest[hash(&bytes[at..at + MIN_MATCH])];
        let earlier = std::mem::replace(slot, at);
        let length = match_length(bytes, earlier, at);
        if length < MIN_MATCH {
            at += 1;
            continue;
        }
        push_literals(&bytes[literals_from..at], &mut out);
        push_match(length, at - earlier, &mut out);
        at += length;
        literals_from = at;
    }
    push_literals(&bytes[literals_from..], &mut out);
    out
}

fn hash(three: &[u8]) -> usize {
    let value = three.iter().fold(0_u32, |value, &byte| value << 8 | u32::from(byte));
    (value.wrapping_mul(0x9e37_79b1) >> (u32::BITS - HASH_BITS)) as usize
}

fn match_length(bytes: &[u8], earlier: usize, at: usize) -> usize {
    if earlier >= at || at - earlier > MAX_DISTANCE {
        return 0;
    }
    let pairs = bytes[at..].iter().zip(&bytes[earlier..]).take(MAX_MATCH);
    pairs.take_while(|(a, b)| a == b).count()
}

fn push_literals(literals: &[u8], out: &mut Vec<u8>) {
    for run in literals.chunks(MAX_LITERALS) {
        out.push((run.len() - 1) as u8);
        out.extend_from_slice(run);
    }
}

fn push_match(length: usize, distance: usize, out: &mut Vec<u8>) {
    let (length, distance) = (length - 2, distance - 1);
    let high = (distance >> 8) as u8;
    if length < usize::from(LONG_MATCH) {
        out.push((length as u8) << 5 | high);
    } else {
        out.push(LONG_MATCH << 5 | high);
        out.push((length - usize::from(LONG_MATCH)) as u8);
    }
    out.push(distance as u8);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a stream stands for, from a block that held something else before.
    fn all_of(stream: &[u8], expected: usize, wanted: usize) -> Option<Vec<u8>> {
        let mut block = vec![0xaa; 700];
        let mut decompressor = Decompressor::new(stream, expected, wanted, &mut block)?;
        // Piece by piece or at once, it is the same.
        for part in [wanted / 3, wanted / 2].into_iter().filter(|part| *part < wanted) {
            decompressor.first(part)?;
        }
        decompressor.first(wanted).map(<[u8]>::to_vec)
    }
    use proptest::prelude::*;

    #[test]
    fn a_known_stream_is_read_as_the_format_says() {
        // "ab", then 5 bytes from 2 back, then "c", then 9 + 3 bytes from 1 back.
        let stream = [1, b'a', b'b', 3 << 5, 1, 0, b'c', 7 << 5, 3, 0];
        let bytes = all_of(&stream, 20, 20).unwrap();
        assert_eq!(bytes, b"abababacccccccccccccc"[..20]);
    }

    #[test]
    fn streams_that_break_off_or_reach_back_too_far_are_refused() {
        for stream in [&[5, 1][..], &[1 << 5], &[7 << 5, 1], &[1 << 5, 0], &[0, 9, 1 << 5, 1]] {
            for expected in 0..12 {
                assert_eq!(all_of(stream, expected, expected), None, "{stream:?}");
            }
        }
    }

    #[test]
    fn a_hostile_length_is_refused_before_it_is_allocated() {
        assert_eq!(all_of(&[0, 1], usize::MAX, usize::MAX), None);
        assert_eq!(all_of(&[0, 1], 2, 2), None);
    }

    #[test]
    fn repetition_shrinks() {
        let compressed = compress(&[7; 10_000]);
        assert!(compressed.len() < 10_000 / 80, "{}", compressed.len());
    }

    proptest! {
        #[test]
        fn the_first_bytes_are_those_of_the_whole(
            bytes in prop::collection::vec(0..4_u8, 1..3000), wanted in any::<prop::sample::Index>(),
        ) {
            let wanted = wanted.index(bytes.len());
            let first = all_of(&compress(&bytes), bytes.len(), wanted).unwrap();
            prop_assert_eq!(&first[..wanted], &bytes[..wanted]);
        }

        #[test]
        fn random_streams_read_in_part_never_panic(
            stream in prop::collection::vec(any::<u8>(), 0..300), expected in 0..20_000_usize, wanted in 0..20_000_usize,
        ) {
            if let Some(bytes) = all_of(&stream, expected, wanted.min(expected)) {
                prop_assert!(bytes.len() >= wanted.min(expected));
            }
        }

        #[test]
        fn decompressing_undoes_compressing(bytes in prop::collection::vec(0..4_u8, 0..3000)) {
            prop_assert_eq!(all_of(&compress(&bytes), bytes.len(), bytes.len()).unwrap(), bytes);
        }

        #[test]
        fn decompressing_undoes_compressing_noise(bytes in prop::collection::vec(any::<u8>(), 0..600), times in 1..40_usize) {
            let bytes = bytes.repeat(times);
            prop_assert_eq!(all_of(&compress(&bytes), bytes.len(), bytes.len()).unwrap(), bytes);
        }

        #[test]
        fn random_streams_never_panic(stream in prop::collection::vec(any::<u8>(), 0..300), expected in 0..20_000_usize) {
            if let Some(bytes) = all_of(&stream, expected, expected) {
                prop_assert_eq!(bytes.len(), expected);
            }
        }
    }
}
