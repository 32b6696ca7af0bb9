//! Point clouds of every format, by the file's name.
//!
//! Whatever the format: coordinates come out as `f32`; points with a coordinate that is not finite (as `f32`) are
//! left out and counted in [`PointCloud::skipped`](jrdb_types::PointCloud::skipped); an intensity is kept when it is a float or an unsigned
//! integer of at most 2 bytes; and nothing is allocated for points that the file has no bytes for.

pub mod bin;
pub mod npy;
pub mod pcd;
pub mod ply;

mod ascii;
mod buffers;
mod columns;
mod error;
mod fields;
mod format;
mod plausible;
mod reader;

pub use bin::{BinError, BinLayout, CloudColumns};
pub use error::CloudError;
pub use fields::Fields;
pub use format::Format;
pub use npy::NpyError;
pub use pcd::PcdError;
pub(crate) use plausible::is_coarse;
pub use plausible::{Implausible, implausible};
pub use ply::PlyError;
pub use reader::{Reader, read};
