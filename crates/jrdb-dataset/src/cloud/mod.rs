//! Point clouds of every format, by the file's name.
//!
//! Whatever the format: coordinates come out as `f32`; points with a coordinate that is not finite (as `f32`) are
//! left out and counted in [`PointCloud::skipped`]; an intensity is kept when it is a float or an unsigned
//! integer of at most 2 bytes; and nothing is allocated for points that the file has no bytes for.

pub mod bin;
pub mod npy;
pub mod pcd;
pub mod ply;

mod ascii;
mod columns;

use std::path::Path;

use jrdb_types::PointCloud;

pub use bin::{BinError, BinLayout};
pub use npy::NpyError;
pub use pcd::PcdError;
pub use ply::PlyError;

use crate::{Error, file};

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

/// Why bytes are not a point cloud that can be used.
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
#[non_exhaustive]
pub enum CloudError {
    /// Not a PCD file.
    Pcd(#[from] PcdError),
    /// Not a file of bare floats.
    Bin(#[from] BinError),
    /// Not a NumPy array of points.
    Npy(#[from] NpyError),
    /// Not a PLY file with points.
    Ply(#[from] PlyError),
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
    /// assert_eq!(Format::of(Path::new("000000.las")), None);
    /// ```
    #[must_use]
    pub fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()? {
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
        Ok(match self {
            Self::Pcd => pcd::parse(bytes, sensor)?,
            Self::Bin(layout) => bin::parse(bytes, layout, sensor)?,
            Self::Npy => npy::parse(bytes, sensor)?,
            Self::Ply => ply::parse(bytes, sensor)?,
        })
    }
}

/// What is read of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fields {
    /// Its position; what a file says beyond the last coordinate of the last point is not looked at.
    Positions,
    /// Its position, and its intensity where the file has one.
    All,
}

/// Reads a file as the sweep of a sensor, in the format that its name stands for.
///
/// # Errors
/// Those of [`Reader::read`].
pub fn read(path: &Path, sensor: &str, fields: Fields) -> Result<PointCloud, Error> {
    Reader::default().read(path, sensor, fields)
}

/// Reads files one after the other and uses its memory again: what a stream of frames wants.
#[derive(Debug, Clone, Default)]
pub struct Reader {
    /// A file's bytes, or a piece of them.
    bytes: Vec<u8>,
    /// What was compressed.
    block: Vec<u8>,
}

impl Reader {
    /// [`read`].
    ///
    /// # Errors
    /// [`Error::Content`] for a name of no known format, [`Error::Read`] or [`Error::Cloud`].
    pub fn read(&mut self, path: &Path, sensor: &str, fields: Fields) -> Result<PointCloud, Error> {
        let format = Format::of(path).ok_or_else(|| {
            let name = path.file_name().unwrap_or_default();
            Error::content(path, "a .pcd, .bin, .pcd.bin, .npy or .ply file", format!("{name:?}"))
        })?;
        if format == Format::Pcd {
            return pcd::read(path, sensor, fields, self);
        }
        let parsed = format.parse(&file::read(path)?, sensor);
        let mut cloud = parsed.map_err(|source| Error::Cloud { path: path.into(), source })?;
        if fields == Fields::Positions {
            cloud.intensity = Vec::new();
        }
        Ok(cloud)
    }
}

/// The start of a text, short enough for a message.
fn excerpt(text: &str) -> String {
    const MAX_CHARS: usize = 80;
    text.chars().take(MAX_CHARS).collect()
}
