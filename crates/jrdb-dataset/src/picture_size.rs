//! How large a camera's picture may be, whatever file states it.

use std::path::Path;

use crate::Error;

/// Longest side, pixels: 17 times a JRDB panorama. Pictures are drawn, so their size must fit into memory.
const SIDE_MAX_PX: u32 = 65_536;
/// Most pixels: a 360° picture of 11,000 columns has fewer. A drawn picture takes 7 bytes for each.
const PIXELS_MAX: u64 = 1 << 26;

/// Checks the columns and rows that a file states under these keys.
pub(crate) fn check(
    [width_px, height_px]: [u32; 2],
    [width_key, height_key]: [&str; 2],
    path: &Path,
) -> Result<(), Error> {
    for (side, key) in [(width_px, width_key), (height_px, height_key)] {
        if side == 0 || side > SIDE_MAX_PX {
            let expected = format!("{key} of 1 to {SIDE_MAX_PX} pixels");
            return Err(Error::content(path, expected, side.to_string()));
        }
    }
    if u64::from(width_px) * u64::from(height_px) > PIXELS_MAX {
        let expected = format!("at most {PIXELS_MAX} pixels by {width_key} and {height_key}");
        return Err(Error::content(path, expected, format!("{width_px} x {height_px}")));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_and_area_are_bounded_and_named() {
        let found = |size| {
            let checked = check(size, ["image.width", "image.height"], Path::new("defaults.yaml"));
            checked.map_err(|error| error.to_string())
        };
        assert_eq!(found([3760, 480]), Ok(()));
        let error = found([4_000_000_000, 480]).unwrap_err();
        assert!(error.contains("image.width of 1 to 65536 pixels, found 4000000000"), "{error}");
        assert!(found([480, 0]).unwrap_err().contains("image.height"));
        assert!(found([60_000, 60_000]).unwrap_err().contains("found 60000 x 60000"));
    }
}
