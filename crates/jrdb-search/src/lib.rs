#![doc = include_str!("../README.md")]

mod attribute;
mod between;
mod config;
mod engine;
mod evaluate;
mod frames;
mod geometry;
mod group;
mod issues;
mod link;
mod measure;
mod place;
mod probability;
mod ranked;
mod reply;
mod robot;
mod search;
mod searcher;
mod sensitivity;
mod sets;
#[cfg(test)]
mod tests;
mod trace;
mod value;

pub use config::{Existentials, Pooling, SearchConfig, SlotOrder};
pub use engine::engine_sub_answer;
pub use frames::search_frames;
pub use search::{search, search_indexed, select};
pub use sensitivity::sensitivity;
