#![doc = include_str!("../README.md")]

mod baseline;
pub mod calib;
pub mod exam;
pub mod frame;
pub mod motion;
pub mod output;
pub mod perceive;
pub mod query;
mod recording;
pub mod report;
pub mod run;
pub mod source;

mod error;

pub use error::{Error, with_causes};
pub use frame::{Asked, FrameInput, FrameOutput, PipelineConfig, process};
pub use query::read_query;
pub use run::{RunOptions, RunResult, run};
