#![doc = include_str!("../README.md")]

pub mod answers;
pub mod calib;
pub mod evaluation;
pub mod health;
pub mod inputs;
pub mod interrupt;
pub mod migrate;
pub mod output;
pub mod phrase_accuracy;
pub mod questions;
pub mod report;
pub mod result;
pub mod run;
pub mod run_folder;
pub mod run_options;
pub mod source;
pub mod study;

mod description;
mod error;
mod guard;

pub use error::Error;
pub use result::{FrameOutput, FrameResult, RunSummary};
pub use run::Run;
pub use run_options::RunOptions;
