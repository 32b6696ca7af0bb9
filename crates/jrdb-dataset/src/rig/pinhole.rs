//! Camera matrices, checked.

use std::path::Path;

use jrdb_types::lens::{DistortionModel, Pinhole};

use crate::{Error, picture_size};

/// A camera without distortion from K, row by row: `fx 0 cx, 0 fy cy, 0 0 1`.
pub(super) fn pinhole(
    k: [f64; 9],
    [width_px, height_px]: [u32; 2],
    key: &str,
    path: &Path,
) -> Result<Pinhole, Error> {
    let keys =
        [&*format!("width of the image of {key}"), &*format!("height of the image of {key}")];
    picture_size::check([width_px, height_px], keys, path)?;
    match k {
        [fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0] if fx > 0.0 && fy > 0.0 => {
            let distortion = DistortionModel::None;
            Ok(Pinhole { width_px, height_px, fx, fy, cx, cy, distortion })
        }
        _ => {
            let expected = format!("fx 0 cx, 0 fy cy, 0 0 1 as {key}");
            Err(Error::content(path, expected, format!("{k:?}")))
        }
    }
}
