//! PNG files.

use std::io::Cursor;

use jrdb_types::contained;

use super::decoded::Decoded;
use super::exif::check_upright;
use super::size::check_size;
use crate::image_error::ImageError;

/// First bytes of a PNG.
pub(super) const MAGIC: &[u8] = b"\x89PNG\r\n\x1a\n";
/// What a complete PNG ends with, perhaps followed by a few bytes of padding.
pub(super) const END: &[u8] = b"IEND";

const FORMAT: &str = "png";
/// Name of the decoder in messages.
const DECODER: &str = "the png decoder";
/// Bytes that the PNG decoder may use for itself: text, palettes, and a few rows.
const WORKING_BYTES: usize = 1 << 26;
/// Bytes of a chunk around its data: length and name before, checksum behind.
const CHUNK_HEAD: usize = 8;
const CHUNK_TAIL: usize = 4;
/// Bytes of a palette's colour.
const COLOR_BYTES: usize = 3;
/// One above the largest number of 12 bits: what such a camera writes into 16 bits is nearly black.
const TWELVE_BITS: u16 = 1 << 12;

type Reader<'b> = png::Reader<Cursor<&'b [u8]>>;

/// Columns and rows as the header states them.
pub(super) fn size(bytes: &[u8]) -> Result<[usize; 2], ImageError> {
    contained(DECODER, || Ok(size_of(&reader(bytes)?))).map_err(ImageError::malformed(FORMAT))?
}

/// Decodes the picture, or the first of an animation.
pub(super) fn decode(bytes: &[u8]) -> Result<Decoded, ImageError> {
    contained(DECODER, || pixels(bytes)).map_err(ImageError::malformed(FORMAT))?
}

fn pixels(bytes: &[u8]) -> Result<Decoded, ImageError> {
    let mut reader = reader(bytes)?;
    let (color, depth) = reader.output_color_type();
    let (channels, size) = (color.samples(), size_of(&reader));
    let sample_bytes = if depth == png::BitDepth::Sixteen { 2 } else { 1 };
    let mut samples = vec![0; sample_bytes * channels * size[0] * size[1]];
    reader.next_frame(&mut samples).map_err(ImageError::malformed(FORMAT))?;
    let mut remark = None;
    if depth == png::BitDepth::Sixteen {
        remark = remark_on_depth(&samples);
        samples = samples.chunks_exact(2).map(|sample| sample[0]).collect();
    }
    Ok(Decoded::new(size, rgb_from_channels(samples, channels), remark))
}

fn size_of(reader: &Reader<'_>) -> [usize; 2] {
    [reader.info().width as usize, reader.info().height as usize]
}

fn reader(bytes: &[u8]) -> Result<Reader<'_>, ImageError> {
    check_chunks(bytes)?;
    let limits = png::Limits { bytes: WORKING_BYTES };
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(bytes), limits);
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    let header = decoder.read_header_info().map_err(ImageError::malformed(FORMAT))?;
    let is_deep = header.bit_depth == png::BitDepth::Sixteen;
    decoder.set_transformations(match is_deep {
        true => png::Transformations::EXPAND,
        false => png::Transformations::normalize_to_color8(),
    });
    let reader = decoder.read_info().map_err(ImageError::malformed(FORMAT))?;
    check_size(size_of(&reader), bytes.len())?;
    Ok(reader)
}

/// Looks at the chunks before the pixels: a palette whose length is no multiple of 3 panics in the decoder's version
/// 0.18.1, and a turned picture is not for us.
fn check_chunks(bytes: &[u8]) -> Result<(), ImageError> {
    let mut rest = bytes.get(MAGIC.len()..).unwrap_or_default();
    while let Some((head, behind)) = rest.split_first_chunk::<CHUNK_HEAD>() {
        let [a, b, c, d, name @ ..] = *head;
        let length = u32::from_be_bytes([a, b, c, d]) as usize;
        let Some(data) = behind.get(..length) else { break };
        match &name {
            b"PLTE" if !length.is_multiple_of(COLOR_BYTES) => {
                let found = format!(
                    "expected {COLOR_BYTES} bytes per colour, found {length} bytes in PLTE"
                );
                return Err(ImageError::malformed(FORMAT)(found));
            }
            b"eXIf" => check_upright(data)?,
            b"IDAT" | b"IEND" => break,
            _ => {}
        }
        rest = behind.get(length + CHUNK_TAIL..).unwrap_or_default();
    }
    Ok(())
}

fn remark_on_depth(samples: &[u8]) -> Option<String> {
    let values = samples.chunks_exact(2).map(|sample| u16::from_be_bytes([sample[0], sample[1]]));
    let brightest = values.max()?;
    let is_dark = brightest > 0 && brightest < TWELVE_BITS;
    is_dark.then(|| {
        format!(
            "16-bit samples of at most {brightest}, as a 12-bit camera writes them: the upper 8 bits \
             are used, so the picture is nearly black; multiply the samples by 16"
        )
    })
}

fn rgb_from_channels(samples: Vec<u8>, channels: usize) -> Vec<u8> {
    match channels {
        1 | 2 => samples.chunks_exact(channels).flat_map(|pixel| [pixel[0]; 3]).collect(),
        4 => samples.chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect(),
        _ => samples,
    }
}

#[cfg(test)]
mod tests {
    use super::super::exif::tests::tiff;
    use super::*;

    fn deep(samples: [u16; 2]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 2, 1);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.set_depth(png::BitDepth::Sixteen);
        let data: Vec<u8> = samples.iter().flat_map(|sample| sample.to_be_bytes()).collect();
        encoder.write_header().unwrap().write_image_data(&data).unwrap();
        bytes
    }

    #[test]
    fn twelve_bits_in_sixteen_are_remarked_on() {
        let remark = decode(&deep([4000, 12])).unwrap().remark.unwrap();
        assert!(remark.starts_with("16-bit samples of at most 4000"), "{remark}");
        assert_eq!(decode(&deep([4096, 12])).unwrap().remark, None);
        assert_eq!(decode(&deep([0, 0])).unwrap().remark, None);
    }

    /// A chunk that no decoder has checked yet: its checksum does not matter here.
    fn with_chunk(name: &[u8; 4], data: &[u8]) -> Vec<u8> {
        let whole = deep([1, 2]);
        let after_header = MAGIC.len() + CHUNK_HEAD + 13 + CHUNK_TAIL;
        let length = u32::try_from(data.len()).unwrap().to_be_bytes();
        let (before, behind) = whole.split_at(after_header);
        [before, &length, name, data, &[0; CHUNK_TAIL], behind].concat()
    }

    #[test]
    fn a_palette_of_parts_of_colours_is_refused_before_it_is_decoded() {
        for length in [1, 2, 4, 5, 767] {
            let error = decode(&with_chunk(b"PLTE", &vec![7; length])).unwrap_err();
            let text = jrdb_types::with_causes(&error);
            assert!(text.contains(&format!("found {length} bytes in PLTE")), "{text}");
        }
    }

    #[test]
    fn a_turned_png_is_refused() {
        let error = size(&with_chunk(b"eXIf", &tiff(6, b"MM\0*"))).unwrap_err();
        assert!(matches!(error, ImageError::Turned { orientation: 6 }));
    }
}
