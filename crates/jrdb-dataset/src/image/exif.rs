//! The orientation in a picture's EXIF data.

use crate::image_error::ImageError;

/// EXIF's tag of the orientation.
const ORIENTATION: u16 = 0x0112;
/// The orientation of a picture whose rows run from top to bottom and columns from left to right.
const UPRIGHT: u16 = 1;
/// EXIF's largest orientation; a larger number means nothing.
const LAST_ORIENTATION: u16 = 8;
/// Bytes of an entry of a directory, and where its value is in it.
const ENTRY_BYTES: usize = 12;
const VALUE_AT: usize = 8;

/// Refuses a picture that is turned or mirrored. `tiff` is the EXIF data from their byte-order mark on.
///
/// Data that break off say nothing about the orientation: many cameras write such.
pub(super) fn check_upright(tiff: &[u8]) -> Result<(), ImageError> {
    match orientation(tiff) {
        Some(orientation) if orientation > UPRIGHT && orientation <= LAST_ORIENTATION => {
            Err(ImageError::Turned { orientation })
        }
        _ => Ok(()),
    }
}

fn orientation(tiff: &[u8]) -> Option<u16> {
    let order = match tiff.get(..4)? {
        b"II*\0" => u16::from_le_bytes,
        b"MM\0*" => u16::from_be_bytes,
        _ => return None,
    };
    let u16_at = |at: usize| Some(order(*tiff.get(at..)?.first_chunk()?));
    // A 32-bit offset as its two halves, in whichever order they are.
    let halves = [u16_at(4)?, u16_at(6)?].map(usize::from);
    let [low, high] = if tiff[0] == b'I' { halves } else { [halves[1], halves[0]] };
    let directory = (high << 16) | low;
    let count = usize::from(u16_at(directory)?);
    let entries = (0..count).map(|entry| directory + 2 + ENTRY_BYTES * entry);
    let mut tags = entries.map_while(|at| Some((at, u16_at(at)?)));
    let (at, _) = tags.find(|(_, tag)| *tag == ORIENTATION)?;
    u16_at(at + VALUE_AT)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// EXIF data with an orientation, little-endian or not.
    pub(crate) fn tiff(orientation: u16, mark: &[u8; 4]) -> Vec<u8> {
        let is_little = mark[0] == b'I';
        let u16s = |values: &[u16]| -> Vec<u8> {
            let bytes = |v: &u16| if is_little { v.to_le_bytes() } else { v.to_be_bytes() };
            values.iter().flat_map(bytes).collect()
        };
        let long = |value: u16| if is_little { [value, 0] } else { [0, value] };
        let [count, offset] = [long(1), long(8)];
        let entry = [ORIENTATION, 3, count[0], count[1], orientation, 0];
        [mark.to_vec(), u16s(&offset), u16s(&[1]), u16s(&entry)].concat()
    }

    #[test]
    fn a_turned_picture_is_refused_in_either_byte_order() {
        for mark in [b"II*\0", b"MM\0*"] {
            assert!(check_upright(&tiff(1, mark)).is_ok());
            for turned in 2..=8 {
                let error = check_upright(&tiff(turned, mark)).unwrap_err().to_string();
                assert!(error.contains(&format!("EXIF orientation {turned}")), "{error}");
            }
        }
    }

    #[test]
    fn data_that_break_off_or_mean_nothing_are_passed_over() {
        let whole = tiff(6, b"MM\0*");
        for length in 0..whole.len() - 2 {
            let _ = check_upright(&whole[..length]);
        }
        assert!(check_upright(&tiff(9, b"II*\0")).is_ok() && check_upright(b"EXIF").is_ok());
        assert!(check_upright(b"II*\0\xff\xff\xff\xff").is_ok());
    }
}
