//! People and objects of COCO's 80 classes by NanoDet-g on 416 x 416 pixels (Li et al., Generalized
//! Focal Loss, 2020, for the boxes), run on wrapped tiles.

use std::fmt;

use jrdb_types::{Detections, FrameId, Image, PixelBox, Vocabulary};
use serde::{Deserialize, Serialize};

mod classes;

pub use classes::COCO_CLASSES;

use crate::detector::{Detector, PerceptionError, rows};
use crate::engine::{Engine, Tensor};
use crate::tiling::ScoredBox;
use crate::tiling::tiled::{ClassBox, TileSize, Tiling, numbered, unit};

/// Side of the model's input, pixels.
const SIDE: usize = 416;
/// Name of the model's input: f32 `[1, 3, 416, 416]`, channels blue, green, red.
const INPUT: &str = "input_1";
/// Pixels of the input to a cell of each grid, and the grid's tensors: scores f32 `[1, cells, 80]`,
/// and for each of a box's four sides a distribution over 11 distances, f32 `[1, cells, 44]`.
const GRIDS: [(usize, &str, &str); 3] = [
    (8, "Identity", "Identity_3"),
    (16, "Identity_1", "Identity_4"),
    (32, "Identity_2", "Identity_5"),
];
const CLASSES: usize = COCO_CLASSES.len();
/// Distances that a side may have from its cell's middle, in cells: 0 to 10.
const DISTANCES: usize = 11;
const SIDES: usize = 4;
/// Mean and standard deviation of the pictures that the model was trained on, ImageNet's: blue,
/// green, red.
const MEAN: [f32; 3] = [103.53, 116.28, 123.675];
const DEVIATION: [f32; 3] = [57.375, 57.12, 58.395];

/// Settings of the detector.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct NanoDetConfig {
    /// Whether the image is a 360° panorama whose last column borders on the first.
    pub wraps: bool,
    /// Widths of the tiles, as parts of the image's height (tiles are as high as the image); in
    /// `(0, 10]`.
    ///
    /// Default 4/3 alone: of the widths tried on a labelled frame of JRDB (2/3, 5/6, 1, 7/6, 4/3)
    /// the best second opinion on people, and the one that shows most chairs whole.
    pub tile_aspects: Vec<f64>,
    /// Part of its width that a tile shares with the next; in `[0, 0.95]`.
    ///
    /// Default 1/2: everything up to half a tile wide lies whole in some tile; 3/4 takes twice the
    /// time and gave no better people.
    pub tile_overlap: f64,
    /// A box this near to a border between tiles is dropped, as a part of the tile's width, in `[0,
    /// 0.5)`. Default 1/100, as for the other detector.
    pub border_margin: f64,
    /// Least confidence of a detection, in `[0, 1]`. Default 0.4: by eye on a frame of JRDB, where
    /// 0.35 yields false cats and microwaves.
    pub min_score: f64,
    /// Boxes of one class that overlap by more than this IoU are the same object, in `[0, 1]`.
    /// Default 1/2, as for the other detector.
    pub nms_iou: f64,
}

impl Default for NanoDetConfig {
    /// For panoramas of 360°. Each field documents the source of its number.
    fn default() -> Self {
        Self {
            wraps: true,
            tile_aspects: vec![4.0 / 3.0],
            tile_overlap: 0.5,
            border_margin: 0.01,
            min_score: 0.4,
            nms_iou: 0.5,
        }
    }
}

impl NanoDetConfig {
    fn tiling(&self) -> Tiling<'_> {
        Tiling {
            wraps: self.wraps,
            aspects: &self.tile_aspects,
            overlap: self.tile_overlap,
            border_margin: self.border_margin,
            nms_iou: self.nms_iou,
        }
    }
}

/// Finds people and objects in panoramas of any size; categories are [`COCO_CLASSES`].
///
/// Tiles run in parallel on the current rayon pool; the result does not depend on its number of
/// threads.
pub struct NanoDet {
    engine: Box<dyn Engine>,
    config: NanoDetConfig,
}

impl fmt::Debug for NanoDet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut shown = f.debug_struct("NanoDet");
        shown.field("engine", &self.engine.name()).field("config", &self.config);
        shown.finish()
    }
}

