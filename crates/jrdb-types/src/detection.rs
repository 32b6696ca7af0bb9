//! What perception hands on: boxes in one image, and what it believes about each.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::artefact::Payload;
use crate::geometry::{Box3d, ImageGeometry, PixelBox};
use crate::id::{EntityId, FrameId};
use crate::issue::Issue;
use crate::vocab::{Action, Age, Color, Facing, Gender, Occlusion, Race};

/// Probabilities of the values of one attribute; a value that is absent has probability 0, and an
/// empty belief means "unknown".
///
/// As JSON: `{"young": 0.8, "adolescent": 0.2}`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "BeliefOf{T}"))]
#[serde(transparent)]
pub struct Belief<T: Ord>(pub BTreeMap<T, f64>);

impl<T: Ord> Default for Belief<T> {
    /// Nothing is known.
    fn default() -> Self {
        Self(BTreeMap::new())
    }
}

impl<T: Ord + Copy> Belief<T> {
    /// One value for sure, as a label file states it.
    #[must_use]
    pub fn certain(value: T) -> Self {
        Self(BTreeMap::from([(value, 1.0)]))
    }

    /// Certain of `Some`, ignorant of `None`.
    #[must_use]
    pub fn from_label(value: Option<T>) -> Self {
        value.map(Self::certain).unwrap_or_default()
    }

    /// Whether nothing is known.
    #[must_use]
    pub fn is_unknown(&self) -> bool {
        self.0.is_empty()
    }

    /// Probability of a value, in `[0, 1]`.
    #[must_use]
    pub fn probability(&self, value: T) -> f64 {
        self.0.get(&value).copied().unwrap_or(0.0)
    }

    /// The most probable value; the first in vocabulary order on a tie.
    #[must_use]
    pub fn best(&self) -> Option<T> {
        let better = |best: Option<(T, f64)>, (&value, &p): (&T, &f64)| match best {
            Some((_, q)) if q >= p => best,
            _ => Some((value, p)),
        };
        self.0.iter().fold(None, better).map(|(value, _)| value)
    }
}

/// What is believed of a person.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Attributes {
    /// Age group.
    #[serde(default, skip_serializing_if = "Belief::is_unknown")]
    pub age: Belief<Age>,
    /// Gender.
    #[serde(default, skip_serializing_if = "Belief::is_unknown")]
    pub gender: Belief<Gender>,
    /// The benchmark's race words.
    #[serde(default, skip_serializing_if = "Belief::is_unknown")]
    pub race: Belief<Race>,
    /// What the body does.
    #[serde(default, skip_serializing_if = "Belief::is_unknown")]
    pub action: Belief<Action>,
    /// Which way its front points in the picture.
    #[serde(default, skip_serializing_if = "Belief::is_unknown")]
    pub facing: Belief<Facing>,
    /// Colour of what it wears above the waist.
    #[serde(default, skip_serializing_if = "Belief::is_unknown")]
    pub upper_color: Belief<Color>,
    /// Colour of what it wears below the waist.
    #[serde(default, skip_serializing_if = "Belief::is_unknown")]
    pub lower_color: Belief<Color>,
}

/// Something a person does with another, as the labels or a model say it.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Interaction {
    /// With whom or what.
    pub partner: EntityId,
    /// JRDB-Social's label, for example `conversation` or `walking together`.
    pub label: String,
}

/// One person or object in the image.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Detection {
    /// Identity: the label's track, or a number given by the detector from left to right.
    pub id: EntityId,
    /// Class name: `person`, or the object's class in the detector's or label's own words.
    pub category: String,
    /// Confidence in `[0, 1]`; 1 for labels.
    pub score: f64,
    /// Where, pixels.
    #[serde(rename = "box")]
    pub bbox: PixelBox,
    /// What is believed of it.
    #[serde(default)]
    pub attributes: Attributes,
    /// With whom it does what.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub interactions: Vec<Interaction>,
    /// Number of the social group it belongs to, where the source tells groups.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub group: Option<u32>,
    /// How much of it others hide, where the source says so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub occlusion: Option<Occlusion>,
    /// Direction it faces, radians counter-clockwise from the robot's forward axis, in (-π, π].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub heading_rad: Option<f64>,
    /// Its box in space where the source knows it (a 3D label or 3D detector); base frame.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub box3d: Option<Box3d>,
}

/// The category of people.
pub const PERSON: &str = "person";

/// Everything seen in one image, sorted by id.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Detections {
    /// The frame.
    pub frame: FrameId,
    /// The image's size and topology.
    pub image: ImageGeometry,
    /// What was seen.
    pub detections: Vec<Detection>,
    /// What could not be used.
    #[serde(default)]
    pub issues: Vec<Issue>,
}

impl Payload for Detections {
    const SCHEMA: &'static str = "jrdb.detections";
    const VERSION: u32 = 1;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn belief_names_its_best_value() {
        let belief = Belief(BTreeMap::from([(Age::Adolescent, 0.3), (Age::Young, 0.6)]));
        assert_eq!(belief.best(), Some(Age::Young));
        assert_eq!(belief.probability(Age::Elderly), 0.0);
        assert_eq!(Belief::<Age>::default().best(), None);
        assert_eq!(serde_json::to_string(&belief).unwrap(), r#"{"adolescent":0.3,"young":0.6}"#);
    }
}
