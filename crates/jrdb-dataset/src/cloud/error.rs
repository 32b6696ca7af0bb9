//! Why a file is not a point cloud.

use super::bin::BinError;
use super::npy::NpyError;
use super::pcd::PcdError;
use super::ply::PlyError;

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
