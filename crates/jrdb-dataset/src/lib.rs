#![doc = include_str!("../README.md")]

pub mod cloud;
pub mod image;
pub mod rig;

mod boxes;
mod calibration;
mod describe;
mod detections;
mod error;
mod file;
mod image_error;
mod json;
mod labels;
mod names;
mod number;
mod questions;
mod sweeps;
mod times;
mod tree;
mod writer;

pub use calibration::{LidarMount, OfficialCalibration};
pub use cloud::pcd;
pub use describe::{Description, Kind, describe};
pub use detections::read_detections;
pub use error::Error;
pub use image::{
    ImageError, ImageHeader, PngCompression, decode_image, encode_png, image_header, read_image,
};
pub use labels::SequenceLabels;
pub use questions::{read_questions, write_questions};
pub use tree::Dataset;
pub use writer::{LabelledFrame, TreeWriter};