impl NanoDet {
    /// A detector on an engine that has loaded the model.
    #[must_use]
    pub fn new(engine: Box<dyn Engine>, config: NanoDetConfig) -> Self {
        Self { engine, config }
    }

    /// Detections in a square picture of a tile, in pixels of that tile.
    fn look(&self, picture: &Image, size: TileSize) -> Result<Vec<ClassBox>, PerceptionError> {
        let names: Vec<&str> = (GRIDS.iter().map(|(_, scores, _)| *scores))
            .chain(GRIDS.iter().map(|(.., sides)| *sides))
            .collect();
        let outputs = self.engine.run(&[(INPUT, &input(picture))], &names)?;
        let mut found = Vec::new();
        for (index, (stride, scores, sides)) in GRIDS.into_iter().enumerate() {
            let cells = (SIDE / stride).pow(2);
            let scores = rows::<CLASSES>(scores, &outputs, index, cells)?;
            let sides = rows::<{ SIDES * DISTANCES }>(sides, &outputs, GRIDS.len() + index, cells)?;
            for (cell, (scores, sides)) in scores.iter().zip(sides).enumerate() {
                found.extend(self.cell(scores, || decode(cell, stride, sides, size)));
            }
        }
        Ok(found)
    }

    /// The classes that a cell is sure enough of, with its box, which is worked out only then.
    fn cell(&self, scores: &[f32; CLASSES], bbox: impl Fn() -> PixelBox) -> Vec<ClassBox> {
        let scores = scores.iter().map(|score| f64::from(*score)).enumerate();
        let sure = scores.filter(|(_, score)| *score >= self.config.min_score);
        sure.map(|(class, score)| ClassBox { class, scored: ScoredBox { bbox: bbox(), score } })
            .collect()
    }
}

impl Detector for NanoDet {
    fn detect(&self, image: &Image, frame: &FrameId) -> Result<Detections, PerceptionError> {
        unit("min_score", self.config.min_score)?;
        let tiling = self.config.tiling();
        let found = tiling.detect(image, SIDE, |picture, size| self.look(picture, size))?;
        let of_class = |class: usize| {
            let boxes = found.iter().filter(|found| found.class == class);
            numbered(COCO_CLASSES[class], boxes.map(|found| found.scored).collect())
        };
        let mut detections: Vec<_> = (0..CLASSES).flat_map(of_class).collect();
        detections.sort_by(|a, b| a.id.cmp(&b.id));
        let (frame, image) = (frame.clone(), tiling.geometry(image));
        Ok(Detections::new(frame, image, detections))
    }

    fn categories(&self) -> Vocabulary<String> {
        COCO_CLASSES.iter().map(|&class| class.into()).collect()
    }

    fn config(&self) -> serde_json::Value {
        serde_json::json!({
            "detector": "nanodet",
            "engine": self.engine.name(),
            "settings": self.config,
        })
    }
}

/// The input of the model: planes of blue, green, red, minus their mean, divided by their
/// deviation.
fn input(picture: &Image) -> Tensor {
    let plane = |channel: usize| {
        let bytes = picture.rgb.iter().skip(2 - channel).step_by(3);
        bytes.map(move |&byte| (f32::from(byte) - MEAN[channel]) / DEVIATION[channel])
    };
    let data = (0..3).flat_map(plane).collect();
    Tensor::F32 { shape: vec![1, 3, picture.height, picture.width], data }
}

/// The box that a cell's distributions make, cut to the tile, in pixels of a tile of this size:
/// each side lies at the expected distance from the cell's middle.
fn decode(
    cell: usize,
    stride: usize,
    sides: &[f32; SIDES * DISTANCES],
    (width_px, height_px): TileSize,
) -> PixelBox {
    let middle = |place: usize| (place as f64 + 0.5) * stride as f64;
    let across = SIDE / stride;
    let (cx, cy) = (middle(cell % across), middle(cell / across));
    let distance = |side: usize| expected(&sides[side * DISTANCES..][..DISTANCES]) * stride as f64;
    let part = |pixels: f64| (pixels / SIDE as f64).clamp(0.0, 1.0);
    let (x0, y0) = (part(cx - distance(0)), part(cy - distance(1)));
    let (x1, y1) = (part(cx + distance(2)), part(cy + distance(3)));
    PixelBox::from([x0 * width_px, y0 * height_px, (x1 - x0) * width_px, (y1 - y0) * height_px])
}

