//! Grounding DINO, MM-Grounding-DINO and LLMDet: boxes for phrases, or for a whole sentence (Liu et
//! al. 2023, Zhao et al. 2024, Fu et al. 2025).

mod detector;
mod model;
mod picture;

pub use detector::{GroundingDetector, GroundingDetectorConfig};
pub use model::{Grounded, GroundingConfig, GroundingDino, GroundingOutput};
pub use picture::{Canvas, CanvasConfig};
