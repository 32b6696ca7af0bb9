#![doc = include_str!("../README.md")]

pub mod coco;
mod matching;
mod questions;

pub use matching::{Matches, match_boxes};
pub use questions::{MetricsConfig, Outcome, evaluate, score};
