#![doc = include_str!("../README.md")]

pub mod crop;
pub mod decode;
pub mod detector;
pub mod engine;
pub mod exchange;
pub mod florence2;
pub mod grounding_dino;
pub mod merge;
pub mod nms;
mod numbered;
pub mod picture;
pub mod resize;
pub mod ssdlite;
pub mod tensor;
pub mod tiles;
pub mod tokens;
pub mod vlm;

pub use detector::{AttributeModel, Detector, PerceptionError};
pub use engine::{
    Engine, EngineError, Held, Input, OrtEngine, OrtLibrary, RtenEngine, Sessions, Tensor,
};
pub use ssdlite::{SsdLite, SsdLiteConfig};
