#![doc = include_str!("../README.md")]

pub mod detector;
pub mod engine;
pub mod nms;
pub mod resize;
pub mod ssdlite;
pub mod tensor;
pub mod tiles;

pub use detector::{AttributeModel, Detector, PerceptionError};
pub use engine::{Engine, EngineError, OrtEngine, OrtLibrary, RtenEngine, Tensor};
pub use ssdlite::{SsdLite, SsdLiteConfig};
