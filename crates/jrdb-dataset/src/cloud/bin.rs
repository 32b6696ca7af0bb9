//! Clouds of bare little-endian floats: KITTI's `.bin` and nuScenes' `.pcd.bin`.

use std::path::Path;

use jrdb_types::PointCloud;

use super::columns::{ByteOrder, Column, Columns, Scalar};
use super::fields::{Fields, filled};

/// What the floats of a point are; the file does not say.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BinLayout {
    /// `x y z reflectance`, 16 bytes.
    Kitti,
    /// `x y z intensity ring`, 20 bytes. The axes are those of the sensor: nuScenes' LiDAR has x to the right
    /// and y forward, which its rig accounts for.
    NuScenes,
}

/// Why bytes are not points of a layout.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BinError {
    /// The length is not that of whole points.
    #[error("expected a multiple of {} bytes ({expected}), found {found} bytes{}", .expected.row_bytes(), hint(*.fits))]
    Length {
        /// Layout that was asked for.
        expected: BinLayout,
        /// Bytes found.
        found: usize,
        /// The layout of whose points the bytes are a whole number.
        fits: Option<BinLayout>,
    },
}

fn hint(fits: Option<BinLayout>) -> String {
    let name = |layout| if layout == BinLayout::Kitti { ".bin" } else { ".pcd.bin" };
    fits.map_or_else(String::new, |layout| {
        format!("; they are whole points of {layout}, whose files end in {}", name(layout))
    })
}

impl std::fmt::Display for BinLayout {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Kitti => "KITTI's x y z reflectance",
            Self::NuScenes => "nuScenes' x y z intensity ring",
        })
    }
}

impl BinLayout {
    /// The layout by the file's name: nuScenes' for `.pcd.bin`, else KITTI's.
    #[must_use]
    pub fn of(path: &Path) -> Self {
        let stem = path.file_stem().map(Path::new);
        let is_pcd = stem.and_then(Path::extension).is_some_and(|extension| extension == "pcd");
        if is_pcd { Self::NuScenes } else { Self::Kitti }
    }

    /// Bytes of a point.
    #[must_use]
    pub const fn row_bytes(self) -> usize {
        match self {
            Self::Kitti => 16,
            Self::NuScenes => 20,
        }
    }

    const fn other(self) -> Self {
        match self {
            Self::Kitti => Self::NuScenes,
            Self::NuScenes => Self::Kitti,
        }
    }
}

/// Parses bare floats as the sweep of a sensor.
///
/// ```
/// use jrdb_dataset::cloud::{BinLayout, bin};
/// let bytes: Vec<u8> = [1.0_f32, 2.0, 3.0, 0.5].iter().flat_map(|v| v.to_le_bytes()).collect();
/// let cloud = bin::parse(&bytes, BinLayout::Kitti, "velodyne").unwrap();
/// assert_eq!((cloud.z[0], cloud.intensity[0]), (3.0, 0.5));
/// ```
///
/// # Errors
/// [`BinError::Length`] when the bytes are not a whole number of points. A file of the other layout whose
/// length divides by both cannot be told apart.
pub fn parse(bytes: &[u8], layout: BinLayout, sensor: &str) -> Result<PointCloud, BinError> {
    filled(sensor, |cloud| fill(bytes, layout, Fields::All, cloud))
}

/// [`parse`], of some fields only, into a cloud.
pub(super) fn fill(
    bytes: &[u8],
    layout: BinLayout,
    fields: Fields,
    cloud: &mut PointCloud,
) -> Result<(), BinError> {
    let stride = layout.row_bytes();
    if !bytes.len().is_multiple_of(stride) {
        let other = layout.other();
        let fits = bytes.len().is_multiple_of(other.row_bytes()).then_some(other);
        return Err(BinError::Length { expected: layout, found: bytes.len(), fits });
    }
    let column = |start| Column { scalar: Scalar::F32, start, stride };
    let intensity = (fields == Fields::All).then(|| column(12));
    let columns = Columns { xyz: [0, 4, 8].map(column), intensity };
    columns.fill(bytes, bytes.len() / stride, ByteOrder::Little, cloud);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

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
