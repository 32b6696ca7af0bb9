#![doc = include_str!("../README.md")]

mod attribute;
mod between;
mod config;
mod describe;
mod engine;
mod evaluate;
mod explain;
mod found;
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
mod why_not;
mod wording;

pub use config::{Existentials, Pooling, SearchConfig, SlotOrder};
pub use describe::describe;
pub use engine::engine_sub_answer;
pub use explain::{explain, is_nearest_only};
pub use frames::search_frames;
pub use search::{search, search_indexed, select};
pub use sensitivity::sensitivity;
pub use why_not::{Reason, WhyNot, why_not};
