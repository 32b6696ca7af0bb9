#![doc = include_str!("../README.md")]

mod bits;
mod build;
mod index;
mod indexed;
mod timeless;

pub use bits::BitSet;
pub use build::{GraphConfig, Hidden, Pairs, build};
pub use index::{Columns, GraphIndex, Row};
pub use indexed::IndexedGraph;
pub use timeless::make_timeless;
