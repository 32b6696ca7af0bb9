#![doc = include_str!("../README.md")]

mod bits;
mod build;
mod index;

pub use bits::BitSet;
pub use build::{GraphConfig, Hidden, Pairs, build};
pub use index::{Column, Columns, GraphIndex, Row};
