#![doc = include_str!("../README.md")]

pub mod coco;

mod bootstrap;
mod budget;
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
mod reliability;
mod scores;
mod slice;
mod student;
mod summary;
mod told;

pub use bootstrap::BootstrapConfig;
pub use budget::{BudgetError, TRUTHS_MAX, budget};
pub use compare::{CompareError, compare};
pub use config::MetricsConfig;
pub use intervals::intervals;
pub use judge::{Outcome, score};
pub use matching::{Matches, match_boxes};
pub use misses::misses;
pub use protocol::ProtocolMismatch;
pub use reliability::reliability;
pub use scores::{MergeError, evaluate, evaluate_all, from_judgements, merge};
pub use slice::{confusion, slices};