/// Expected place under the softmax of the numbers.
fn expected(logits: &[f32]) -> f64 {
    let logits = logits.iter().map(|logit| f64::from(*logit));
    let greatest = logits.clone().fold(f64::NEG_INFINITY, f64::max);
    let (sum, moment) = logits.zip(0_u32..).fold((0.0, 0.0), |(sum, moment), (logit, place)| {
        let weight = (logit - greatest).exp();
        (sum + weight, moment + weight * f64::from(place))
    });
    moment / sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixed::Fixed;

    const MIDDLE: usize = 6 * 13 + 6;
    const CHAIR: usize = 56;

    /// Sees a chair in the middle cell of the coarsest grid of every tile, three cells to each
    /// side.
    fn chair(classes: usize) -> Fixed {
        let tensor = |cells: usize, width: usize, at: &[usize], value: f32| {
            let mut data = vec![0.0; cells * width];
            at.iter().for_each(|place| data[*place] = value);
            Tensor::F32 { shape: vec![1, cells, width], data }
        };
        let cells = [2704, 676, 169];
        let chair = [MIDDLE * 80 + CHAIR];
        let sides = [3, 14, 25, 36].map(|place| MIDDLE * 44 + place);
        let mut outputs: Vec<Tensor> =
            cells[..2].iter().map(|cells| tensor(*cells, classes, &[], 0.0)).collect();
        outputs.push(tensor(169, classes, &chair, 0.8));
        outputs.extend(cells[..2].iter().map(|cells| tensor(*cells, 44, &[], 0.0)));
        outputs.push(tensor(169, 44, &sides, 60.0));
        Fixed(outputs)
    }

    fn detect(engine: Fixed, config: NanoDetConfig) -> Result<Detections, PerceptionError> {
        let image = Image::filled(104, 26, [128; 3]);
        NanoDet::new(Box::new(engine), config).detect(&image, &FrameId::default())
    }

    fn squares() -> NanoDetConfig {
        NanoDetConfig { tile_aspects: vec![1.0], tile_overlap: 0.0, ..NanoDetConfig::default() }
    }

    #[test]
    fn things_have_their_class_and_a_number_from_left_to_right() {
        let found = detect(chair(80), squares()).unwrap().detections;
        let ids: Vec<String> = found.iter().map(|d| d.id.to_string()).collect();
        assert_eq!(ids, ["chair:1", "chair:2", "chair:3", "chair:4"]);
        // A cell is 2 pixels of the panorama wide; the middle one is at 13, and the box reaches 3
        // cells to each side.
        for (detection, x) in found.iter().zip([7.0, 33.0, 59.0, 85.0]) {
            let PixelBox { x: left, y, w, h } = detection.bbox;
            for (found, expected) in [(left, x), (y, 7.0), (w, 12.0), (h, 12.0)] {
                assert!((found - expected).abs() < 1e-9, "{:?}", detection.bbox);
            }
            assert!((detection.score - 0.8).abs() < 1e-6);
        }
    }

    #[test]
    fn colours_become_planes_of_blue_green_and_red() {
        let Tensor::F32 { shape, data } =
            input(&Image { width: 1, height: 1, rgb: vec![255, 0, 104] })
        else {
            panic!("not floats")
        };
        assert_eq!(shape, [1, 3, 1, 1]);
        let expected = [(104.0 - 103.53) / 57.375, -116.28 / 57.12, (255.0 - 123.675) / 58.395];
        assert!(data.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{data:?}");
    }

    #[test]
    fn an_even_distribution_expects_the_middle() {
        assert!((expected(&[0.5; DISTANCES]) - 5.0).abs() < 1e-12);
        assert!(expected(&[f32::NAN; DISTANCES]).is_nan());
    }

    #[test]
    fn wrong_shapes_and_settings_are_told() {
        let error = |engine, config| detect(engine, config).unwrap_err().to_string();
        assert_eq!(
            error(chair(79), squares()),
            r#"expected output "Identity" to be f32 [1, 2704, 80], found f32 [1, 2704, 79]"#
        );
        let nobody = NanoDetConfig { min_score: 1.5, ..squares() };
        assert_eq!(error(chair(80), nobody), "expected min_score in [0, 1], found 1.5");
    }
}
