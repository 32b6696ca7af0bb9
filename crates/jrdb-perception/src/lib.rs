#![doc = include_str!("../README.md")]

pub mod appearance;
mod color;
mod crop;
pub mod demographics;
pub mod detector;
pub mod engine;
pub mod face;
mod facing;
pub mod nanodet;
pub mod nms;
pub mod pair;
mod posture;
pub mod resize;
pub mod ssdlite;
mod tiled;
pub mod tiles;

pub use appearance::{Appearance, AppearanceConfig, Described, FaceModels};
pub use demographics::FaceReader;
pub use detector::{AttributeModel, Detector, PerceptionError};
pub use engine::{Engine, EngineError, OrtEngine, OrtLibrary, RtenEngine, Tensor};
pub use face::{Face, FaceFinder};
pub use nanodet::{NanoDet, NanoDetConfig};
pub use pair::{PairConfig, PairDetector};
pub use ssdlite::{SsdLite, SsdLiteConfig};
