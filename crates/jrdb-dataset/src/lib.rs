#![doc = include_str!("../README.md")]

pub mod cloud;
pub mod image;
pub mod rig;

mod answers;
mod boxes;
mod calibration;
mod describe;
mod detections;
mod error;
mod file;
mod image_error;
mod json;
mod labels;
mod name;
mod names;
mod number;
mod picture_size;
mod questions;
mod sweeps;
mod times;
mod tree;
mod writer;

pub use answers::{GivenAnswer, GivenBoxes, GivenContent, read_answers};
pub use calibration::{LidarMount, OfficialCalibration};
pub use cloud::pcd;
pub use describe::{Description, Kind, describe};
pub use detections::read_detections;
pub use error::Error;
pub use file::{PART, write as write_file};
pub use image::{
    Decoded, ImageError, ImageHeader, PngCompression, decode_image, decode_image_of, encode_png,
    image_header, read_image,
};
pub use labels::SequenceLabels;
pub use name::check_sequence_name;
pub use questions::{read_questions, write_questions};
pub use tree::Dataset;
pub use writer::{LabelledFrame, TreeWriter};
