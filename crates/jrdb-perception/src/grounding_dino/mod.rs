//! Grounding DINO and its kin, MM-Grounding-DINO and LLMDet (Liu et al. 2023, Zhao et al. 2024, Fu et al. 2025): boxes for phrases, or for a whole
//! sentence.

mod detector;
mod model;
mod picture;

pub use detector::{GroundingDetector, GroundingDetectorConfig};
pub use model::{Grounded, GroundingConfig, GroundingDino, GroundingOutput};
pub use picture::{Canvas, CanvasConfig};
