//! Appearance of a person: posture, clothes, facing, and, only on request, gender and age.

use std::fmt;

use jrdb_types::detection::PERSON;
use jrdb_types::vocab::Color;
use jrdb_types::{Attribute, Attributes, Belief, Detection, Image, PixelBox};
use serde::{Deserialize, Serialize};

use super::color::colors;
use super::demographics::FaceReader;
use super::face::{Face, FaceFinder};
use super::facing::{Turn, facing};
use super::posture::{SEATED_MAX_RATIO, posture};
use crate::detector::{AttributeModel, PerceptionError, check_image};
use crate::image::{Wrap, crop};
use crate::tiling::tiled::unit;

/// How people are described.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AppearanceConfig {
    /// Whether the image is a 360° panorama whose last column borders on the first.
    pub wraps: bool,
    /// Least confidence of a face, in `[0, 1]`. Default 1/2: more probably a face than not.
    pub min_face_score: f64,
    /// Least longer side of a face that is described, pixels. Default 25: on smaller ones gender
    /// and landmarks are guesswork.
    pub min_face_px: f64,
    /// A gender or age group less probable than this is unknown, in `[0, 1]`. Default 0.7.
    pub min_probability: f64,
}

impl Default for AppearanceConfig {
    /// For panoramas of 360°. Each field documents the source of its number.
    fn default() -> Self {
        Self { wraps: true, min_face_score: 0.5, min_face_px: 25.0, min_probability: 0.7 }
    }
}

/// The models for faces. Gender and age are estimated only if their models are present.
#[derive(Debug, Default)]
pub struct FaceModels {
    /// Detects faces; without it, no attribute of a face is estimated.
    pub finder: Option<FaceFinder>,
    /// Guesses gender.
    pub gender: Option<FaceReader>,
    /// Guesses age. It is unreliable: two men of clearly different age came out in the wrong order.
    pub age: Option<FaceReader>,
}

/// Describes people.
pub struct Appearance {
    faces: FaceModels,
    config: AppearanceConfig,
}

impl fmt::Debug for Appearance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut shown = f.debug_struct("Appearance");
        shown.field("faces", &self.faces).field("config", &self.config).finish()
    }
}

/// Parts of a person's box, from its left and top: the columns in the middle; a shirt; trousers.
const MIDDLE: (f64, f64) = (0.3, 0.7);
const UPPER: (f64, f64) = (0.22, 0.45);
const LOWER: (f64, f64) = (0.58, 0.82);
/// The upper body, in which faces are detected: margins above and beside the box, and its part of
/// the height, at most this many widths.
const HEADROOM: f64 = 0.05;
const ELBOWROOM: f64 = 0.1;
const UPPER_BODY: f64 = 0.55;
const UPPER_BODY_WIDTHS: f64 = 1.5;
/// A person is at least this many faces wide.
const FACES_WIDE: f64 = 1.5;

impl Appearance {
    /// With these models; attributes without a model stay unknown.
    #[must_use]
    pub fn new(faces: FaceModels, config: AppearanceConfig) -> Self {
        Self { faces, config }
    }

    /// Which models describe people and how, for the artefact's `config`.
    #[must_use]
    pub fn config(&self) -> serde_json::Value {
        serde_json::json!({
            "attributes": "appearance",
            "faces": self.faces.finder.is_some(),
            "gender": self.faces.gender.is_some(),
            "age": self.faces.age.is_some(),
            "settings": self.config,
        })
    }

    /// Colour of a part of the box: columns in its middle, rows between two parts of its height.
    fn color(&self, image: &Image, bbox: &PixelBox, (top, bottom): (f64, f64)) -> Belief<Color> {
        let (left, right) = MIDDLE;
        let part = PixelBox {
            x: bbox.x + left * bbox.w,
            w: (right - left) * bbox.w,
            y: bbox.y + top * bbox.h,
            h: (bottom - top) * bbox.h,
        };
        crop(image, &part, 0.0, Wrap::of(self.config.wraps))
            .map(|picture| colors(&picture))
            .unwrap_or_default()
    }

