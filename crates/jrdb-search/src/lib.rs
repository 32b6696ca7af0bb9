#![doc = include_str!("../README.md")]

mod attribute;
mod benchmark;
mod between;
mod candidates;
mod causes;
mod config;
mod evaluate;
mod evaluation;
mod eyes;
mod frames;
mod geometry;
mod group;
mod issues;
mod known;
mod link;
mod looks;
mod measure;
mod observer;
mod place;
mod probability;
mod ranked;
mod reply;
mod robot;
mod search;
mod searcher;
mod seen;
mod sensitivity;
mod sets;
mod status;
#[cfg(test)]
mod tests;
mod trace;
mod value;

pub use benchmark::benchmark_sub_answer;
pub use config::{Existentials, Pooling, SearchConfig, SlotOrder, World};
pub use looks::{Blind, Looks};
pub use search::{search, search_frames, search_indexed, search_with, select};
pub use sensitivity::sensitivity;
