//! Runs a detector with a square input on the tiles of a panorama, with suppression inside and
//! between tiles.

use jrdb_types::{Detection, Image, ImageGeometry, PixelBox};
use rayon::prelude::*;

use super::nms::{ScoredBox, nms};
use super::tiles::{Tile, tiles};
use crate::detector::{PerceptionError, check_image};
use crate::image::{Filter, resize};
use crate::numbered::CategoryBox;

/// How a panorama is cut into tiles, and how their boxes are filtered. [`crate::SsdLiteConfig`]
/// documents each number.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tiling<'a> {
    pub(crate) wraps: bool,
    pub(crate) aspects: &'a [f64],
    pub(crate) overlap: f64,
    pub(crate) border_margin: f64,
    pub(crate) nms_iou: f64,
}

/// A box with the number of its class.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ClassBox {
    pub(crate) class: usize,
    pub(crate) scored: ScoredBox,
}

/// Size of a tile in pixels of the panorama: width, height.
pub(crate) type TileSize = (f64, f64);

impl Tiling<'_> {
    /// Whether every number is within its range.
    pub(crate) fn check(&self) -> Result<(), PerceptionError> {
        let count = self.aspects.len() as f64;
        in_range("number of tile_aspects", "at least 1", count, count > 0.0)?;
        for &aspect in self.aspects {
            in_range("tile_aspects", "in (0, 10]", aspect, aspect > 0.0 && aspect <= 10.0)?;
        }
        let (overlap, margin) = (self.overlap, self.border_margin);
        in_range("tile_overlap", "in [0, 0.95]", overlap, (0.0..=0.95).contains(&overlap))?;
        in_range("border_margin", "in [0, 0.5)", margin, (0.0..0.5).contains(&margin))?;
        unit("nms_iou", self.nms_iou)
    }

    /// Size and topology of an image.
    pub(crate) fn geometry(&self, image: &Image) -> ImageGeometry {
        let (width_px, height_px) = (image.width as u32, image.height as u32);
        ImageGeometry { width_px, height_px, wraps: self.wraps }
    }

    /// Resizes every tile to a square of `side` pixels and passes it to `look`, which returns boxes
    /// in pixels of a tile of the given size. Returns the best box of every object in pixels of the
    /// image, by class, best first.
    ///
    /// Tiles run in parallel; the result does not depend on the number of threads.
    pub(crate) fn detect(
        &self,
        image: &Image,
        side: usize,
        look: impl Fn(&Image, TileSize) -> Result<Vec<ClassBox>, PerceptionError> + Sync,
    ) -> Result<Vec<ClassBox>, PerceptionError> {
        check_image(image)?;
        self.check()?;
        let geometry = self.geometry(image);
        let width_px = |aspect: &f64| (aspect * image.height as f64).round() as u32;
        let all: Vec<Tile> = (self.aspects.iter())
            .flat_map(|aspect| tiles(geometry, width_px(aspect), self.overlap))
            .collect();
        let look_at = |tile: &Tile| {
            let picture = resize(&tile.crop(image), side, side, Filter::Bilinear);
            let size = (f64::from(tile.width_px), f64::from(geometry.height_px));
            Ok(self.settle(look(&picture, size)?, *tile, geometry))
        };
        let found: Vec<Result<Vec<ClassBox>, PerceptionError>> =
            all.par_iter().map(look_at).collect();
        let mut candidates = Vec::new();
        for boxes in found {
            candidates.extend(boxes?);
        }
        Ok(best(&candidates, self.nms_iou, geometry.period_px()))
    }

    /// The boxes of a tile that are kept, in pixels of the image. Suppression runs inside each tile
    /// first, as in training: a duplicate must not survive its original when another tile shows the
    /// object better.
    fn settle(
        &self,
        mut found: Vec<ClassBox>,
        tile: Tile,
        geometry: ImageGeometry,
    ) -> Vec<ClassBox> {
        let margin_px = self.border_margin * f64::from(tile.width_px);
        let is_whole = |b: &PixelBox| b.is_proper() && !tile.cuts(b, margin_px, geometry);
        found.retain(|found| is_whole(&found.scored.bbox));
        let mut kept = best(&found, self.nms_iou, None);
        for found in &mut kept {
            found.scored.bbox = tile.to_image(found.scored.bbox, geometry);
        }
        kept
    }
}

/// Non-maximum suppression among the boxes of each class.
fn best(found: &[ClassBox], max_iou: f64, period_px: Option<f64>) -> Vec<ClassBox> {
    let mut classes: Vec<usize> = found.iter().map(|f| f.class).collect();
    classes.sort_unstable();
    classes.dedup();
    let of_class = |class: usize| {
        let boxes = found.iter().filter(|f| f.class == class).map(|f| f.scored);
        let kept = nms(&boxes.collect::<Vec<_>>(), max_iou, period_px);
        kept.into_iter().map(move |scored| ClassBox { class, scored })
    };
    classes.into_iter().flat_map(of_class).collect()
}

/// Whether a setting is within its range.
pub(crate) fn in_range(
    setting: &'static str,
    expected: &'static str,
    found: f64,
    holds: bool,
) -> Result<(), PerceptionError> {
    if holds { Ok(()) } else { Err(PerceptionError::Setting { setting, expected, found }) }
}

/// Whether a setting is in `[0, 1]`.
pub(crate) fn unit(setting: &'static str, found: f64) -> Result<(), PerceptionError> {
    in_range(setting, "in [0, 1]", found, (0.0..=1.0).contains(&found))
}

/// Boxes of one category as detections, numbered from left to right, then from top to bottom.
pub(crate) fn numbered(category: &str, boxes: Vec<ScoredBox>) -> Vec<Detection> {
    let named = |found: ScoredBox| CategoryBox {
        bbox: found.bbox,
        score: found.score,
        category: category.to_owned(),
    };
    crate::numbered::numbered(boxes.into_iter().map(named).collect())
}
