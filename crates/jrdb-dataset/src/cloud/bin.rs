//! Clouds of bare little-endian numbers: KITTI's `.bin`, nuScenes' `.pcd.bin`, and what else people call so.

mod error;
mod evidence;
mod layout;
mod rows;

use jrdb_types::PointCloud;

use super::columns::{ByteOrder, Scalar};
use super::fields::{Fields, Notes, filled};
use evidence::Evidence;

pub use error::BinError;
pub use layout::BinLayout;
pub use rows::CloudColumns;

/// Parses bare floats as the sweep of a sensor.
///
/// The file does not say what its numbers are. Where the numbers leave no doubt that they are of another layout than
/// the name stands for (3 to 8 floats, or doubles), they are read so.
///
/// ```
/// use jrdb_dataset::cloud::{BinLayout, bin};
/// let bytes: Vec<u8> = [1.0_f32, 2.0, 3.0, 0.5].iter().flat_map(|v| v.to_le_bytes()).collect();
/// let cloud = bin::parse(&bytes, BinLayout::Kitti, "velodyne").unwrap();
/// assert_eq!((cloud.z[0], cloud.intensity[0]), (3.0, 0.5));
/// ```
///
/// # Errors
/// [`BinError::Length`] when the bytes are not a whole number of points, and [`BinError::NotFloats`] when they are not such
/// numbers. A small file of another layout whose length divides by both cannot be told apart.
pub fn parse(bytes: &[u8], layout: BinLayout, sensor: &str) -> Result<PointCloud, BinError> {
    filled(sensor, |cloud| fill(bytes, layout, Fields::All, cloud))
}

/// [`parse`], of some fields only, into a cloud.
pub(super) fn fill(
    bytes: &[u8],
    layout: BinLayout,
    fields: Fields,
    cloud: &mut PointCloud,
) -> Result<Notes, BinError> {
    let named = layout.row_bytes() / Scalar::F32.size();
    match evidence::weigh(bytes, named) {
        Evidence::Other { scalar, columns } => {
            let rows = CloudColumns::alike(scalar, columns);
            fill_rows(bytes, &rows, fields, cloud);
            Ok(vec![other_layout(layout, scalar, columns)])
        }
        Evidence::NotFloats { percent } => Err(BinError::NotFloats { expected: layout, percent }),
        Evidence::AsNamed | Evidence::PerhapsOther { .. }
            if !bytes.len().is_multiple_of(layout.row_bytes()) =>
        {
            let other = layout.other();
            let fits = bytes.len().is_multiple_of(other.row_bytes()).then_some(other);
            Err(BinError::Length { expected: layout, found: bytes.len(), fits })
        }
        doubt => {
            fill_rows(bytes, &CloudColumns::alike(Scalar::F32, named), fields, cloud);
            let note = |columns| {
                format!(
                    "read as {layout}, but its numbers look like {columns} floats a point; state the \
                     columns"
                )
            };
            Ok(match doubt {
                Evidence::PerhapsOther { columns } => vec![note(columns)],
                _ => Notes::new(),
            })
        }
    }
}

/// Reads points of the columns that were stated.
pub(super) fn fill_stated(
    bytes: &[u8],
    columns: &CloudColumns,
    fields: Fields,
    cloud: &mut PointCloud,
) -> Result<Notes, BinError> {
    let expected = columns.row_bytes();
    if !bytes.len().is_multiple_of(expected) {
        let columns = columns.to_string();
        return Err(BinError::Stated { expected, columns, found: bytes.len() });
    }
    fill_rows(bytes, columns, fields, cloud);
    Ok(Notes::new())
}

fn fill_rows(bytes: &[u8], columns: &CloudColumns, fields: Fields, cloud: &mut PointCloud) {
    let rows = bytes.len() / columns.row_bytes();
    if let Some(places) = columns.places(fields) {
        places.fill(bytes, rows, ByteOrder::Little, cloud);
    }
}

/// The note on a file whose numbers show another layout than its name.
fn other_layout(named: BinLayout, scalar: Scalar, columns: usize) -> String {
    let kind = if scalar == Scalar::F64 { "8-byte" } else { "4-byte" };
    format!(
        "read as {columns} {kind} floats a point (x y z ..), as its numbers show, not as {named}; \
         state the columns to read it otherwise"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn bytes(floats: usize) -> Vec<u8> {
        (0..floats).flat_map(|i| (i as f32).to_le_bytes()).collect()
    }

    #[test]
    fn points_have_four_or_five_floats() {
        let kitti = parse(&bytes(8), BinLayout::Kitti, "s").unwrap();
        assert_eq!((kitti.x, kitti.intensity), (vec![0.0, 4.0], vec![3.0, 7.0]));
        let nuscenes = parse(&bytes(10), BinLayout::NuScenes, "s").unwrap();
        assert_eq!((nuscenes.y, nuscenes.intensity), (vec![1.0, 6.0], vec![3.0, 8.0]));
    }

    #[test]
    fn the_name_tells_the_layout() {
        let layout = |name| BinLayout::of(Path::new(name));
        assert_eq!(layout("velodyne/000000.bin"), BinLayout::Kitti);
        assert_eq!(layout("n015__LIDAR_TOP__1.pcd.bin"), BinLayout::NuScenes);
    }

    #[test]
    fn a_file_of_the_other_layout_is_named() {
        assert_eq!(
            parse(&bytes(5), BinLayout::Kitti, "s").unwrap_err().to_string(),
            "expected a multiple of 16 bytes (KITTI's x y z reflectance), found 20 bytes; they are whole \
             points of nuScenes' x y z intensity ring, whose files end in .pcd.bin"
        );
        assert_eq!(
            parse(&bytes(3), BinLayout::NuScenes, "s").unwrap_err().to_string(),
            "expected a multiple of 20 bytes (nuScenes' x y z intensity ring), found 12 bytes"
        );
    }

    #[test]
    fn points_without_a_place_are_counted() {
        let floats = [1.0, 2.0, 3.0, 4.0, 5.0, f32::NAN, 7.0, 8.0, 9.0, 1.0, f32::INFINITY, 3.0];
        let bytes: Vec<u8> = floats.iter().flat_map(|v| v.to_le_bytes()).collect();
        let cloud = parse(&bytes, BinLayout::Kitti, "s").unwrap();
        assert_eq!((cloud.len(), cloud.skipped, cloud.intensity), (1, 2, vec![4.0]));
    }
}
