#![doc = include_str!("../README.md")]

pub mod coco;

mod bootstrap;
mod candidates;
mod compare;
mod config;
#[cfg(test)]
mod coverage;
#[cfg(test)]
mod example;
mod intervals;
mod jackknife;
mod judge;
mod matching;
mod misses;
mod pool;
mod protocol;
mod random;
mod ratio;
mod recordings;
mod scores;
mod student;
mod summary;
mod told;

pub use bootstrap::BootstrapConfig;
pub use compare::{CompareError, compare};
pub use config::MetricsConfig;
pub use intervals::intervals;
pub use judge::{Outcome, score};
pub use matching::{Matches, match_boxes};
pub use misses::misses;
pub use protocol::ProtocolMismatch;
pub use scores::{MergeError, evaluate, evaluate_all, from_judgements, merge};
