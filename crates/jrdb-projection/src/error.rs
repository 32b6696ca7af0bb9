//! Why a frame cannot be projected.

use crate::RigError;

/// Why a frame cannot be projected at all.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The detections were made on an image of another size than the rig's.
    #[error(
        "expected detections on a {expected_px:?} px image as the rig has, found {found_px:?} px"
    )]
    ImageSize {
        /// Columns and rows of the rig's camera.
        expected_px: [u32; 2],
        /// Columns and rows of the image of the detections.
        found_px: [u32; 2],
    },
    /// The rig is unusable.
    #[error("the rig is unusable")]
    Rig(#[from] RigError),
}
