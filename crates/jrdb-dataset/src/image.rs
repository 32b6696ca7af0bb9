//! Pictures: PNG and JPEG to RGB, and RGB to PNG.

use std::io::Cursor;
use std::path::Path;

use jrdb_types::Image;
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

pub use crate::image_error::ImageError;
use crate::{Error, file};

/// Largest picture that is decoded, pixels: 70 times a JRDB panorama.
const MAX_PIXELS: u64 = 1 << 27;

/// No PNG or JPEG packs more pixels into a byte than DEFLATE's best ratio (1032) of one-bit pixels; a
/// header that claims more is a lie, and its picture is never allocated.
const MAX_PIXELS_PER_BYTE: u64 = 8 * 1032;

/// Longest side that a JPEG header can state.
const MAX_JPEG_SIDE: usize = 65_535;

/// Bytes that the PNG decoder may use for itself: text, palettes, and a few rows.
const PNG_WORKING_BYTES: usize = 1 << 26;

/// What a complete picture ends with, perhaps followed by a few bytes of padding.
const PNG_END: &[u8] = b"IEND";
const JPEG_END: &[u8] = &[0xff, 0xd9];
/// Where the end is looked for, bytes from the last.
const TAIL_BYTES: usize = 64;
const PNG_MAGIC: &[u8] = b"\x89PNG\r\n\x1a\n";
const JPEG_MAGIC: &[u8] = b"\xff\xd8\xff";

/// Reads a PNG or a baseline or progressive JPEG as RGB; see [`decode_image`].
///
/// # Errors
/// [`Error::Read`] or [`Error::Image`].
pub fn read_image(path: &Path) -> Result<Image, Error> {
    decode_image(&file::read(path)?).map_err(|source| Error::Image { path: path.into(), source })
}

/// What a picture's bytes tell without being decoded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ImageHeader {
    /// Columns and rows.
    pub size_px: [usize; 2],
    /// Whether the bytes end as a complete picture does; a file that was cut off does not.
    pub is_complete: bool,
}

/// What a picture file tells without being decoded.
///
/// # Errors
/// As [`read_image`].
pub(crate) fn read_header(path: &Path) -> Result<ImageHeader, Error> {
    image_header(&file::read(path)?).map_err(|source| Error::Image { path: path.into(), source })
}

/// Decodes a PNG or a baseline or progressive JPEG, told apart by their first bytes.
///
/// Grey and palette pictures become RGB, 16-bit samples keep their upper 8 bits, and an alpha channel
/// is dropped. Of an animation the first picture is taken.
///
/// # Errors
/// [`ImageError`]; a size over 2²⁷ pixels is refused before anything of that size is allocated.
pub fn decode_image(bytes: &[u8]) -> Result<Image, ImageError> {
    tracing::trace!(target: "jrdb::decode_image", bytes = bytes.len());
    if bytes.starts_with(PNG_MAGIC) {
        decode_png(bytes)
    } else if bytes.starts_with(JPEG_MAGIC) {
        decode_jpeg(bytes)
    } else {
        Err(unknown_format(bytes))
    }
}

/// Reads the header of a picture that [`decode_image`] decodes, and looks at its end.
///
/// # Errors
/// [`ImageError`], as far as the header tells.
pub fn image_header(bytes: &[u8]) -> Result<ImageHeader, ImageError> {
    let tail = &bytes[bytes.len().saturating_sub(TAIL_BYTES)..];
    let ends_with = |mark: &[u8]| tail.windows(mark.len()).any(|found| found == mark);
    if bytes.starts_with(PNG_MAGIC) {
        let reader = png_reader(bytes)?;
        let size_px = [reader.info().width as usize, reader.info().height as usize];
        Ok(ImageHeader { size_px, is_complete: ends_with(PNG_END) })
    } else if bytes.starts_with(JPEG_MAGIC) {
        let (_, size_px) = jpeg_decoder(bytes)?;
        Ok(ImageHeader { size_px, is_complete: ends_with(JPEG_END) })
    } else {
        Err(unknown_format(bytes))
    }
}

fn unknown_format(bytes: &[u8]) -> ImageError {
    ImageError::UnknownFormat { found: bytes.iter().copied().take(PNG_MAGIC.len()).collect() }
}

fn png_reader(bytes: &[u8]) -> Result<png::Reader<Cursor<&[u8]>>, ImageError> {
    let mut decoder =
        png::Decoder::new_with_limits(Cursor::new(bytes), png::Limits { bytes: PNG_WORKING_BYTES });
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    let reader = decoder.read_info().map_err(png_error)?;
    let (width, height) = (reader.info().width as usize, reader.info().height as usize);
    check_size(width, height, bytes.len())?;
    Ok(reader)
}

