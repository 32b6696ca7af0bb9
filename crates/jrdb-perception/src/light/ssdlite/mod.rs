//! People by SSDLite-MobileNetV2 on 300 x 300 pixels (Sandler et al. 2018, section 6.2), run on
//! wrapped tiles.

use std::fmt;

use jrdb_types::detection::PERSON;
use jrdb_types::{Detections, FrameId, Image, Vocabulary};
use serde::{Deserialize, Serialize};

mod anchors;

use anchors::{Anchor, anchors};

use crate::detector::{Detector, PerceptionError, rows};
use crate::engine::{Engine, Tensor};
use crate::tiling::ScoredBox;
use crate::tiling::tiled::{ClassBox, TileSize, Tiling, numbered, unit};

/// Side of the model's input, pixels.
const SIDE: usize = 300;

/// Names of the model's tensors: `input` f32 `[1, 300, 300, 3]`, `box_enc` f32 `[1, 1917, 4]`,
/// `logits` f32 `[1, 1917, 2]` (background, person).
const INPUT: &str = "input";
const BOXES: &str = "box_enc";
const LOGITS: &str = "logits";

/// How people are looked for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SsdLiteConfig {
    /// Whether the image is a 360° panorama whose last column borders on the first.
    pub wraps: bool,
    /// Widths of the tiles, as parts of the image's height (tiles are as high as the image); in
    /// `(0, 10]`.
    ///
    /// Default 2/3 and 4/3. A tile is squeezed into a square: the narrow one shows upright people
    /// half again as broad, nearer to the shapes of the model's anchors and larger; the wide one
    /// shows people who sit or stand near whole. On a labelled frame of JRDB both together find
    /// more than either, or than squares.
    pub tile_aspects: Vec<f64>,
    /// Part of its width that a tile shares with the next; in `[0, 0.95]`.
    ///
    /// Default 3/4: a person of up to 3/4 of a tile lies whole in some tile, and most in several,
    /// so that the result depends little on where tiles begin. Turning a labelled frame of JRDB by
    /// eight angles, AP50 stays within 0.52 and 0.57; with 1/2, which takes half the time, within
    /// 0.47 and 0.58.
    pub tile_overlap: f64,
    /// A box this near to a border between tiles is dropped, as a part of the tile's width, in `[0,
    /// 0.5)`: a neighbour shows it whole. Default 1/100: three pixels of the model's input, about
    /// its precision.
    pub border_margin: f64,
    /// Least confidence of a detection, in `[0, 1]`. Default 1/2: more probably a person than not.
    pub min_score: f64,
    /// Boxes that overlap by more than this IoU are one person, in `[0, 1]`. Default 1/2, the IoU
    /// at which the benchmark matches two boxes.
    pub nms_iou: f64,
}

impl Default for SsdLiteConfig {
    /// For panoramas of 360°. Each field documents the source of its number.
    fn default() -> Self {
        Self {
            wraps: true,
            tile_aspects: vec![2.0 / 3.0, 4.0 / 3.0],
            tile_overlap: 0.75,
            border_margin: 0.01,
            min_score: 0.5,
            nms_iou: 0.5,
        }
    }
}

impl SsdLiteConfig {
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

/// Finds people in panoramas of any size.
///
/// A person should be taller than a tenth of the image (the smallest anchor) and a little narrower
/// than the image is high (the widest tile's overlap). Tiles run in parallel on the current rayon
/// pool; the result does not depend on its number of threads.
pub struct SsdLite {
    engine: Box<dyn Engine>,
    config: SsdLiteConfig,
    anchors: Vec<Anchor>,
}

impl fmt::Debug for SsdLite {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut shown = f.debug_struct("SsdLite");
        shown
            .field("engine", &self.engine.name())
            .field("config", &self.config)
            .finish_non_exhaustive()
    }
}

impl SsdLite {
    /// A detector on an engine that has loaded the model.
    #[must_use]
    pub fn new(engine: Box<dyn Engine>, config: SsdLiteConfig) -> Self {
        Self { engine, config, anchors: anchors() }
    }

    /// People in a square picture of a tile, in pixels of that tile.
    fn look(
        &self,
        picture: &Image,
        (width_px, height_px): TileSize,
    ) -> Result<Vec<ClassBox>, PerceptionError> {
        let outputs = self.engine.run(&[(INPUT, &input(picture))], &[BOXES, LOGITS])?;
        let codes = rows::<4>(BOXES, &outputs, 0, self.anchors.len())?;
        let logits = rows::<2>(LOGITS, &outputs, 1, self.anchors.len())?;
        let found = (self.anchors.iter().zip(codes.iter().zip(logits)))
            .map(|(anchor, (code, logits))| (anchor, code, sigmoid(f64::from(logits[1]))))
            .filter(|(.., score)| *score >= self.config.min_score)
            .map(|(anchor, code, score)| {
                let bbox = anchor.decode(code, width_px, height_px);
                ClassBox { class: 0, scored: ScoredBox { bbox, score } }
            });
        Ok(found.collect())
    }
}

impl Detector for SsdLite {
    fn detect(&self, image: &Image, frame: &FrameId) -> Result<Detections, PerceptionError> {
        unit("min_score", self.config.min_score)?;
        let tiling = self.config.tiling();
        let found = tiling.detect(image, SIDE, |picture, size| self.look(picture, size))?;
        let people = found.into_iter().map(|found| found.scored).collect();
        let (frame, image) = (frame.clone(), tiling.geometry(image));
        Ok(Detections::new(frame, image, numbered(PERSON, people)))
    }

    fn categories(&self) -> Vocabulary<String> {
        std::iter::once(PERSON.into()).collect()
    }

    fn config(&self) -> serde_json::Value {
        serde_json::json!({
            "detector": "ssdlite",
            "engine": self.engine.name(),
            "settings": self.config,
        })
    }
}

