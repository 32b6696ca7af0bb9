//! People and objects in a panorama, by phrases on each tile.

use jrdb_types::detection::PERSON;
use jrdb_types::{Detections, FrameId, Image, PixelBox, Vocabulary};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::model::{Grounded, GroundingConfig, GroundingDino};
use crate::detector::{Detector, Grounder, Grounding, PerceptionError};
use crate::numbered::category;
use crate::tiling::Candidate;
use crate::tiling::PanoramaConfig;
use crate::tiling::Tile;
use crate::tiling::tiled::in_range;
use crate::view::View;

/// Settings of the detector.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct GroundingDetectorConfig {
    /// The phrases, which are the categories of the boxes. Words for people become `person`.
    pub phrases: Vec<String>,
    /// How the panorama is cut into tiles.
    pub tiles: PanoramaConfig,
    /// Which boxes are taken.
    pub grounding: GroundingConfig,
}

impl Default for GroundingDetectorConfig {
    /// People, on tiles.
    fn default() -> Self {
        Self {
            phrases: vec!["person".into()],
            tiles: PanoramaConfig::default(),
            grounding: GroundingConfig::default(),
        }
    }
}

/// Detects the objects that phrases name in images of any size. Tiles run in parallel on the
/// current rayon pool; the result does not depend on its number of threads.
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
    /// [`PerceptionError::Setting`] if a setting is out of range or the phrases are too long
    /// together.
    pub fn new(
        model: GroundingDino,
        config: GroundingDetectorConfig,
    ) -> Result<Self, PerceptionError> {
        let count = config.phrases.len() as f64;
        in_range("number of phrases", "at least 1", count, count > 0.0)?;
        config.tiles.check()?;
        let ids = model.spell(&format!("{}.", config.phrases.join(". ")))?;
        Ok(Self { model, config, ids })
    }

    /// The boxes of a prompt in a tile; `name` returns the category of a phrase.
    fn look_at_tile(
        &self,
        image: &Image,
        tile: Tile,
        ids: &[u32],
        name: &(impl Fn(usize) -> Option<String> + Sync),
    ) -> Result<Vec<Candidate>, PerceptionError> {
        let picture = tile.crop(image);
        let output = self.model.look(&picture, ids)?;
        let size_px = [picture.width as f64, picture.height as f64];
        let found = self.model.grounded(&output, ids, size_px, &self.config.grounding)?;
        let candidate = |one: Grounded| {
            let [x0, y0, x1, y1] = one.corners;
            let in_tile = PixelBox { x: x0, y: y0, w: x1 - x0, h: y1 - y0 };
            let category = name(one.phrase)?;
            in_tile.is_proper().then_some(Candidate { in_tile, tile, score: one.score, category })
        };
        Ok(found.into_iter().filter_map(candidate).collect())
    }
}

impl Detector for GroundingDetector {
    fn detect(&self, image: &Image, frame: &FrameId) -> Result<Detections, PerceptionError> {
        let name = |phrase: usize| self.config.phrases.get(phrase).map(|words| category(words));
        let look = |tile| self.look_at_tile(image, tile, &self.ids, &name);
        self.config.tiles.detect(image, frame, look)
    }

    fn categories(&self) -> Vocabulary<String> {
        self.config.phrases.iter().map(|words| category(words)).collect()
    }

    fn config(&self) -> serde_json::Value {
        serde_json::json!({
            "detector": "grounding_dino",
            "engine": self.model.engine_name(),
            "settings": self.config,
        })
    }
}

impl Grounder for GroundingDetector {
    /// A sentence is one phrase; all boxes count as people. The model sees image and words in one
    /// graph, so that each sentence is a run of its own.
    fn ground(
        &self,
        frame: &FrameId,
        view: &View<'_>,
        sentences: &[&str],
    ) -> Result<Vec<Grounding>, PerceptionError> {
        let image = match view.pixels() {
            Ok(image) => image,
            Err(issue) => return Ok(vec![Err(issue); sentences.len()]),
        };
        let ground = |sentence: &&str| {
            let sentence = sentence.trim_end_matches(['.', '?', '!']).replace(['.', '?'], " ");
            let ids = self.model.spell(&format!("{sentence}."))?;
            let look = |tile| self.look_at_tile(image, tile, &ids, &|_| Some(PERSON.into()));
            self.config.tiles.detect(image, frame, look).map(Ok)
        };
        let each: Vec<Result<_, _>> = sentences.par_iter().map(ground).collect();
        each.into_iter().collect()
    }
}
