//! Small models for a processor: people, objects of COCO's classes, and the appearance of people.

mod appearance;
mod color;
mod demographics;
mod face;
mod facing;
mod nanodet;
mod pair;
mod posture;
mod ssdlite;

pub use appearance::{Appearance, AppearanceConfig, FaceModels};
pub use demographics::FaceReader;
pub use face::{Face, FaceFinder};
pub use nanodet::{COCO_CLASSES, NanoDet, NanoDetConfig};
pub use pair::{PairConfig, PairDetector};
pub use ssdlite::{SsdLite, SsdLiteConfig};
