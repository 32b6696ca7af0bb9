//! How large a picture may be.

use crate::image_error::ImageError;

/// Largest picture that is decoded, pixels: 70 times a JRDB panorama.
const MAX_PIXELS: u64 = 1 << 27;

/// No PNG or JPEG packs more pixels into a byte than DEFLATE's best ratio (1032) of one-bit pixels; a
/// header that claims more is a lie, and its picture is never allocated.
const MAX_PIXELS_PER_BYTE: u64 = 8 * 1032;

/// Checks what a header states against the length of the file.
pub(super) fn check_size([width, height]: [usize; 2], bytes: usize) -> Result<(), ImageError> {
    let limit = MAX_PIXELS.min(MAX_PIXELS_PER_BYTE.saturating_mul(bytes as u64));
    let pixels = (width as u64).saturating_mul(height as u64);
    if pixels > limit { Err(ImageError::TooLarge { limit, width, height }) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_file_cannot_hold_many_pixels() {
        let too_many = check_size([1 << 13, 1 << 13], 100);
        assert!(matches!(too_many, Err(ImageError::TooLarge { limit: 825_600, .. })));
    }
}
