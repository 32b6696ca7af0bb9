#![doc = include_str!("../README.md")]

pub mod camera;
pub mod cloud;
pub mod config;
pub mod localize;
mod person_box;
mod project;
pub mod relation;
pub mod select;
#[cfg(test)]
mod testing;

pub use camera::{CameraModel, Pixel};
pub use cloud::BaseCloud;
pub use config::ProjectionConfig;
pub use nalgebra;
pub use project::{Error, project};