fn decode_png(bytes: &[u8]) -> Result<Image, ImageError> {
    let mut reader = png_reader(bytes)?;
    let (width, height) = (reader.info().width as usize, reader.info().height as usize);
    let channels = reader.output_color_type().0.samples();
    let mut samples = vec![0; channels * width * height];
    reader.next_frame(&mut samples).map_err(png_error)?;
    Ok(Image { width, height, rgb: rgb_from_channels(samples, channels) })
}

fn png_error(source: png::DecodingError) -> ImageError {
    ImageError::Malformed { format: "png", source: Box::new(source) }
}

fn rgb_from_channels(samples: Vec<u8>, channels: usize) -> Vec<u8> {
    match channels {
        1 | 2 => samples.chunks_exact(channels).flat_map(|pixel| [pixel[0]; 3]).collect(),
        4 => samples.chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect(),
        _ => samples,
    }
}

type JpegOf<'b> = JpegDecoder<Cursor<&'b [u8]>>;

fn jpeg_decoder(bytes: &[u8]) -> Result<(JpegOf<'_>, [usize; 2]), ImageError> {
    let options = DecoderOptions::default()
        .set_strict_mode(true)
        .set_max_width(MAX_JPEG_SIDE)
        .set_max_height(MAX_JPEG_SIDE)
        .jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = JpegDecoder::new_with_options(Cursor::new(bytes), options);
    decoder.decode_headers().map_err(jpeg_error)?;
    let (width, height) = decoder.dimensions().unwrap_or_default();
    check_size(width, height, bytes.len())?;
    Ok((decoder, [width, height]))
}

fn decode_jpeg(bytes: &[u8]) -> Result<Image, ImageError> {
    let (mut decoder, [width, height]) = jpeg_decoder(bytes)?;
    let rgb = decoder.decode().map_err(jpeg_error)?;
    if rgb.len() != 3 * width * height {
        let found = format!("{} samples for {width} x {height} rgb pixels", rgb.len());
        return Err(ImageError::Malformed { format: "jpeg", source: found.into() });
    }
    Ok(Image { width, height, rgb })
}

fn jpeg_error(source: zune_jpeg::errors::DecodeErrors) -> ImageError {
    ImageError::Malformed { format: "jpeg", source: Box::new(source) }
}

fn check_size(width: usize, height: usize, bytes: usize) -> Result<(), ImageError> {
    let limit = MAX_PIXELS.min(MAX_PIXELS_PER_BYTE.saturating_mul(bytes as u64));
    let pixels = (width as u64).saturating_mul(height as u64);
    if pixels > limit { Err(ImageError::TooLarge { limit, width, height }) } else { Ok(()) }
}

/// What a PNG file is made for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PngCompression {
    /// Quickly: a tenth larger, five times as fast, on a photographed panorama.
    Quick,
    /// To be kept: small.
    Small,
}

