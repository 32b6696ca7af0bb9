//! Merges the boxes of overlapping tiles, for detectors whose confidences do not separate
//! duplicates.

use jrdb_types::{ImageGeometry, PixelBox};
use serde::{Deserialize, Serialize};

use super::tiles::Tile;
use crate::detector::PerceptionError;
use crate::numbered::CategoryBox;

/// When boxes of different tiles show the same object.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MergeConfig {
    /// Least confidence of a box, in `[0, 1]`. Default 0: all boxes of the model count.
    pub min_score: f64,
    /// A box this near to a border between tiles may be cut by it, pixels. Default 2.
    pub border_px: f64,
    /// A cut box is dropped if another tile has an uncut one that covers this part of the smaller
    /// of both. Default 0.6.
    pub cut_cover: f64,
    /// Boxes that overlap by more than this IoU show the same object, in `[0, 1]`. Default 0.55.
    pub same_iou: f64,
    /// And those of which one covers more than this part of the smaller, in `[0, 1]`. Default 0.8.
    pub same_cover: f64,
}

impl Default for MergeConfig {
    /// Each field documents the source of its number.
    fn default() -> Self {
        Self { min_score: 0.0, border_px: 2.0, cut_cover: 0.6, same_iou: 0.55, same_cover: 0.8 }
    }
}

impl MergeConfig {
    pub(crate) fn check(&self) -> Result<(), PerceptionError> {
        let unit = [
            ("min_score", self.min_score),
            ("cut_cover", self.cut_cover),
            ("same_iou", self.same_iou),
            ("same_cover", self.same_cover),
        ];
        for (setting, found) in unit {
            if !(0.0..=1.0).contains(&found) {
                return Err(PerceptionError::Setting { setting, expected: "in [0, 1]", found });
            }
        }
        if self.border_px.is_nan() || self.border_px < 0.0 {
            let (setting, expected, found) = ("border_px", "at least 0", self.border_px);
            return Err(PerceptionError::Setting { setting, expected, found });
        }
        Ok(())
    }
}

/// A box in a tile.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// Where, pixels of the tile.
    pub in_tile: PixelBox,
    /// The tile.
    pub tile: Tile,
    /// Confidence in `[0, 1]`.
    pub score: f64,
    /// Its category. Only boxes of one category are merged.
    pub category: String,
}

/// A candidate in the image.
struct Placed<'a> {
    bbox: PixelBox,
    candidate: &'a Candidate,
    is_cut: bool,
    /// From the middle of the box to the middle of its tile, pixels.
    off_px: f64,
}

/// The objects that the tiles show, each once.
///
/// An uncut box replaces a box that a border of its tile cuts. Of several boxes of the same object,
/// the one nearest to the middle of its tile is kept, because the model sees its surroundings; of
/// equally near boxes, the most confident.
#[must_use]
pub fn merge(
    candidates: &[Candidate],
    tiles: &[Tile],
    image: ImageGeometry,
    config: &MergeConfig,
) -> Vec<CategoryBox> {
    let period_px = image.period_px();
    let place = |candidate: &'_ Candidate| -> (PixelBox, bool, f64) {
        let (tile, bbox) = (candidate.tile, candidate.in_tile);
        let is_cut = tiles.len() > 1 && tile.cuts(&bbox, config.border_px, image);
        let off_px = (bbox.x + bbox.w / 2.0 - f64::from(tile.width_px) / 2.0).abs();
        (tile.to_image(bbox, image), is_cut, off_px)
    };
    let mut placed: Vec<Placed<'_>> = candidates
        .iter()
        .filter(|candidate| candidate.score >= config.min_score)
        .map(|candidate| {
            let (bbox, is_cut, off_px) = place(candidate);
            Placed { bbox, candidate, is_cut, off_px }
        })
        .collect();
    placed.sort_by(|a, b| {
        let (first, second) = (a.candidate, b.candidate);
        a.is_cut
            .cmp(&b.is_cut)
            .then(a.off_px.total_cmp(&b.off_px))
            .then(second.score.total_cmp(&first.score))
            .then(a.bbox.x.total_cmp(&b.bbox.x))
            .then(a.bbox.y.total_cmp(&b.bbox.y))
    });
    let mut kept: Vec<Placed<'_>> = Vec::new();
    for next in placed {
        let same = |other: &Placed<'_>| {
            let cover = cover(&next.bbox, &other.bbox, period_px);
            let most = if next.is_cut { config.cut_cover } else { config.same_cover };
            other.candidate.category == next.candidate.category
                && (cover > most || next.bbox.iou(&other.bbox, period_px) > config.same_iou)
        };
        if !kept.iter().any(same) {
            kept.push(next);
        }
    }
    let in_image = |one: Placed<'_>| CategoryBox {
        bbox: one.bbox,
        score: one.candidate.score,
        category: one.candidate.category.clone(),
    };
    kept.into_iter().map(in_image).collect()
}

