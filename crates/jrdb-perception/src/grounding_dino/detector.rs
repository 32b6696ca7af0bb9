//! Things in a panorama by asking for phrases, tile by tile.

use jrdb_types::{Detections, FrameId, Image, ImageGeometry, PixelBox};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{GroundingConfig, GroundingDino};
use crate::detector::{Detector, PerceptionError, check_image};
use crate::merge::{Candidate, MergeConfig, merge};
use crate::numbered::{category, numbered};
use crate::tiled::in_range;
use crate::tiles::{Tile, tiles};

/// What is looked for, and how.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct GroundingDetectorConfig {
    /// The phrases; what is found is called so. Words for people are all `person`.
    pub phrases: Vec<String>,
    /// Whether the image is a panorama whose last column borders on the first.
    pub wraps: bool,
    /// Width of a tile as a part of the image's height; 0 for the whole image as one. Default 4/3: the whole panorama of JRDB, made to
    /// fit, would show somebody of 100 pixels at 35.
    pub tile_aspect: f64,
    /// Part of its width that a tile shares with the next at least; in `[0, 0.95]`. Default 0.41: ten tiles of 640 pixels.
    pub tile_overlap: f64,
    /// Which boxes are taken.
    pub grounding: GroundingConfig,
    /// How what several tiles show becomes one.
    pub merge: MergeConfig,
}

impl Default for GroundingDetectorConfig {
    /// People, on tiles.
    fn default() -> Self {
        Self {
            phrases: vec!["person".into()],
            wraps: true,
            tile_aspect: 4.0 / 3.0,
            tile_overlap: 0.41,
            grounding: GroundingConfig::default(),
            merge: MergeConfig::default(),
        }
    }
}

/// Finds what phrases name in images of any size. Tiles run in parallel on the current rayon pool; the result does not depend on its number
/// of threads.
#[derive(Debug)]
pub struct GroundingDetector {
    model: GroundingDino,
    config: GroundingDetectorConfig,
    ids: Vec<u32>,
}

impl GroundingDetector {
    /// A detector.
    ///
    /// # Errors
    /// [`PerceptionError::Setting`] if a setting is out of range or the phrases are too long together.
    pub fn new(
        model: GroundingDino,
        config: GroundingDetectorConfig,
    ) -> Result<Self, PerceptionError> {
        let (aspect, overlap) = (config.tile_aspect, config.tile_overlap);
        let count = config.phrases.len() as f64;
        in_range("number of phrases", "at least 1", count, count > 0.0)?;
        in_range("tile_aspect", "in [0, 100]", aspect, (0.0..=100.0).contains(&aspect))?;
        in_range("tile_overlap", "in [0, 0.95]", overlap, (0.0..=0.95).contains(&overlap))?;
        config.merge.check()?;
        let ids = model.spell(&format!("{}.", config.phrases.join(". ")))?;
        Ok(Self { model, config, ids })
    }

    fn tiles(&self, image: ImageGeometry) -> Vec<Tile> {
        if self.config.tile_aspect == 0.0 {
            return vec![Tile { x_px: 0, width_px: image.width_px }];
        }
        let width_px = (self.config.tile_aspect * f64::from(image.height_px)).round() as u32;
        tiles(image, width_px, self.config.tile_overlap)
    }

    fn look_at_tile(&self, image: &Image, tile: Tile) -> Result<Vec<Candidate>, PerceptionError> {
        let picture = tile.crop(image);
        let looked = self.model.look(&picture, &self.ids)?;
        let size_px = [picture.width as f64, picture.height as f64];
        let found = self.model.grounded(&looked, &self.ids, size_px, &self.config.grounding)?;
        let candidate = |one: super::Grounded| {
            let [x0, y0, x1, y1] = one.corners;
            let in_tile = PixelBox { x: x0, y: y0, w: x1 - x0, h: y1 - y0 };
            let category = category(self.config.phrases.get(one.phrase)?);
            in_tile.is_proper().then_some(Candidate { in_tile, tile, score: one.score, category })
        };
        Ok(found.into_iter().filter_map(candidate).collect())
    }
}

impl Detector for GroundingDetector {
    fn detect(&self, image: &Image, frame: &FrameId) -> Result<Detections, PerceptionError> {
        check_image(image)?;
        let geometry = ImageGeometry {
            width_px: image.width as u32,
            height_px: image.height as u32,
            wraps: self.config.wraps,
        };
        let tiles = self.tiles(geometry);
        let looks: Vec<Result<Vec<Candidate>, _>> =
            tiles.par_iter().map(|tile| self.look_at_tile(image, *tile)).collect();
        let mut candidates = Vec::new();
        for look in looks {
            candidates.extend(look?);
        }
        let kept = merge(&candidates, &tiles, geometry, &self.config.merge);
        let frame = frame.clone();
        Ok(Detections { frame, image: geometry, detections: numbered(kept), issues: Vec::new() })
    }

    fn config(&self) -> serde_json::Value {
        serde_json::json!({
            "detector": "grounding_dino",
            "engine": self.model.engine_name(),
            "settings": self.config,
        })
    }
}
