#![doc = include_str!("../README.md")]

pub mod coco;

mod candidates;
mod config;
#[cfg(test)]
mod example;
mod judge;
mod matching;
mod misses;
mod pool;
mod protocol;
mod ratio;
mod scores;
mod summary;
mod told;

pub use config::MetricsConfig;
pub use judge::{Outcome, score};
pub use matching::{Matches, match_boxes};
pub use misses::misses;
pub use protocol::ProtocolMismatch;
pub use scores::{MergeError, evaluate, evaluate_all, from_judgements, merge};
