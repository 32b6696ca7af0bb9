//! What is evaluated: boxes that are there, and boxes that are claimed to be there.

use jrdb_types::PixelBox;

/// A box that is there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GroundTruthBox {
    /// Which image it is in.
    pub image: u64,
    /// Its category.
    pub category: u64,
    /// Where, pixels.
    pub bbox: PixelBox,
    /// Area by which it is small, medium or large, square pixels; may differ from the box's.
    pub area_px2: f64,
    /// Stands for many: neither to be found nor missed, and any number of detections may lie in it.
    pub crowd: bool,
}

impl GroundTruthBox {
    /// A single thing whose area is its box's.
    #[must_use]
    pub fn new(image: u64, category: u64, bbox: PixelBox) -> Self {
        Self { image, category, bbox, area_px2: bbox.area_px2(), crowd: false }
    }
}

/// A box that is claimed to be there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DetectionBox {
    /// Which image it is in.
    pub image: u64,
    /// Its category.
    pub category: u64,
    /// Where, pixels.
    pub bbox: PixelBox,
    /// Confidence; only the order counts.
    pub score: f64,
}

/// What is evaluated. Images and categories are those that occur.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Dataset {
    /// What is there.
    pub truth: Vec<GroundTruthBox>,
    /// What is claimed. Equal scores keep their order within an image; images go by number.
    pub detections: Vec<DetectionBox>,
}
