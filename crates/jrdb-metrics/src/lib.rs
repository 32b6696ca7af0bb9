#![doc = include_str!("../README.md")]

pub mod coco;
mod matching;
mod misses;
mod questions;

pub use matching::{Matches, match_boxes};
pub use misses::misses;
pub use questions::{MetricsConfig, Outcome, evaluate, evaluate_all, score};
