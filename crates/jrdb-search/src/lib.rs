#![doc = include_str!("../README.md")]

mod attribute;
mod benchmark;
mod between;
mod candidates;
mod config;
mod evaluate;
mod evaluation;
mod frames;
mod geometry;
mod group;
mod issues;
mod link;
mod measure;
mod observer;
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

pub use benchmark::benchmark_sub_answer;
pub use config::{Existentials, Pooling, SearchConfig, SlotOrder};
pub use search::{search, search_frames, search_indexed, select};
pub use sensitivity::sensitivity;
