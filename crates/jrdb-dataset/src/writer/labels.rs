//! Detections as JRDB's three label files.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::{FRAC_PI_2, PI};

use jrdb_types::detection::PERSON;
use jrdb_types::{Belief, Detection, Detections, EntityId};
use serde::{Serialize, Serializer};

use super::frame::{LabelledFrame, file_name};
use crate::labels::words::{IMPOSSIBLE, JrdbWord};
use crate::labels::wrap_rad;

/// Difficulty that annotators gave: easy.
const EASY: u32 = 1;

/// A number with at most 5 decimals, a whole one without any, as JRDB writes boxes in pixels.
struct Pixels(f64);

impl Serialize for Pixels {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let value = rounded(self.0);
        if value.fract() == 0.0 && value.abs() < f64::from(i32::MAX) {
            serializer.serialize_i64(value as i64)
        } else {
            serializer.serialize_f64(value)
        }
    }
}

/// To 5 decimals; never -0.
fn rounded(value: f64) -> f64 {
    const DECIMALS: f64 = 1e5;
    (value * DECIMALS).round() / DECIMALS + 0.0
}

#[derive(Serialize)]
struct LabelFile<T> {
    labels: BTreeMap<String, Vec<T>>,
}

#[derive(Serialize)]
struct BoxLabel {
    attributes: BoxAttributes,
    r#box: [Pixels; 4],
    file_id: String,
    label_id: EntityId,
}

#[derive(Serialize)]
struct BoxAttributes {
    area: f64,
    interpolated: bool,
    no_eval: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    occlusion: Option<&'static str>,
    truncated: &'static str,
}

#[derive(Serialize)]
struct SpaceLabel {
    attributes: SpaceAttributes,
    r#box: SpaceBox,
    file_id: String,
    label_id: EntityId,
    observation_angle: f64,
}

#[derive(Serialize)]
struct SpaceAttributes {
    distance: f64,
    interpolated: bool,
    no_eval: bool,
    num_points: usize,
}

#[derive(Serialize)]
struct SpaceBox {
    cx: f64,
    cy: f64,
    cz: f64,
    h: f64,
    l: f64,
    rot_z: f64,
    w: f64,
}

#[derive(Serialize)]
struct SocialLabel {
    #[serde(rename = "H-interaction")]
    interactions: Vec<InteractionLabel>,
    action_label: BTreeMap<&'static str, u32>,
    demographics_info: [Demographics; 1],
    group_info: [(); 0],
    social_activity: BTreeMap<&'static str, u32>,
    social_group: SocialGroup,
    #[serde(flatten)]
    flat: BoxLabel,
}

/// `{label: difficulty}`; the difficulty is text in this section only.
type Section = BTreeMap<&'static str, &'static str>;

#[derive(Serialize)]
struct Demographics {
    age: Section,
    gender: Section,
    race: Section,
}

#[derive(Serialize)]
struct SocialGroup {
    #[serde(rename = "cluster_ID")]
    cluster_id: u32,
    cluster_stat: u32,
}

#[derive(Serialize)]
struct InteractionLabel {
    box_pair: [Pixels; 4],
    inter_labels: BTreeMap<String, u32>,
    pair: EntityId,
}

/// `labels_2d_stitched`.
pub(super) fn boxes(frames: &[LabelledFrame]) -> String {
    file(frames, "jpg", |frame, name| {
        frame.detections.detections.iter().map(|thing| box_label(thing, name)).collect()
    })
}

/// `labels_3d`: everything that has a 3D box.
pub(super) fn space(frames: &[LabelledFrame]) -> String {
    file(frames, "pcd", |frame, name| {
        let things = frame.detections.detections.iter();
        things.filter_map(|thing| space_label(thing, frame, name)).collect()
    })
}

/// `labels_2d_activity_social_stitched`: people.
pub(super) fn social(frames: &[LabelledFrame]) -> String {
    file(frames, "jpg", |frame, name| {
        let people = People::of(&frame.detections);
        people.by_id.values().map(|person| people.social_label(person, name)).collect()
    })
}

fn file<T: Serialize>(
    frames: &[LabelledFrame],
    extension: &str,
    objects: impl Fn(&LabelledFrame, &str) -> Vec<T>,
) -> String {
    let labels = frames.iter().map(|frame| {
        let name = file_name(&frame.detections.frame, extension);
        let objects = objects(frame, &name);
        (name, objects)
    });
    let mut text =
        serde_json::to_string(&LabelFile { labels: labels.collect() }).expect("keys are strings");
    text.push('\n');
    text
}

fn pixels(thing: &Detection) -> [Pixels; 4] {
    <[f64; 4]>::from(thing.bbox).map(Pixels)
}

