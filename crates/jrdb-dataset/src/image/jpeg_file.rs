//! JPEG files, baseline and progressive, also those that break off shortly before their end.

use std::borrow::Cow;
use std::io::Cursor;

use jrdb_types::contained;
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use super::decoded::Decoded;
use super::jpeg_segments::{END_OF_IMAGE, START_OF_IMAGE, last_scan_has_begun, mended};
use super::size::check_size;
use crate::image_error::ImageError;

/// First bytes of a JPEG.
pub(super) const MAGIC: &[u8] = &[0xff, START_OF_IMAGE, 0xff];
/// What a complete JPEG ends with, perhaps followed by a few bytes of padding.
pub(super) const END: &[u8] = &[0xff, END_OF_IMAGE];

const FORMAT: &str = "jpeg";
/// Name of the decoder in messages.
const DECODER: &str = "the jpeg decoder";
/// Longest side that a JPEG header can state.
const MAX_SIDE: usize = 65_535;
/// A JPEG that breaks off is used when it has at least this part of its rows.
const ROWS_MIN: [usize; 2] = [3, 4];
/// What is remarked on when only the end is absent.
const NO_END: &str = "the jpeg breaks off: its end marker is absent; all its rows are used";
/// Grey of the rows that are absent.
const ABSENT: u8 = 128;
/// Bytes that are appended in place of what is absent: any bits that no encoder would have written.
const NOISE: [u8; 64] = noise();
/// How often.
const NOISE_REPEATS: usize = 8;

const fn noise() -> [u8; 64] {
    let (mut bytes, mut state, mut at) = ([0; 64], 0x2545_u32, 0);
    while at < bytes.len() {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        // Never 0xff, which begins a marker.
        bytes[at] = (state >> 24) as u8 & 0x7f;
        at += 1;
    }
    bytes
}

/// Columns and rows as the header states them.
pub(super) fn size(bytes: &[u8]) -> Result<[usize; 2], ImageError> {
    let bytes = mended(bytes)?;
    let header = contained(DECODER, || Ok(decoder(&bytes, Tolerance::Strict)?.1));
    header.map_err(ImageError::malformed(FORMAT))?
}

/// Decodes the picture. One that breaks off is decoded as far as it goes, if that is most of it.
pub(super) fn decode(bytes: &[u8]) -> Result<Decoded, ImageError> {
    let bytes = mended(bytes)?;
    match pixels(&bytes, Tolerance::Strict) {
        Ok((size, rgb)) => {
            let remark = breaks_off(&bytes).then(|| NO_END.to_owned());
            Ok(Decoded::new(size, rgb, remark))
        }
        Err(error) if breaks_off(&bytes) => as_far_as_it_goes(&bytes).unwrap_or(Err(error)),
        Err(error) => Err(error),
    }
}

/// How a decoder treats what is not as the standard says.
#[derive(Clone, Copy, PartialEq)]
enum Tolerance {
    Strict,
    Tolerant,
}

type Decoder<'b> = JpegDecoder<Cursor<&'b [u8]>>;

fn decoder(bytes: &[u8], tolerance: Tolerance) -> Result<(Decoder<'_>, [usize; 2]), ImageError> {
    let options = DecoderOptions::default()
        .set_strict_mode(tolerance == Tolerance::Strict)
        .set_max_width(MAX_SIDE)
        .set_max_height(MAX_SIDE)
        .jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = JpegDecoder::new_with_options(Cursor::new(bytes), options);
    decoder.decode_headers().map_err(|error| ImageError::malformed(FORMAT)(Box::new(error)))?;
    let (width, height) = decoder.dimensions().unwrap_or_default();
    check_size([width, height], bytes.len())?;
    Ok((decoder, [width, height]))
}

fn pixels(bytes: &[u8], tolerance: Tolerance) -> Result<([usize; 2], Vec<u8>), ImageError> {
    let decode = || {
        let (mut decoder, size) = decoder(bytes, tolerance)?;
        let rgb = decoder.decode();
        let rgb = rgb.map_err(|error| ImageError::malformed(FORMAT)(Box::new(error)))?;
        if rgb.len() != 3 * size[0] * size[1] {
            let found = format!("{} samples for {} x {} rgb pixels", rgb.len(), size[0], size[1]);
            return Err(ImageError::malformed(FORMAT)(found));
        }
        Ok((size, rgb))
    };
    contained(DECODER, decode).map_err(ImageError::malformed(FORMAT))?
}

