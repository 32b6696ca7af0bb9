#![doc = include_str!("../README.md")]

pub mod detector;
pub mod engine;
pub mod nanodet;
pub mod nms;
pub mod pair;
pub mod resize;
pub mod ssdlite;
mod tiled;
pub mod tiles;

pub use detector::{AttributeModel, Detector, PerceptionError};
pub use engine::{Engine, EngineError, OrtEngine, OrtLibrary, RtenEngine, Tensor};
pub use nanodet::{NanoDet, NanoDetConfig};
pub use pair::{PairConfig, PairDetector};
pub use ssdlite::{SsdLite, SsdLiteConfig};
