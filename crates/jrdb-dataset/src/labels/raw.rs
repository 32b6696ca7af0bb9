//! Label files as they are written, read so that one bad object does not spoil the others.

use std::fmt;

use jrdb_types::EntityId;
use serde::Deserialize;
use serde::de::{DeserializeOwned, Deserializer, IgnoredAny, MapAccess, Visitor};
use serde_json::value::RawValue;

use crate::boxes;
use crate::number::Real;

/// Why an object could not be read.
#[derive(Debug, Clone)]
pub(super) struct Trouble {
    pub(super) subject: Option<EntityId>,
    pub(super) message: String,
}

/// An object of a label file.
pub(super) trait Label: DeserializeOwned {
    fn id(&self) -> &EntityId;
}

/// An id, with a person's class in the case in which JRDB writes it.
fn id<'de, D: Deserializer<'de>>(deserializer: D) -> Result<EntityId, D::Error> {
    EntityId::deserialize(deserializer).map(boxes::usual_id)
}

/// An object of `labels_2d_stitched`.
#[derive(Debug, Clone, Deserialize)]
pub(super) struct BoxLabel {
    #[serde(deserialize_with = "id")]
    label_id: EntityId,
    #[serde(rename = "box")]
    pub(super) bbox: [Real; 4],
    #[serde(default)]
    pub(super) attributes: Loose<BoxAttributes>,
}

#[derive(Debug, Clone, Default, Deserialize)]
pub(super) struct BoxAttributes {
    pub(super) occlusion: Option<String>,
}

/// An object of `labels_3d`.
#[derive(Debug, Clone, Deserialize)]
pub(super) struct SpaceLabel {
    #[serde(deserialize_with = "id")]
    label_id: EntityId,
    #[serde(rename = "box")]
    pub(super) bbox: SpaceBox,
}

/// Metres and radians in the base frame; `rot_z` is clockwise from -x.
#[derive(Debug, Clone, Copy, Deserialize)]
pub(super) struct SpaceBox {
    pub(super) cx: Real,
    pub(super) cy: Real,
    pub(super) cz: Real,
    pub(super) l: Real,
    pub(super) w: Real,
    pub(super) h: Real,
    pub(super) rot_z: Real,
}

/// An object of `labels_2d_activity_social_stitched`.
#[derive(Debug, Clone, Deserialize)]
pub(super) struct SocialLabel {
    #[serde(deserialize_with = "id")]
    label_id: EntityId,
    #[serde(default, rename = "box")]
    pub(super) bbox: Loose<[Real; 4]>,
    #[serde(default)]
    pub(super) attributes: Loose<BoxAttributes>,
    #[serde(default)]
    pub(super) action_label: Loose<Keys>,
    #[serde(default)]
    demographics_info: Loose<Vec<Demographics>>,
    #[serde(default, rename = "H-interaction")]
    pub(super) interactions: Loose<Vec<InteractionLabel>>,
    #[serde(default)]
    pub(super) social_group: Loose<SocialGroup>,
}

/// The group a person belongs to; ids are per sequence.
#[derive(Debug, Clone, Deserialize)]
pub(super) struct SocialGroup {
    #[serde(rename = "cluster_ID")]
    pub(super) cluster_id: u32,
}

/// What annotators saw; each section is `{label: difficulty}`.
#[derive(Debug, Clone, Default, Deserialize)]
pub(super) struct Demographics {
    #[serde(default)]
    pub(super) gender: Loose<Keys>,
    #[serde(default)]
    pub(super) age: Loose<Keys>,
    #[serde(default)]
    pub(super) race: Loose<Keys>,
}

#[derive(Debug, Clone, Deserialize)]
pub(super) struct InteractionLabel {
    pub(super) pair: String,
    #[serde(default)]
    pub(super) inter_labels: Loose<Keys>,
}

impl SocialLabel {
    /// The first entry, the only one that JRDB-Social writes.
    pub(super) fn demographics(&self) -> Option<&Demographics> {
        self.demographics_info.0.as_ref()?.first()
    }
}

impl Label for BoxLabel {
    fn id(&self) -> &EntityId {
        &self.label_id
    }
}

impl Label for SpaceLabel {
    fn id(&self) -> &EntityId {
        &self.label_id
    }
}

impl Label for SocialLabel {
    fn id(&self) -> &EntityId {
        &self.label_id
    }
}

/// A section that may be absent or of another shape, which is then "unknown".
#[derive(Debug, Clone)]
pub(super) struct Loose<T>(pub(super) Option<T>);

impl<T> Default for Loose<T> {
    fn default() -> Self {
        Self(None)
    }
}

impl<'de, T: DeserializeOwned> Deserialize<'de> for Loose<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let raw = <&RawValue>::deserialize(deserializer)?;
        Ok(Self(serde_json::from_str(raw.get()).ok()))
    }
}

impl Loose<Keys> {
    /// The keys, in the order of the file.
    pub(super) fn keys(&self) -> &[String] {
        self.0.as_ref().map(|keys| keys.0.as_slice()).unwrap_or_default()
    }
}

/// The keys of an object in the order of the file, which says what is first; values do not matter.
#[derive(Debug, Clone)]
pub(super) struct Keys(Vec<String>);

impl<'de> Deserialize<'de> for Keys {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(KeysVisitor)
    }
}

struct KeysVisitor;

impl<'de> Visitor<'de> for KeysVisitor {
    type Value = Keys;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object of labels")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Keys, A::Error> {
        let mut keys = Vec::new();
        while let Some((key, _)) = map.next_entry::<String, IgnoredAny>()? {
            keys.push(key);
        }
        Ok(Keys(keys))
    }
}

/// The objects of one frame, as its part of the file says.
pub(super) fn objects<T: Label>(frame: &str) -> Vec<Result<T, Trouble>> {
    match serde_json::from_str::<Vec<&RawValue>>(frame) {
        Ok(objects) => objects.into_iter().map(|object| self::object(object.get())).collect(),
        Err(error) => vec![Err(Trouble { subject: None, message: error.to_string() })],
    }
}

fn object<T: Label>(text: &str) -> Result<T, Trouble> {
    serde_json::from_str(text).map_err(|error: serde_json::Error| Trouble {
        subject: serde_json::from_str(text).ok().map(|Named { label_id }| label_id),
        message: error.to_string(),
    })
}

#[derive(Deserialize)]
struct Named {
    #[serde(deserialize_with = "id")]
    label_id: EntityId,
}