fn breaks_off(bytes: &[u8]) -> bool {
    !bytes.windows(END.len()).rev().take(TAIL_BYTES).any(|pair| pair == END)
}

/// Where the end is looked for, bytes from the last.
const TAIL_BYTES: usize = 64;

/// The picture with the rows that the file still has; nothing when its scans do not reach them all.
///
/// The rows that are there do not depend on what follows: two endings are tried, and the rows that differ are absent.
fn as_far_as_it_goes(bytes: &[u8]) -> Option<Result<Decoded, ImageError>> {
    if !last_scan_has_begun(bytes) {
        return None;
    }
    let whole = bytes.strip_suffix(&[0xff]).unwrap_or(bytes);
    let ended = |ending: &[u8]| -> Cow<'_, [u8]> { [whole, ending, END].concat().into() };
    let noise: Vec<u8> = NOISE.repeat(NOISE_REPEATS);
    let (size, mut rgb) = pixels(&ended(&[]), Tolerance::Tolerant).ok()?;
    let (_, other) = pixels(&ended(&noise), Tolerance::Tolerant).ok()?;
    let row_bytes = 3 * size[0];
    let mut pairs = rgb.chunks_exact(row_bytes).zip(other.chunks_exact(row_bytes));
    let rows = pairs.position(|(one, two)| one != two).unwrap_or(size[1]);
    if rows * ROWS_MIN[1] < size[1] * ROWS_MIN[0] {
        let [part, of] = ROWS_MIN;
        let found = format!(
            "it breaks off: expected at least {part}/{of} of its {} rows, found {rows}",
            size[1]
        );
        return Some(Err(ImageError::malformed(FORMAT)(found)));
    }
    rgb[rows * row_bytes..].fill(ABSENT);
    let remark = format!(
        "the jpeg breaks off: {rows} of its {} rows are used, the others are grey",
        size[1]
    );
    Some(Ok(Decoded::new(size, rgb, Some(remark))))
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRADIENT: &[u8] = include_bytes!("../../testdata/gradient.jpg");
    const PROGRESSIVE: &[u8] = include_bytes!("../../testdata/gradient_progressive.jpg");

    fn without_end(bytes: &[u8]) -> &[u8] {
        let end = bytes.windows(2).rposition(|pair| pair == END).unwrap();
        &bytes[..end]
    }

    #[test]
    fn a_jpeg_without_its_end_is_used_and_remarked_on() {
        for bytes in [GRADIENT, PROGRESSIVE] {
            let whole = decode(bytes).unwrap();
            let short = decode(without_end(bytes)).unwrap();
            let remark = short.remark.unwrap();
            assert!(remark.starts_with("the jpeg breaks off: "), "{remark}");
            let same = whole.image.rgb.iter().zip(&short.image.rgb).filter(|(a, b)| a == b);
            assert!(same.count() * 4 >= whole.image.rgb.len() * 3);
        }
    }

    #[test]
    fn half_a_jpeg_is_refused() {
        for bytes in [GRADIENT, PROGRESSIVE] {
            assert!(decode(&bytes[..bytes.len() / 2 + 60]).is_err() || bytes.len() < 120);
        }
    }

    #[test]
    fn a_frame_of_a_stream_takes_the_standard_tables() {
        let standard = include_bytes!("../../testdata/gradient.jpg");
        let mut bare = standard.to_vec();
        while let Some(at) = bare.windows(2).position(|pair| pair == [0xff, 0xc4]) {
            let length = usize::from(u16::from_be_bytes([bare[at + 2], bare[at + 3]]));
            bare.drain(at..at + 2 + length);
        }
        // The test picture's own tables may be others: it must be decoded, not look the same.
        let found = decode(&bare);
        assert!(size(&bare).unwrap() == [37, 21] && !is_missing_tables(&found));
    }

    fn is_missing_tables(found: &Result<Decoded, ImageError>) -> bool {
        found.as_ref().is_err_and(|error| {
            let text = jrdb_types::with_causes(error).to_lowercase();
            text.contains("huffman table")
        })
    }
}
