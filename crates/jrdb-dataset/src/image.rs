//! Pictures: PNG and JPEG to RGB, and RGB to PNG.

mod decoded;
mod exif;
mod jpeg_file;
mod jpeg_segments;
mod png_file;
mod size;

use std::path::Path;

use jrdb_types::Image;

pub use crate::image_error::ImageError;
pub use decoded::Decoded;

use crate::{Error, file};

/// Where a picture's end is looked for, bytes from the last.
const TAIL_BYTES: usize = 64;
/// First bytes that an error shows of what is no picture.
const SHOWN_BYTES: usize = 8;

/// Reads a PNG or a baseline or progressive JPEG as RGB; see [`decode_image`].
///
/// # Errors
/// [`Error::Read`] or [`Error::Image`].
pub fn read_image(path: &Path) -> Result<Image, Error> {
    decode_image(&file::read(path)?).map_err(|source| Error::Image { path: path.into(), source })
}

/// Reads a picture that must have a size; see [`decode_image_of`].
///
/// # Errors
/// [`Error::Read`] or [`Error::Image`].
pub(crate) fn read_image_of(path: &Path, size_px: [usize; 2]) -> Result<Decoded, Error> {
    let decoded = decode_image_of(&file::read(path)?, size_px);
    decoded.map_err(|source| Error::Image { path: path.into(), source })
}

/// What a picture's bytes tell without being decoded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ImageHeader {
    /// Columns and rows.
    pub size_px: [usize; 2],
    /// Whether the bytes end as a complete picture does; a file that was cut off does not.
    pub is_complete: bool,
}

impl ImageHeader {
    /// Checks that the picture has the size of its camera.
    ///
    /// # Errors
    /// [`ImageError::OtherSize`].
    pub fn check_size(&self, expected: [usize; 2]) -> Result<(), ImageError> {
        let found = self.size_px;
        if found == expected { Ok(()) } else { Err(ImageError::OtherSize { expected, found }) }
    }
}

/// What a picture file that must have a size tells without being decoded.
///
/// # Errors
/// As [`read_image_of`].
pub(crate) fn read_header_of(path: &Path, size_px: [usize; 2]) -> Result<ImageHeader, Error> {
    let header = read_header(path)?;
    let checked = header.check_size(size_px).map(|()| header);
    checked.map_err(|source| Error::Image { path: path.into(), source })
}

/// Reads the header of a picture of any size.
pub(crate) fn read_header(path: &Path) -> Result<ImageHeader, Error> {
    let header = image_header(&file::read(path)?);
    header.map_err(|source| Error::Image { path: path.into(), source })
}

/// Decodes a PNG or a baseline or progressive JPEG, told apart by their first bytes.
///
/// Grey and palette pictures become RGB, 16-bit samples keep their upper 8 bits, and an alpha channel
/// is dropped. Of an animation the first picture is taken. Stray bytes between a JPEG's segments are passed over, a JPEG
/// without Huffman tables has the standard ones, and of a JPEG that breaks off in its last quarter the rows that are
/// there are used.
///
/// # Errors
/// [`ImageError`]; a size over 2²⁷ pixels is refused before anything of that size is allocated, and so is a picture
/// that EXIF turns.
pub fn decode_image(bytes: &[u8]) -> Result<Image, ImageError> {
    decode(bytes).map(|decoded| decoded.image)
}

/// [`decode_image`] for a picture of a known size, with what there is to remark about it. The size is checked before
/// anything is decoded.
///
/// # Errors
/// As [`decode_image`], and [`ImageError::OtherSize`].
pub fn decode_image_of(bytes: &[u8], size_px: [usize; 2]) -> Result<Decoded, ImageError> {
    image_header(bytes)?.check_size(size_px)?;
    decode(bytes)
}

fn decode(bytes: &[u8]) -> Result<Decoded, ImageError> {
    tracing::trace!(target: "jrdb::decode_image", bytes = bytes.len());
    match format(bytes)? {
        Format::Png => png_file::decode(bytes),
        Format::Jpeg => jpeg_file::decode(bytes),
    }
}

/// Reads the header of a picture that [`decode_image`] decodes, and looks at its end.
///
/// # Errors
/// [`ImageError`], as far as the header tells.
pub fn image_header(bytes: &[u8]) -> Result<ImageHeader, ImageError> {
    let (size_px, end) = match format(bytes)? {
        Format::Png => (png_file::size(bytes)?, png_file::END),
        Format::Jpeg => (jpeg_file::size(bytes)?, jpeg_file::END),
    };
    let tail = &bytes[bytes.len().saturating_sub(TAIL_BYTES)..];
    let is_complete = tail.windows(end.len()).any(|found| found == end);
    Ok(ImageHeader { size_px, is_complete })
}

enum Format {
    Png,
    Jpeg,
}

fn format(bytes: &[u8]) -> Result<Format, ImageError> {
    if bytes.starts_with(png_file::MAGIC) {
        Ok(Format::Png)
    } else if bytes.starts_with(jpeg_file::MAGIC) {
        Ok(Format::Jpeg)
    } else {
        let found = bytes.iter().copied().take(SHOWN_BYTES).collect();
        Err(ImageError::UnknownFormat { found })
    }
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
    }

    #[test]
    fn another_size_than_the_cameras_is_refused_before_decoding() {
        let error = decode_image_of(GRADIENT, [3760, 480]).unwrap_err().to_string();
        let expected = "expected an image of [3760, 480] px as in the calibration, found [37, 21]";
        assert_eq!(error, expected);
        assert_eq!(decode_image_of(GRADIENT, [37, 21]).unwrap().remark, None);
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
