#![doc = include_str!("../README.md")]

mod build;
mod index;

pub use build::{GraphConfig, Hidden, Pairs, build};
pub use index::{GraphIndex, Neighbor};
