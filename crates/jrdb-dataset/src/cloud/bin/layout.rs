//! The two layouts of points without a header that file names stand for.

use std::path::Path;

/// What the floats of a point are; the file does not say.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BinLayout {
    /// `x y z reflectance`, 16 bytes.
    Kitti,
    /// `x y z intensity ring`, 20 bytes. The axes are those of the sensor: nuScenes' LiDAR has x to the right
    /// and y forward, which its rig accounts for.
    NuScenes,
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
        let extension = stem.and_then(Path::extension);
        let is_pcd = extension.is_some_and(|extension| extension.eq_ignore_ascii_case("pcd"));
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

    pub(super) const fn other(self) -> Self {
        match self {
            Self::Kitti => Self::NuScenes,
            Self::NuScenes => Self::Kitti,
        }
    }
}
