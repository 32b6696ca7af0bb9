#![doc = include_str!("../README.md")]

pub mod appearance;
mod color;
pub mod crop;
pub mod decode;
pub mod demographics;
pub mod detector;
pub mod engine;
pub mod exchange;
pub mod face;
mod facing;
#[cfg(test)]
mod fixed;
pub mod florence2;
pub mod grounding_dino;
mod log_sum_exp;
pub mod merge;
pub mod nanodet;
pub mod nms;
mod numbered;
pub mod pair;
pub mod perceive;
pub mod picture;
mod posture;
pub mod resize;
pub mod ssdlite;
pub mod sweep;
pub mod tensor;
mod tiled;
pub mod tiles;
pub mod tokens;
pub mod vlm;

pub use appearance::{Appearance, AppearanceConfig, FaceModels};
pub use demographics::FaceReader;
pub use detector::{AttributeModel, Detector, Grounder, PerceptionError};
pub use engine::{
    DeviceTensor, DeviceValue, Engine, EngineError, Input, OrtEngine, OrtLibrary, RtenEngine,
    Sessions, Tensor,
};
pub use face::{Face, FaceFinder};
pub use nanodet::{NanoDet, NanoDetConfig};
pub use pair::{PairConfig, PairDetector};
pub use perceive::{KnownDetections, Models, Perceive, View};
pub use ssdlite::{SsdLite, SsdLiteConfig};