    /// The most confident face of the upper body that is large enough, with the picture that it is
    /// in.
    fn face(
        &self,
        image: &Image,
        bbox: &PixelBox,
    ) -> Result<Option<(Image, Face)>, PerceptionError> {
        let Some(finder) = &self.faces.finder else { return Ok(None) };
        if bbox.w < FACES_WIDE * self.config.min_face_px {
            return Ok(None);
        }
        let upper_body = PixelBox {
            x: bbox.x - ELBOWROOM * bbox.w,
            w: (1.0 + 2.0 * ELBOWROOM) * bbox.w,
            y: (bbox.y - HEADROOM * bbox.h).max(0.0),
            h: (UPPER_BODY * bbox.h).min(UPPER_BODY_WIDTHS * bbox.w),
        };
        let Some(picture) = crop(image, &upper_body, 0.0, Wrap::of(self.config.wraps)) else {
            return Ok(None);
        };
        let is_large = |face: &Face| face.bbox.w.max(face.bbox.h) >= self.config.min_face_px;
        let found = finder.find(&picture, self.config.min_face_score)?.into_iter().find(is_large);
        Ok(found.map(|face| (picture, face)))
    }

    /// The attributes of a face.
    fn read(
        &self,
        attributes: &mut Attributes,
        picture: &Image,
        face: &Face,
    ) -> Result<(), PerceptionError> {
        let turn = Turn::of(face);
        attributes.facing = facing(turn);
        if !turn.is_frontal() {
            return Ok(());
        }
        let least = self.config.min_probability;
        if let Some(gender) = &self.faces.gender {
            attributes.set_gender(gender.gender(picture, face, least)?);
        }
        if let Some(age) = &self.faces.age {
            attributes.set_age(age.age(picture, face, least)?);
        }
        Ok(())
    }
}

impl AttributeModel for Appearance {
    fn describe(
        &self,
        image: &Image,
        detection: &Detection,
    ) -> Result<Attributes, PerceptionError> {
        check_image(image)?;
        unit("min_face_score", self.config.min_face_score)?;
        unit("min_probability", self.config.min_probability)?;
        let bbox = &detection.bbox;
        if detection.category != PERSON || !bbox.is_proper() {
            return Ok(Attributes::default());
        }
        let mut attributes = Attributes::default()
            .with_action(posture(bbox, image.height as f64))
            .with_upper_color(self.color(image, bbox, UPPER));
        // In a broad box legs are bent or hidden.
        if bbox.h / bbox.w > SEATED_MAX_RATIO {
            attributes.set_lower_color(self.color(image, bbox, LOWER));
        }
        if let Some((picture, face)) = self.face(image, bbox)? {
            self.read(&mut attributes, &picture, &face)?;
        }
        Ok(attributes)
    }

    fn attributes(&self) -> Vec<Attribute> {
        let faces = &self.faces;
        let has_faces = faces.finder.is_some();
        let gender = faces.gender.as_ref().filter(|_| has_faces).map(|_| Attribute::Gender);
        let age = faces.age.as_ref().filter(|_| has_faces).map(|_| Attribute::Age);
        let always = [Attribute::Action, Attribute::UpperColor, Attribute::LowerColor];
        always.into_iter().chain(gender).chain(age).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tiling::ScoredBox;
    use crate::tiling::tiled::numbered;
    use jrdb_types::vocab::Action;

    fn person(bbox: [f64; 4]) -> Detection {
        numbered(PERSON, vec![ScoredBox { bbox: PixelBox::from(bbox), score: 0.9 }]).remove(0)
    }

    /// A red shirt over blue trousers, across the seam.
    fn dressed() -> Image {
        let mut image = Image::filled(200, 100, [128; 3]);
        for y in 10..90 {
            let rgb = if y < 50 { [200, 20, 20] } else { [20, 40, 200] };
            for x in (185..200).chain(0..15) {
                image.rgb[3 * (y * 200 + x)..][..3].copy_from_slice(&rgb);
            }
        }
        image
    }

    #[test]
    fn clothes_and_posture_are_told_across_the_seam_without_any_model() {
        let appearance = Appearance::new(FaceModels::default(), AppearanceConfig::default());
        let found = appearance.describe(&dressed(), &person([185.0, 10.0, 30.0, 80.0])).unwrap();
        assert_eq!(found.upper_color(), Belief::certain(Color::Red));
        assert_eq!(found.lower_color(), Belief::certain(Color::Blue));
        assert_eq!(found.action().best(), Some(Action::Standing));
        assert!(
            found.gender().is_unknown() && found.age().is_unknown() && found.facing.is_unknown()
        );
    }

    #[test]
    fn objects_and_empty_boxes_have_no_attributes() {
        let appearance = Appearance::new(FaceModels::default(), AppearanceConfig::default());
        let chair = Detection { category: "chair".into(), ..person([185.0, 10.0, 30.0, 80.0]) };
        for detection in [chair, person([5.0, 5.0, 0.0, 3.0])] {
            let found = appearance.describe(&dressed(), &detection).unwrap();
            assert_eq!(found, Attributes::default());
        }
    }
}