/// The picture as an 8-bit RGB PNG; equal pictures give equal bytes.
///
/// # Panics
/// When a side is 0 or over 2³¹ - 1, or `rgb` does not hold 3 bytes for each pixel.
#[must_use]
pub fn encode_png(image: &Image, compression: PngCompression) -> Vec<u8> {
    let side = |pixels: usize| u32::try_from(pixels).expect("a side fits into 31 bits");
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, side(image.width), side(image.height));
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(match compression {
        PngCompression::Quick => png::Compression::Fast,
        PngCompression::Small => png::Compression::Balanced,
    });
    let mut writer = encoder.write_header().expect("the sides are not 0");
    writer.write_image_data(&image.rgb).expect("3 bytes for each pixel");
    writer.finish().expect("writing to memory does not fail");
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_header_tells_the_size_of_the_picture_and_whether_it_was_cut() {
        let drawn = encode_png(&Image::filled(9, 4, [7; 3]), PngCompression::Quick);
        for bytes in [GRADIENT, PROGRESSIVE, GREY, &drawn] {
            let (image, header) = (decode_image(bytes).unwrap(), image_header(bytes).unwrap());
            assert_eq!(header.size_px, [image.width, image.height]);
            assert!(header.is_complete);
            assert!(!image_header(&bytes[..bytes.len() - 9]).unwrap().is_complete);
        }
        assert!(image_header(&GRADIENT[..20]).is_err() && image_header(b"GIF89a").is_err());
    }

    use proptest::prelude::*;

    const GRADIENT: &[u8] = include_bytes!("../testdata/gradient.jpg");
    const PROGRESSIVE: &[u8] = include_bytes!("../testdata/gradient_progressive.jpg");
    const GREY: &[u8] = include_bytes!("../testdata/gradient_grey.jpg");

    fn png(color: png::ColorType, depth: png::BitDepth, data: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 2, 1);
        encoder.set_color(color);
        encoder.set_depth(depth);
        if color == png::ColorType::Indexed {
            encoder.set_palette(vec![1, 2, 3, 4, 5, 6]);
        }
        encoder.write_header().unwrap().write_image_data(data).unwrap();
        bytes
    }

    /// The picture that the test files were made from: red grows to the right, green downwards.
    fn worst_difference(image: &Image) -> i32 {
        let wanted = |x: usize, y: usize| [(x * 255 / 36) as i32, (y * 255 / 20) as i32, 128];
        (0..37 * 21)
            .flat_map(|i| {
                let (x, y) = (i % 37, i / 37);
                let found = image.pixel(x, y).map(i32::from);
                std::array::from_fn::<i32, 3, _>(|c| (found[c] - wanted(x, y)[c]).abs())
            })
            .max()
            .unwrap()
    }

    #[test]
    fn baseline_and_progressive_jpeg_show_the_drawn_gradient() {
        for (bytes, tolerance) in [(GRADIENT, 8), (PROGRESSIVE, 16)] {
            let image = decode_image(bytes).unwrap();
            assert_eq!((image.width, image.height), (37, 21));
            assert!(worst_difference(&image) <= tolerance, "{}", worst_difference(&image));
        }
    }

    #[test]
    fn a_grey_jpeg_becomes_rgb() {
        let image = decode_image(GREY).unwrap();
        assert_eq!(image.rgb.len(), 3 * 37 * 21);
        assert!(image.rgb.chunks(3).all(|p| p[0] == p[1] && p[1] == p[2]));
        assert!(image.pixel(36, 20)[0] > image.pixel(0, 0)[0] + 100);
    }

    #[test]
    fn every_png_kind_becomes_rgb() {
        use png::BitDepth::{Eight, One, Sixteen};
        use png::ColorType::{Grayscale, GrayscaleAlpha, Indexed, Rgb, Rgba};
        let cases: [(png::ColorType, png::BitDepth, &[u8], [u8; 6]); 7] = [
            (Grayscale, Eight, &[7, 9], [7, 7, 7, 9, 9, 9]),
            (Grayscale, One, &[0b1000_0000], [255, 255, 255, 0, 0, 0]),
            (GrayscaleAlpha, Eight, &[7, 0, 9, 255], [7, 7, 7, 9, 9, 9]),
            (Rgb, Eight, &[1, 2, 3, 4, 5, 6], [1, 2, 3, 4, 5, 6]),
            (Rgb, Sixteen, &[1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6, 0], [1, 2, 3, 4, 5, 6]),
            (Rgba, Eight, &[1, 2, 3, 0, 4, 5, 6, 255], [1, 2, 3, 4, 5, 6]),
            (Indexed, Eight, &[1, 0], [4, 5, 6, 1, 2, 3]),
        ];
        for (color, depth, data, rgb) in cases {
            let image = decode_image(&png(color, depth, data)).unwrap();
            assert_eq!(image.rgb, rgb, "{color:?} {depth:?}");
        }
    }

    #[test]
    fn pictures_survive_the_round_trip_with_equal_bytes() {
        let image = decode_image(GRADIENT).unwrap();
        let bytes = encode_png(&image, PngCompression::Quick);
        assert_eq!(decode_image(&bytes).unwrap(), image);
        assert_eq!(encode_png(&image, PngCompression::Quick), bytes);
    }

    #[test]
    fn neither_png_nor_jpeg_is_named() {
        let error = decode_image(b"GIF89a").unwrap_err().to_string();
        assert_eq!(
            error,
            "expected a png or jpeg, found a file that starts with [47, 49, 46, 38, 39, 61]"
        );
    }

    #[test]
    fn a_header_that_lies_about_the_size_is_refused() {
        let mut lying = GRADIENT.to_vec();
        let frame = lying.windows(2).position(|marker| marker == [0xff, 0xc0]).unwrap();
        lying[frame + 5..frame + 9].copy_from_slice(&[0xff, 0xff, 0xff, 0xff]);
        assert!(matches!(
            decode_image(&lying),
            Err(ImageError::TooLarge { width: 65_535, height: 65_535, .. })
        ));
        let too_many_for_its_bytes = check_size(1 << 13, 1 << 13, 100);
        assert!(matches!(too_many_for_its_bytes, Err(ImageError::TooLarge { limit: 825_600, .. })));
    }

    #[test]
    fn a_picture_that_breaks_off_is_malformed() {
        let png = encode_png(&decode_image(GRADIENT).unwrap(), PngCompression::Small);
        for whole in [&png[..], GRADIENT] {
            let half = &whole[..whole.len() / 2];
            assert!(matches!(decode_image(half), Err(ImageError::Malformed { .. })));
        }
    }

    proptest! {
        #[test]
        fn mutated_pictures_never_panic(
            which in 0..4_usize,
            changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
        ) {
            let png = encode_png(&decode_image(GREY).unwrap(), PngCompression::Small);
            let mut bytes = [GRADIENT, PROGRESSIVE, GREY, &png][which].to_vec();
            for (at, value) in changes {
                let at = at.index(bytes.len());
                bytes[at] = value;
            }
            if let Ok(image) = decode_image(&bytes) {
                prop_assert_eq!(image.rgb.len(), 3 * image.width * image.height);
            }
        }
    }
}
