#![doc = include_str!("../README.md")]

mod baseline;
pub mod calib;
pub mod evaluation;
pub mod output;
pub mod perceive;
mod recording;
pub mod report;
pub mod run;
pub mod source;

mod error;

pub use error::Error;
pub use run::{RunOptions, RunResult, run};
