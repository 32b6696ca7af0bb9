//! Runs a model on the tiles of a panorama and merges their boxes.

use jrdb_types::{Detections, FrameId, Image, ImageGeometry};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::merge::{Candidate, MergeConfig, merge};
use super::tiled::in_range;
use super::tiles::{Tile, tiles};
use crate::detector::{PerceptionError, check_image};
use crate::numbered::numbered;

/// How a panorama is cut into tiles, and how their boxes are merged.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PanoramaConfig {
    /// Whether the image is a panorama whose last column borders on the first.
    pub wraps: bool,
    /// Width of a tile as a part of the image's height; in `(0, 100]`, 0 for the whole image as
    /// one.
    ///
    /// Default 4/3: one of Florence-2's location bins is then 0.64 pixels of JRDB's panorama, where
    /// the whole image in one piece has 3.8; a model that makes its input fit 1333 pixels would
    /// show a person of 100 pixels at 35.
    pub tile_aspect: f64,
    /// Part of its width that a tile shares with the next at least; in `[0, 0.95]`. Default 0.41:
    /// ten tiles of 640 pixels.
    pub tile_overlap: f64,
    /// When boxes of different tiles show the same object.
    pub merge: MergeConfig,
}

impl Default for PanoramaConfig {
    /// Each field documents the source of its number.
    fn default() -> Self {
        let (tile_aspect, tile_overlap) = (4.0 / 3.0, 0.41);
        Self { wraps: true, tile_aspect, tile_overlap, merge: MergeConfig::default() }
    }
}

impl PanoramaConfig {
    /// A picture as a single tile that does not wrap around.
    #[must_use]
    pub fn one_tile() -> Self {
        Self { wraps: false, tile_aspect: 0.0, tile_overlap: 0.0, ..Self::default() }
    }

    pub(crate) fn check(&self) -> Result<(), PerceptionError> {
        let (aspect, overlap) = (self.tile_aspect, self.tile_overlap);
        in_range("tile_aspect", "in [0, 100]", aspect, (0.0..=100.0).contains(&aspect))?;
        in_range("tile_overlap", "in [0, 0.95]", overlap, (0.0..=0.95).contains(&overlap))?;
        self.merge.check()
    }

    fn tiles(&self, image: ImageGeometry) -> Vec<Tile> {
        if self.tile_aspect == 0.0 {
            return vec![Tile { x_px: 0, width_px: image.width_px }];
        }
        let width_px = (self.tile_aspect * f64::from(image.height_px)).round() as u32;
        tiles(image, width_px, self.tile_overlap)
    }

    /// The detections that `look` finds in the tiles, with those of several tiles merged.
    ///
    /// Tiles run in parallel on the current rayon pool; the result does not depend on the number of
    /// threads.
    ///
    /// # Errors
    /// [`PerceptionError::Image`] if the image has no pixels, [`PerceptionError::Setting`] if a
    /// number is out of its range, else the first error of `look`.
    pub fn detect(
        &self,
        image: &Image,
        frame: &FrameId,
        look: impl Fn(Tile) -> Result<Vec<Candidate>, PerceptionError> + Sync,
    ) -> Result<Detections, PerceptionError> {
        let look = |tile| Ok(vec![look(tile)?]);
        Ok(self.detect_each(image, frame, 1, look)?.swap_remove(0))
    }

    /// [`PanoramaConfig::detect`] for so many searches at once: `look` returns the candidates of
    /// each in a tile.
    pub(crate) fn detect_each(
        &self,
        image: &Image,
        frame: &FrameId,
        searches: usize,
        look: impl Fn(Tile) -> Result<Vec<Vec<Candidate>>, PerceptionError> + Sync,
    ) -> Result<Vec<Detections>, PerceptionError> {
        check_image(image)?;
        self.check()?;
        let geometry = ImageGeometry {
            width_px: image.width as u32,
            height_px: image.height as u32,
            wraps: self.wraps,
        };
        let tiles = self.tiles(geometry);
        let looks: Vec<Result<Vec<Vec<Candidate>>, _>> =
            tiles.par_iter().map(|tile| look(*tile)).collect();
        let mut found: Vec<Vec<Candidate>> = vec![Vec::new(); searches];
        for look in looks {
            for (all, candidates) in found.iter_mut().zip(look?) {
                all.extend(candidates);
            }
        }
        let merged = |candidates: &Vec<Candidate>| {
            let kept = merge(candidates, &tiles, geometry, &self.merge);
            Detections::new(frame.clone(), geometry, numbered(kept))
        };
        Ok(found.par_iter().map(merged).collect())
    }
}
