#![doc = include_str!("../README.md")]

pub mod detector;
pub mod engine;
pub mod exchange;
pub mod exchange_phrase;
#[cfg(test)]
mod fixed;
#[cfg(feature = "vlm")]
pub mod florence2;
#[cfg(feature = "vlm")]
pub mod generation;
#[cfg(feature = "vlm")]
pub mod grounding_dino;
pub mod image;
mod json;
pub mod light;
mod numbered;
pub mod perceive;
pub mod phrase;
pub mod prompts;
pub mod tiling;
mod view;
#[cfg(feature = "vlm")]
pub mod vlm;

pub use detector::{AttributeModel, Detector, Grounder, Grounding, PerceptionError};
#[cfg(feature = "rten")]
pub use engine::RtenEngine;
pub use engine::{
    DeviceTensor, DeviceValue, Engine, EngineError, Input, Parameters, Tensor, Weight, check_onnx,
    count_parameters,
};
#[cfg(feature = "ort")]
pub use engine::{OrtEngine, OrtLibrary, Sessions};
pub use light::{
    Appearance, AppearanceConfig, Face, FaceFinder, FaceModels, FaceReader, NanoDet, NanoDetConfig,
    PairConfig, PairDetector, SsdLite, SsdLiteConfig,
};
pub use perceive::{KnownDetections, Models, Perceive};
pub use phrase::{PhraseModel, Subject};
pub use view::View;