/// The part of the smaller of two boxes that the other covers.
fn cover(a: &PixelBox, b: &PixelBox, period_px: Option<f64>) -> f64 {
    let both = period_px.map_or_else(
        || a.intersection_px2(b),
        |period_px| a.circular_intersection_px2(b, period_px),
    );
    let smaller = a.area_px2().min(b.area_px2());
    if smaller > 0.0 { both / smaller } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tiling::tiles::tiles;
    use proptest::prelude::*;

    const IMAGE: ImageGeometry = ImageGeometry { width_px: 1000, height_px: 100, wraps: true };

    /// The output of a perfect detector: in every tile the visible part of each object.
    fn seen(things: &[PixelBox], tiles: &[Tile]) -> Vec<Candidate> {
        let in_tile = |thing: &PixelBox, tile: &Tile| {
            let start = (thing.x - f64::from(tile.x_px)).rem_euclid(1000.0);
            let start =
                if start > 500.0 + f64::from(tile.width_px) / 2.0 { start - 1000.0 } else { start };
            let (left, right) = (start.max(0.0), (start + thing.w).min(f64::from(tile.width_px)));
            (right - left > 3.0).then_some(PixelBox { x: left, w: right - left, ..*thing })
        };
        let all = tiles.iter().flat_map(|tile| things.iter().map(move |thing| (tile, thing)));
        all.filter_map(|(tile, thing)| {
            let in_tile = in_tile(thing, tile)?;
            Some(Candidate { in_tile, tile: *tile, score: 0.5, category: "person".into() })
        })
        .collect()
    }

    proptest! {
        #[test]
        fn things_apart_are_found_once_each_wherever_tiles_begin(
            starts in proptest::collection::vec(0_u32..20, 1..12), wide in 8_u32..40,
        ) {
            let mut starts = starts;
            starts.sort_unstable();
            starts.dedup();
            let things: Vec<PixelBox> =
                starts.iter().map(|s| PixelBox::from([f64::from(s * 50), 10.0, f64::from(wide), 80.0])).collect();
            let tiles = tiles(IMAGE, 200, 0.41);
            let mut found = merge(&seen(&things, &tiles), &tiles, IMAGE, &MergeConfig::default());
            found.sort_by(|a, b| a.bbox.x.total_cmp(&b.bbox.x));
            let boxes: Vec<PixelBox> = found.iter().map(|one| one.bbox).collect();
            prop_assert_eq!(boxes, things);
        }
    }

    #[test]
    fn one_tile_is_left_as_it_is() {
        let tile = Tile { x_px: 0, width_px: 1000 };
        let at = |x: f64| Candidate {
            in_tile: PixelBox::from([x, 0.0, 30.0, 50.0]),
            tile,
            score: 0.5,
            category: "person".into(),
        };
        let found = merge(&[at(0.0), at(970.0)], &[tile], IMAGE, &MergeConfig::default());
        assert_eq!(found.len(), 2);
    }
}