fn box_label(thing: &Detection, file: &str) -> BoxLabel {
    BoxLabel {
        attributes: BoxAttributes {
            area: rounded(thing.bbox.area_px2()),
            interpolated: false,
            no_eval: false,
            occlusion: thing.occlusion.map(JrdbWord::jrdb_word),
            truncated: "false",
        },
        r#box: pixels(thing),
        file_id: file.into(),
        label_id: thing.id.clone(),
    }
}

fn space_label(thing: &Detection, frame: &LabelledFrame, file: &str) -> Option<SpaceLabel> {
    let space = thing.box3d?;
    let ([cx, cy, cz], [l, w, h]) = (space.center, space.size);
    let bearing_rad = cy.atan2(cx);
    Some(SpaceLabel {
        attributes: SpaceAttributes {
            distance: rounded(cx.hypot(cy)),
            interpolated: false,
            no_eval: false,
            num_points: frame.num_points.get(&thing.id).copied().unwrap_or(0),
        },
        r#box: SpaceBox {
            cx: rounded(cx),
            cy: rounded(cy),
            cz: rounded(cz),
            h: rounded(h),
            l: rounded(l),
            rot_z: rounded(wrap_rad(PI - space.heading_rad)),
            w: rounded(w),
        },
        file_id: file.into(),
        label_id: thing.id.clone(),
        // KITTI's alpha: clockwise heading from the camera's right, less the clockwise bearing.
        observation_angle: rounded(wrap_rad(bearing_rad - space.heading_rad - FRAC_PI_2)),
    })
}

/// The people of a frame and who interacts with whom.
struct People<'a> {
    by_id: BTreeMap<&'a EntityId, &'a Detection>,
    /// Both ways.
    interactions: BTreeMap<&'a EntityId, BTreeMap<&'a EntityId, BTreeSet<&'a str>>>,
}

impl<'a> People<'a> {
    fn of(frame: &'a Detections) -> Self {
        let people = frame.detections.iter().filter(|thing| thing.category == PERSON);
        let by_id: BTreeMap<_, _> = people.map(|person| (&person.id, person)).collect();
        let mut found = Self { by_id, interactions: BTreeMap::new() };
        for person in found.by_id.clone().into_values() {
            for interaction in &person.interactions {
                let (one, other) = (&person.id, &interaction.partner);
                if found.by_id.contains_key(other) {
                    found.link(one, other, &interaction.label);
                    found.link(other, one, &interaction.label);
                }
            }
        }
        found
    }

    fn link(&mut self, one: &'a EntityId, other: &'a EntityId, label: &'a str) {
        let partners = self.interactions.entry(one).or_default();
        partners.entry(other).or_default().insert(label);
    }

    fn social_label(&self, person: &Detection, file: &str) -> SocialLabel {
        let beliefs = &person.attributes;
        let action = beliefs.action().best().map(|action| (action.jrdb_word(), EASY));
        SocialLabel {
            interactions: self.interaction_labels(&person.id),
            action_label: action.into_iter().collect(),
            demographics_info: [Demographics {
                age: section(&beliefs.age()),
                gender: section(&beliefs.gender()),
                race: section(&beliefs.race()),
            }],
            group_info: [],
            social_activity: action.into_iter().collect(),
            social_group: SocialGroup { cluster_id: self.group(&person.id), cluster_stat: EASY },
            flat: box_label(person, file),
        }
    }

    fn interaction_labels(&self, id: &EntityId) -> Vec<InteractionLabel> {
        let partners = self.interactions.get(id).into_iter().flatten();
        let label = |(partner, labels): (&&EntityId, &BTreeSet<&str>)| InteractionLabel {
            box_pair: pixels(self.by_id[partner]),
            inter_labels: labels.iter().map(|label| (String::from(*label), EASY)).collect(),
            pair: EntityId::clone(partner),
        };
        partners.map(label).collect()
    }

    /// Number of the social group: the detection's own; else, from 1, the place of the first of those that
    /// interact with it among the people of the frame.
    fn group(&self, id: &EntityId) -> u32 {
        if let Some(group) = self.by_id[id].group {
            return group;
        }
        let (mut members, mut new) = (BTreeSet::from([id]), vec![id]);
        while let Some(member) = new.pop() {
            for partner in self.interactions.get(member).into_iter().flat_map(BTreeMap::keys) {
                if members.insert(*partner) {
                    new.push(partner);
                }
            }
        }
        let first = self.by_id.keys().position(|person| members.contains(person));
        let first = first.expect("the person asked for is a member");
        u32::try_from(first + 1).unwrap_or(u32::MAX)
    }
}

fn section<T: JrdbWord + Ord>(belief: &Belief<T>) -> Section {
    BTreeMap::from([(belief.best().map_or(IMPOSSIBLE, JrdbWord::jrdb_word), "1")])
}
