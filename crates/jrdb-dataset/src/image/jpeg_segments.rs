//! The segments of a JPEG: what its header says, and how a tolerant reader mends it.

use std::borrow::Cow;

use super::exif::check_upright;
use crate::image_error::ImageError;

/// Markers, without the 0xff before them.
pub(super) const START_OF_IMAGE: u8 = 0xd8;
pub(super) const END_OF_IMAGE: u8 = 0xd9;
const START_OF_SCAN: u8 = 0xda;
const HUFFMAN_TABLES: u8 = 0xc4;
const EXIF: u8 = 0xe1;
/// Frames whose coefficients are coded in one pass, and in several.
const SEQUENTIAL: [u8; 2] = [0xc0, 0xc1];
const PROGRESSIVE: u8 = 0xc2;
/// Markers below are reserved: between segments they are stray bytes.
const FIRST_MARKER: u8 = 0xc0;
/// Markers of restarts stand inside a scan.
const RESTARTS: std::ops::RangeInclusive<u8> = 0xd0..=0xd7;

const EXIF_NAME: &[u8] = b"Exif\0\0";
/// Length of the scan's last spectral coefficient and approximation, at the end of its header.
const SCAN_TAIL: usize = 3;
/// Coefficients of a block.
const COEFFICIENTS: usize = 64;

/// An APP0 segment as in the frames of an MJPEG stream: decoders then take the standard Huffman tables for those that
/// are absent (JPEG standard, tables K.3 to K.6).
const MJPEG_SEGMENT: [u8; 18] =
    [0xff, 0xe0, 0, 16, b'A', b'V', b'I', b'1', 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];

/// A segment: its marker, and where it and its data are.
struct Segment {
    marker: u8,
    start: usize,
    data: std::ops::Range<usize>,
}

/// The bytes as a strict decoder takes them: without stray bytes between the segments before the first scan, and with the
/// standard Huffman tables where the file has none.
///
/// # Errors
/// [`ImageError::Turned`].
pub(super) fn mended(bytes: &[u8]) -> Result<Cow<'_, [u8]>, ImageError> {
    let (mut kept, mut is_whole, mut tables, mut is_sequential) = (vec![], true, vec![], false);
    let mut end = 2;
    for segment in Segments::new(bytes) {
        is_whole &= segment.start == end;
        end = segment.data.end;
        let data = &bytes[segment.data.clone()];
        match segment.marker {
            EXIF => data.strip_prefix(EXIF_NAME).map_or(Ok(()), check_upright)?,
            HUFFMAN_TABLES => tables.extend(tables_in(data)),
            marker if SEQUENTIAL.contains(&marker) => is_sequential = true,
            START_OF_SCAN => {
                let is_absent = |table: &u8| !tables.contains(table);
                let lacks_tables = is_sequential && tables_of_scan(data).iter().any(is_absent);
                if is_whole && !lacks_tables {
                    return Ok(Cow::Borrowed(bytes));
                }
                return Ok(Cow::Owned(rebuilt(bytes, &kept, segment.start, lacks_tables)));
            }
            _ => {}
        }
        kept.push(segment.start..segment.data.end);
    }
    // No scan: the decoder says what is wrong.
    Ok(Cow::Borrowed(bytes))
}

/// The tables that a segment defines: class (0 for DC, 1 for AC) in the upper half of a byte, number in the lower.
fn tables_in(mut data: &[u8]) -> Vec<u8> {
    const COUNTS: usize = 16;
    let mut found = Vec::new();
    while let Some((&table, rest)) = data.split_first() {
        found.push(table);
        let values: usize = rest.iter().take(COUNTS).map(|count| usize::from(*count)).sum();
        data = rest.get(COUNTS + values..).unwrap_or_default();
    }
    found
}

/// The tables that a scan's components take, in the same form.
fn tables_of_scan(data: &[u8]) -> Vec<u8> {
    let Some((&count, rest)) = data.split_first() else { return Vec::new() };
    let selectors = rest.chunks_exact(2).take(usize::from(count)).map(|pair| pair[1]);
    selectors.flat_map(|tables| [tables >> 4, 0x10 | (tables & 0x0f)]).collect()
}

fn rebuilt(
    bytes: &[u8],
    kept: &[std::ops::Range<usize>],
    scan: usize,
    lacks_tables: bool,
) -> Vec<u8> {
    let mut whole = bytes[..2].to_vec();
    if lacks_tables {
        whole.extend(MJPEG_SEGMENT);
    }
    kept.iter().for_each(|range| whole.extend(&bytes[range.clone()]));
    whole.extend(&bytes[scan..]);
    whole
}

/// Whether the scans that have begun bring every coefficient of every component to its last bit, which is so for every
/// sequential picture whose scan has begun. A progressive picture that breaks off earlier lacks whole scans.
pub(super) fn last_scan_has_begun(bytes: &[u8]) -> bool {
    let mut components = 0;
    let mut done: Vec<(u8, [bool; COEFFICIENTS])> = Vec::new();
    let mut is_progressive = false;
    for segment in Segments::new(bytes) {
        let data = &bytes[segment.data];
        match segment.marker {
            PROGRESSIVE => {
                is_progressive = true;
                components = data.get(5).copied().map_or(0, usize::from);
            }
            START_OF_SCAN if !is_progressive => return true,
            START_OF_SCAN => note_scan(data, &mut done),
            _ => {}
        }
    }
    let is_done = |(_, bits): &(u8, [bool; COEFFICIENTS])| bits.iter().all(|is_done| *is_done);
    is_progressive && components > 0 && done.iter().filter(|one| is_done(one)).count() >= components
}

