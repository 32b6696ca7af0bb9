#![doc = include_str!("../README.md")]

pub mod baseline;
mod config;
mod conversation;
mod error;
mod frame;
mod looks;
pub mod motion;
mod pipeline;
pub mod query;
mod recording;
mod robot;
mod scene;
pub mod stream;

pub use jrdb_perception as perception;
pub use jrdb_types as types;

pub use config::PipelineConfig;
pub use conversation::Conversation;
pub use error::Error;
pub use frame::{CameraImage, Frame};
pub use pipeline::{Pipeline, PlacedFrame};
pub use query::read_query;
pub use recording::Recording;
pub use robot::Robot;
pub use scene::Scene;
