#![doc = include_str!("../README.md")]

mod bits;
mod build;
mod index;
mod indexed;
mod network;
mod timeless;

pub use bits::BitSet;
pub use build::{GraphConfig, Hidden, Pairs, build};
pub use index::{Columns, GraphIndex, Row};
pub use indexed::IndexedGraph;
pub use network::{Network, as_petgraph, chain, dot, groups, metres_within};
pub use petgraph;
pub use timeless::make_timeless;
