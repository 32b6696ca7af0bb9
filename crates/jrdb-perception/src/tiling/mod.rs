//! A panorama in overlapping tiles, and one list of boxes from what the tiles show.

mod merge;
mod nms;
mod panorama;
pub(crate) mod tiled;
mod tiles;

pub use crate::numbered::CategoryBox;
pub use merge::{Candidate, MergeConfig, merge};
pub use nms::{ScoredBox, nms};
pub use panorama::PanoramaConfig;
pub use tiles::{Tile, tiles};
