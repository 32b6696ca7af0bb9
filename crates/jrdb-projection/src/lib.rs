#![doc = include_str!("../README.md")]

pub mod box_view;
pub mod camera;
pub mod cloud;
pub mod config;
pub mod frame;
pub mod heading;
pub mod localize;
mod person_box;
mod project;
mod quality;
pub mod relation;
pub mod select;
pub mod sensors;
mod simd;
#[cfg(test)]
mod testing;

pub use camera::{CameraModel, Pixel};
pub use cloud::BaseCloud;
pub use config::ProjectionConfig;
pub use nalgebra;
pub use project::{Error, Scan, project};
pub use sensors::{RigError, Sensors};
