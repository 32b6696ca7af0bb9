#![doc = include_str!("../README.md")]

pub mod image;
pub mod pcd;

mod boxes;
mod calibration;
mod detections;
mod error;
mod file;
mod labels;
mod lzf;
mod number;
mod questions;
mod tree;
mod writer;

pub use detections::read_detections;
pub use error::Error;
pub use image::{ImageError, PngCompression, decode_image, encode_png, read_image};
pub use labels::SequenceLabels;
pub use pcd::{PcdError, read_pcd};
pub use questions::{read_questions, write_questions};
pub use tree::Dataset;
pub use writer::{LabelledFrame, TreeWriter};