/// The input of the model: rows of columns of red, green, blue in `[-1, 1]`.
fn input(picture: &Image) -> Tensor {
    let data = picture.rgb.iter().map(|&byte| f32::from(byte) / 127.5 - 1.0).collect();
    Tensor::F32 { shape: vec![1, picture.height, picture.width, 3], data }
}

fn sigmoid(logit: f64) -> f64 {
    1.0 / (1.0 + (-logit).exp())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixed::Fixed;
    use jrdb_types::{ImageGeometry, PixelBox};

    /// Returns the same output for every tile: one anchor is a person.
    struct Person {
        anchor: usize,
        code: [f32; 4],
        axes: usize,
    }

    impl Person {
        fn engine(self) -> Box<Fixed> {
            let anchors = anchors().len();
            let (mut codes, mut logits) = (vec![0.0; 4 * anchors], vec![-20.0; 2 * anchors]);
            codes[4 * self.anchor..][..4].copy_from_slice(&self.code);
            logits[2 * self.anchor + 1] = 3.0;
            let codes = Tensor::F32 { shape: vec![1, anchors, self.axes], data: codes };
            Box::new(Fixed(vec![codes, Tensor::F32 { shape: vec![1, anchors, 2], data: logits }]))
        }
    }

    const CENTER: usize = 19 * 19 * 3 + 10 * 10 * 6 + 5 * 5 * 6 + 3 * 3 * 6 + 2 * 2 * 6;

    fn detect(person: Person, config: SsdLiteConfig) -> Result<Detections, PerceptionError> {
        let image = Image::filled(90, 30, [128; 3]);
        SsdLite::new(person.engine(), config).detect(&image, &FrameId::default())
    }

    fn narrow() -> SsdLiteConfig {
        SsdLiteConfig { tile_aspects: vec![1.0], tile_overlap: 0.0, ..SsdLiteConfig::default() }
    }

    /// The last grid's first anchor: 0.95 of the tile at ratio 1, in its middle; shrunk to a third.
    fn third() -> Person {
        let shrink = 5.0 * (1.0_f32 / 3.0 / 0.95).ln();
        Person { anchor: CENTER, code: [0.0, 0.0, shrink, shrink], axes: 4 }
    }

    #[test]
    fn boxes_land_in_the_panorama_numbered_from_left_to_right() {
        let found = detect(third(), narrow()).unwrap();
        assert_eq!(found.image, ImageGeometry { width_px: 90, height_px: 30, wraps: true });
        let ids: Vec<String> = found.detections.iter().map(|d| d.id.to_string()).collect();
        assert_eq!(ids, ["person:1", "person:2", "person:3"]);
        for (detection, x) in found.detections.iter().zip([10.0, 40.0, 70.0]) {
            let PixelBox { x: left, y, w, h } = detection.bbox;
            for (found, expected) in [(left, x), (y, 10.0), (w, 10.0), (h, 10.0)] {
                assert!((found - expected).abs() < 1e-5, "{:?}", detection.bbox);
            }
            assert!((detection.score - 1.0 / (1.0 + (-3.0_f64).exp())).abs() < 1e-12);
        }
    }

    #[test]
    fn what_a_tile_border_cuts_is_left_to_the_neighbour() {
        let whole = Person { code: [0.0; 4], ..third() };
        let wide = SsdLiteConfig { border_margin: 0.03, ..narrow() };
        assert_eq!(detect(whole, wide).unwrap().detections, []);
    }

    #[test]
    fn colours_become_numbers_from_minus_one_to_one() {
        let data = vec![-1.0, 1.0, 1.0 / 127.5 - 1.0];
        let expected = Tensor::F32 { shape: vec![1, 1, 1, 3], data };
        assert_eq!(input(&Image { width: 1, height: 1, rgb: vec![0, 255, 1] }), expected);
    }

    #[test]
    fn what_no_one_is_sure_of_is_no_detection() {
        let config = SsdLiteConfig { min_score: 0.96, ..narrow() };
        assert_eq!(detect(third(), config).unwrap().detections, []);
    }

    #[test]
    fn a_code_that_is_no_number_is_an_error() {
        let code = [f32::NAN, 0.0, f32::INFINITY, 0.0];
        let error = detect(Person { code, ..third() }, narrow()).unwrap_err();
        let message = jrdb_types::with_causes(&error);
        assert!(message.contains("NaN or infinity"), "{message}");
    }

    #[test]
    fn wrong_shapes_and_images_and_settings_are_told() {
        let error = |person, config| detect(person, config).unwrap_err().to_string();
        assert_eq!(
            error(Person { axes: 5, ..third() }, narrow()),
            r#"expected output "box_enc" to be f32 [1, 1917, 4], found f32 [1, 1917, 5]"#
        );
        let overlap = SsdLiteConfig { tile_overlap: 1.0, ..narrow() };
        assert_eq!(error(third(), overlap), "expected tile_overlap in [0, 0.95], found 1");
        let broken = Image { width: 4, height: 4, rgb: vec![0; 7] };
        let detector = SsdLite::new(third().engine(), narrow());
        assert_eq!(
            detector.detect(&broken, &FrameId::default()).unwrap_err().to_string(),
            "expected 3 bytes for each of 4 x 4 pixels, at least one, found 7"
        );
    }

    #[test]
    fn settings_survive_json_and_unknown_ones_are_refused() {
        let config = SsdLiteConfig::default();
        let text = serde_json::to_string(&config).unwrap();
        assert_eq!(serde_json::from_str::<SsdLiteConfig>(&text).unwrap(), config);
        assert!(serde_json::from_str::<SsdLiteConfig>(r#"{"min_scroe": 0.3}"#).is_err());
    }
}
