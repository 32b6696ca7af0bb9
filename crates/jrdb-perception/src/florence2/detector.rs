//! People and objects in a panorama, by Florence-2 on wrapped tiles.

use jrdb_types::detection::PERSON;
use jrdb_types::{Detections, FrameId, Image, PixelBox, Vocabulary};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::decoded_box::{DecodedBox, decoded_boxes};
use super::model::Florence2;
use super::task::Task;
use crate::detector::{Detector, Grounder, Grounding, PerceptionError, check_image};
use crate::engine::Tensor;
use crate::image::Region;
use crate::numbered::category;
use crate::tiling::Candidate;
use crate::tiling::PanoramaConfig;
use crate::tiling::Tile;
use crate::view::View;

/// Settings of the detector.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FlorenceDetectorConfig {
    /// The task, as Florence-2 writes it: `<OD>` for everything,
    /// `<OPEN_VOCABULARY_DETECTION>person` for people.
    pub task: String,
    /// How the panorama is cut into tiles.
    pub tiles: PanoramaConfig,
}

impl Default for FlorenceDetectorConfig {
    /// Everything, on tiles.
    fn default() -> Self {
        Self { task: "<OD>".into(), tiles: PanoramaConfig::default() }
    }
}

/// Detects people and objects in images of any size. Tiles run in parallel on the current rayon
/// pool; the result does not depend on its number of threads.
#[derive(Debug)]
pub struct FlorenceDetector {
    model: Florence2,
    config: FlorenceDetectorConfig,
    prompt: Vec<u32>,
    /// The id of `<loc_0>`.
    first_location: u32,
}

impl FlorenceDetector {
    /// A detector.
    ///
    /// # Errors
    /// [`PerceptionError::Task`] if the task is unknown, [`PerceptionError::Setting`] if a setting
    /// is out of range, [`PerceptionError::Token`] if the vocabulary has no locations.
    pub fn new(model: Florence2, config: FlorenceDetectorConfig) -> Result<Self, PerceptionError> {
        let task = Task::from_tag(&config.task)
            .ok_or_else(|| PerceptionError::Task { found: config.task.clone() })?;
        config.tiles.check()?;
        let (first_location, last) =
            (model.tokens().id("<loc_0>")?, model.tokens().id("<loc_999>")?);
        if last != first_location + 999 {
            return Err(PerceptionError::Token {
                token: "<loc_999> behind the other locations".into(),
            });
        }
        let prompt = model.spell(&task)?;
        Ok(Self { model, config, prompt, first_location })
    }

    /// The boxes that the model writes for a part of a picture, in pixels of that part.
    ///
    /// # Errors
    /// When the picture has no pixels or a graph fails.
    ///
    /// # Panics
    /// When the part is not in the picture.
    pub fn look(&self, image: &Image, part: Region) -> Result<Vec<DecodedBox>, PerceptionError> {
        check_image(image)?;
        self.read(&self.see(image, part)?, part, &self.prompt)
    }

    /// The image tokens of a part of a picture.
    fn see(&self, image: &Image, part: Region) -> Result<Tensor, PerceptionError> {
        self.model.see(&self.model.config().picture.prepare_part(image, part))
    }

    /// The boxes that the model writes for image tokens, in pixels of their part of the picture.
    fn read(
        &self,
        seen: &Tensor,
        part: Region,
        prompt: &[u32],
    ) -> Result<Vec<DecodedBox>, PerceptionError> {
        let sequence = self.model.answer(seen, prompt, &self.model.config().decode)?;
        let size_px = [part.width_px as f64, part.height_px as f64];
        let decoded = decoded_boxes(&sequence, self.first_location, size_px);
        let label = |ids: &[u32]| self.model.tokens().decode_words(ids);
        decoded.into_iter().map(|one| one.labelled(label)).collect()
    }
}

impl Detector for FlorenceDetector {
    fn detect(&self, image: &Image, frame: &FrameId) -> Result<Detections, PerceptionError> {
        self.config.tiles.detect(image, frame, |tile| {
            let found = self.look(image, tile.region(image))?;
            Ok(found.iter().filter_map(|one| candidate(one, tile)).collect())
        })
    }

    /// It names what it finds in its own words.
    fn categories(&self) -> Vocabulary<String> {
        Vocabulary::OPEN
    }

    fn config(&self) -> serde_json::Value {
        serde_json::json!({
            "detector": "florence2",
            "engine": self.model.engine_name(),
            "settings": self.config,
            "decode": self.model.config().decode,
        })
    }
}

impl Grounder for FlorenceDetector {
    /// Open-vocabulary detection of each sentence; all boxes count as people.
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
        let spell = |sentence: &&str| {
            let sentence = sentence.trim_end_matches(['.', '?', '!']);
            self.model.spell(&Task::OpenVocabularyDetection(sentence.into()))
        };
        let prompts: Vec<Vec<u32>> = sentences.iter().map(spell).collect::<Result<_, _>>()?;
        let person = |candidate| Candidate { category: PERSON.into(), ..candidate };
        let look = |tile: Tile| {
            let part = tile.region(image);
            let seen = self.see(image, part)?;
            let people = |prompt: &Vec<u32>| -> Result<Vec<Candidate>, PerceptionError> {
                let found = self.read(&seen, part, prompt)?;
                Ok(found.iter().filter_map(|one| candidate(one, tile)).map(person).collect())
            };
            let each: Vec<Result<_, _>> = prompts.par_iter().map(people).collect();
            each.into_iter().collect()
        };
        let found = self.config.tiles.detect_each(image, frame, sentences.len(), look)?;
        Ok(found.into_iter().map(Ok).collect())
    }
}

/// A proper box of a tile; the model may write inverted ones.
fn candidate(found: &DecodedBox, tile: Tile) -> Option<Candidate> {
    let [x0, y0, x1, y1] = found.corners;
    let in_tile = PixelBox { x: x0, y: y0, w: x1 - x0, h: y1 - y0 };
    let category = category(&found.label);
    let keep = in_tile.is_proper() && !category.is_empty();
    keep.then_some(Candidate { in_tile, tile, score: found.score, category })
}