/// Notes which coefficients a progressive scan brings to their last bit.
fn note_scan(data: &[u8], done: &mut Vec<(u8, [bool; COEFFICIENTS])>) {
    let Some((&count, rest)) = data.split_first() else { return };
    let selectors = 2 * usize::from(count);
    let Some(&[first, last, approximation]) =
        rest.get(selectors..).and_then(|t| t.get(..SCAN_TAIL))
    else {
        return;
    };
    let is_last_bit = approximation & 0x0f == 0;
    for selector in rest[..selectors].chunks_exact(2).map(|pair| pair[0]) {
        let at = done.iter().position(|(id, _)| *id == selector).unwrap_or_else(|| {
            done.push((selector, [false; COEFFICIENTS]));
            done.len() - 1
        });
        let last = usize::from(last).min(COEFFICIENTS - 1);
        let range = usize::from(first).min(last)..=last;
        if is_last_bit {
            done[at].1[range].fill(true);
        }
    }
}

/// The segments of a JPEG, in order; what is between them is passed over, and a scan's pixels, too.
struct Segments<'b> {
    bytes: &'b [u8],
    at: usize,
}

impl<'b> Segments<'b> {
    fn new(bytes: &'b [u8]) -> Self {
        Self { bytes, at: 2 }
    }
}

impl Iterator for Segments<'_> {
    type Item = Segment;

    fn next(&mut self) -> Option<Segment> {
        loop {
            let pair = self.bytes.get(self.at..self.at + 2)?;
            let (start, marker) = (self.at, pair[1]);
            let is_marker = pair[0] == 0xff && marker >= FIRST_MARKER && marker != 0xff;
            if !is_marker || RESTARTS.contains(&marker) || marker == START_OF_IMAGE {
                self.at += 1;
                continue;
            }
            if marker == END_OF_IMAGE {
                return None;
            }
            let length = self.bytes.get(start + 2..start + 4)?;
            let length = usize::from(u16::from_be_bytes([length[0], length[1]]));
            let data = start + 4..start + 2 + length;
            if length < 2 || self.bytes.len() < data.end {
                return None;
            }
            self.at = data.end;
            return Some(Segment { marker, start, data });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::exif::tests::tiff;
    use super::*;

    const GRADIENT: &[u8] = include_bytes!("../../testdata/gradient.jpg");
    const PROGRESSIVE_GRADIENT: &[u8] = include_bytes!("../../testdata/gradient_progressive.jpg");

    fn at(bytes: &[u8], marker: u8) -> usize {
        bytes.windows(2).position(|pair| pair == [0xff, marker]).unwrap()
    }

    #[test]
    fn a_sound_jpeg_is_taken_as_it_is() {
        for bytes in [GRADIENT, PROGRESSIVE_GRADIENT] {
            assert!(matches!(mended(bytes).unwrap(), Cow::Borrowed(same) if same == bytes));
            assert!(last_scan_has_begun(bytes));
        }
    }

    #[test]
    fn stray_bytes_between_segments_are_left_out() {
        for junk in [&[0x11, 0x22, 0x33][..], &[0; 40], &[0xff, 0x02, 0x07], &[0xff, 0xff]] {
            let place = at(GRADIENT, 0xc0);
            let dirty = [&GRADIENT[..place], junk, &GRADIENT[place..]].concat();
            assert_eq!(mended(&dirty).unwrap(), GRADIENT, "{junk:?}");
        }
    }

    #[test]
    fn a_jpeg_without_some_of_its_tables_gets_the_standard_ones() {
        let all: Vec<usize> = (0..GRADIENT.len() - 1)
            .filter(|i| GRADIENT[*i..*i + 2] == [0xff, HUFFMAN_TABLES])
            .collect();
        for first in all {
            let length = u16::from_be_bytes([GRADIENT[first + 2], GRADIENT[first + 3]]);
            let rest = &GRADIENT[first + 2 + usize::from(length)..];
            let bare = [&GRADIENT[..first], rest].concat();
            let mended = mended(&bare).unwrap();
            assert_eq!(mended.len(), bare.len() + MJPEG_SEGMENT.len());
            assert_eq!(mended[2..20], MJPEG_SEGMENT);
        }
    }

    #[test]
    fn a_turned_jpeg_is_refused() {
        let data = [EXIF_NAME, &tiff(3, b"II*\0")].concat();
        let length = u16::try_from(data.len() + 2).unwrap().to_be_bytes();
        let turned = [&GRADIENT[..2], &[0xff, EXIF], &length, &data, &GRADIENT[2..]].concat();
        assert!(matches!(mended(&turned), Err(ImageError::Turned { orientation: 3 })));
    }

    #[test]
    fn a_progressive_picture_without_its_last_scan_is_known() {
        let scans: Vec<usize> = (0..PROGRESSIVE_GRADIENT.len() - 1)
            .filter(|i| PROGRESSIVE_GRADIENT[*i..*i + 2] == [0xff, START_OF_SCAN])
            .collect();
        let last = *scans.last().unwrap();
        assert!(!last_scan_has_begun(&PROGRESSIVE_GRADIENT[..last]));
        assert!(last_scan_has_begun(&PROGRESSIVE_GRADIENT[..last + 20]));
    }
}
