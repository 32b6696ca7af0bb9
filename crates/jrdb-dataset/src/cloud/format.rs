//! The formats of point clouds.

use std::path::Path;

use jrdb_types::PointCloud;

use super::bin::BinLayout;
use super::error::CloudError;
use super::fields::{Fields, Notes, filled};
use super::{bin, npy, pcd, ply};

/// A file format of point clouds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Format {
    /// `.pcd`, the Point Cloud Library's.
    Pcd,
    /// `.bin` as KITTI's, `.pcd.bin` as nuScenes'.
    Bin(BinLayout),
    /// `.npy`, NumPy's.
    Npy,
    /// `.ply`, Stanford's.
    Ply,
}

impl Format {
    /// The format that a file's name stands for.
    ///
    /// ```
    /// use std::path::Path;
    /// use jrdb_dataset::cloud::{BinLayout, Format};
    ///
    /// assert_eq!(Format::of(Path::new("000000.ply")), Some(Format::Ply));
    /// assert_eq!(Format::of(Path::new("sweep.pcd.bin")), Some(Format::Bin(BinLayout::NuScenes)));
    /// assert_eq!(Format::of(Path::new("000000.PCD")), Some(Format::Pcd));
    /// assert_eq!(Format::of(Path::new("000000.las")), None);
    /// ```
    #[must_use]
    pub fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "pcd" => Some(Self::Pcd),
            "bin" => Some(Self::Bin(BinLayout::of(path))),
            "npy" => Some(Self::Npy),
            "ply" => Some(Self::Ply),
            _ => None,
        }
    }

    /// Parses a file of this format as the sweep of a sensor.
    ///
    /// # Errors
    /// [`CloudError`], that of the format.
    pub fn parse(self, bytes: &[u8], sensor: &str) -> Result<PointCloud, CloudError> {
        filled(sensor, |cloud| self.fill(bytes, Fields::All, &mut Vec::new(), cloud))
    }

    /// [`Format::parse`], of some fields only, into a cloud; decompresses into `block`.
    pub(super) fn fill(
        self,
        bytes: &[u8],
        fields: Fields,
        block: &mut Vec<u8>,
        cloud: &mut PointCloud,
    ) -> Result<Notes, CloudError> {
        Ok(match self {
            Self::Pcd => pcd::fill(bytes, fields, block, cloud)?,
            Self::Bin(layout) => bin::fill(bytes, layout, fields, cloud)?,
            Self::Npy => npy::fill(bytes, fields, cloud)?,
            Self::Ply => ply::fill(bytes, fields, cloud)?,
        })
    }
}
