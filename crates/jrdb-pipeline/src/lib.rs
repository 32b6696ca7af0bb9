#![doc = include_str!("../README.md")]

pub mod frame;
pub mod motion;
pub mod query;
pub mod robot;

mod error;

pub use error::{Error, with_causes};
pub use frame::{Asked, FrameInput, FrameOutput, PipelineConfig, process};
pub use query::read_query;
pub use robot::Robot;
