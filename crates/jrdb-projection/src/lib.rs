#![doc = include_str!("../README.md")]

pub mod box_view;
pub mod camera;
pub mod cloud;
pub mod config;
mod error;
pub mod frame;
pub mod heading;
pub mod localize;
mod person_box;
mod place;
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
pub use error::Error;
pub use nalgebra;
pub use place::{Placement, Space, place};
pub use project::{Motions, Scan, entities, project};
pub use sensors::{RigError, Sensors};
