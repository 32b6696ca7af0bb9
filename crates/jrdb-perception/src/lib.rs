#![doc = include_str!("../README.md")]

pub mod appearance;
mod color;
pub mod crop;
#[cfg(feature = "vlm")]
pub mod decode;
pub mod demographics;
pub mod detector;
pub mod engine;
pub mod exchange;
pub mod face;
mod facing;
#[cfg(test)]
mod fixed;
#[cfg(feature = "vlm")]
pub mod florence2;
#[cfg(feature = "vlm")]
pub mod grounding_dino;
mod json;
#[cfg(feature = "vlm")]
mod log_sum_exp;
pub mod merge;
pub mod nanodet;
pub mod nms;
mod numbered;
pub mod pair;
pub mod perceive;
pub mod picture;
mod posture;
pub mod prompts;
pub mod resize;
pub mod ssdlite;
pub mod sweep;
pub mod tensor;
mod tiled;
pub mod tiles;
#[cfg(feature = "vlm")]
pub mod tokens;
#[cfg(feature = "vlm")]
pub mod vlm;

pub use appearance::{Appearance, AppearanceConfig, FaceModels};
pub use demographics::FaceReader;
pub use detector::{AttributeModel, Detector, Grounder, PerceptionError};
#[cfg(feature = "rten")]
pub use engine::RtenEngine;
pub use engine::{DeviceTensor, DeviceValue, Engine, EngineError, Input, Tensor};
#[cfg(feature = "ort")]
pub use engine::{OrtEngine, OrtLibrary, Sessions};
pub use face::{Face, FaceFinder};
pub use nanodet::{NanoDet, NanoDetConfig};
pub use pair::{PairConfig, PairDetector};
pub use perceive::{KnownDetections, Models, Perceive, View};
pub use ssdlite::{SsdLite, SsdLiteConfig};
