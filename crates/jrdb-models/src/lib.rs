#![doc = include_str!("../README.md")]

pub mod backbone;
pub mod catalogue;
pub mod demographics;
mod digest;
mod error;
pub mod fetch;
mod labels;
pub mod loader;
mod options;
pub mod parameters;
mod perception;
pub mod profile;
mod python;
pub mod quality;
mod replay;
pub mod trial;

pub use digest::sha256_hex;
pub use error::Error;
pub use labels::Labels;
pub use options::{PerceptionOptions, SequenceSource};
pub use perception::{Perception, PerceptionSource};
pub use replay::Replay;
