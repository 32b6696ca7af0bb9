//! What perception hands on: boxes in one image, and what it believes about each.

use serde::{Deserialize, Serialize};

use crate::artefact::Payload;
use crate::attribute::{Attribute, Attributes};
use crate::capabilities::{Capabilities, Coverage};
use crate::geometry::{Box3d, ImageGeometry, PixelBox};
use crate::id::{EntityId, FrameId};
use crate::issue::Issue;
use crate::vocab::Occlusion;

pub use crate::object::PERSON;

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
    /// Which camera's image the box is in; the only one of the frame when absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub camera: Option<String>,
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

impl Detection {
    /// A detection of which nothing but the box and the confidence is known.
    ///
    /// ```
    /// use jrdb_types::{Detection, EntityId, PixelBox};
    /// let bbox = PixelBox::from([10.0, 20.0, 40.0, 120.0]);
    /// let seen = Detection::new(EntityId::new("pedestrian", 1), "person", 0.9, bbox);
    /// assert!(seen.heading_rad.is_none() && seen.interactions.is_empty());
    /// ```
    #[must_use]
    pub fn new(id: EntityId, category: impl Into<String>, score: f64, bbox: PixelBox) -> Self {
        Self {
            id,
            category: category.into(),
            score,
            bbox,
            camera: None,
            attributes: Attributes::default(),
            interactions: Vec::new(),
            group: None,
            occlusion: None,
            heading_rad: None,
            box3d: None,
        }
    }
}

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
    /// What could have been seen; when absent, what occurs in the detections.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub capabilities: Option<Capabilities>,
    /// What could not be used.
    #[serde(default)]
    pub issues: Vec<Issue>,
}

impl Detections {
    /// Detections of one image, without issues.
    #[must_use]
    pub fn new(frame: FrameId, image: ImageGeometry, detections: Vec<Detection>) -> Self {
        Self { frame, image, detections, capabilities: None, issues: Vec::new() }
    }
}

/// What occurs in some detections: what their source can see, where it does not say so itself.
pub fn occurring<'a>(detections: impl IntoIterator<Item = &'a Detection>) -> Capabilities {
    let mut seen = Capabilities::none();
    for detection in detections {
        let known = |&a: &Attribute| !detection.attributes.belief(a).is_unknown();
        seen.unite(Capabilities {
            categories: std::iter::once(detection.category.clone()).collect(),
            attributes: Attribute::ALL.iter().copied().filter(known).collect(),
            interactions: detection.interactions.iter().map(|one| one.label.clone()).collect(),
            places: Coverage::Complete,
        });
    }
    seen
}

impl Payload for Detections {
    const SCHEMA: &'static str = "jrdb.detections";
    const VERSION: u32 = 1;
}
