//! What three label files say of one frame, put together person by person.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::{PI, TAU};

use jrdb_types::detection::Interaction;
use jrdb_types::{
    Action, Age, AttributeValue, Attributes, Box3d, Detection, Detections, EntityId, FrameId,
    Gender, ImageGeometry, Issue, IssueKind, PixelBox, Race,
};

use super::raw::{BoxLabel, Keys, Label, Loose, SocialLabel, SpaceBox, SpaceLabel, Trouble};
use super::words::JrdbWord;
use crate::boxes;
use crate::number::Real;

/// The objects with one id.
#[derive(Default)]
pub(super) struct Parts<'a> {
    pub(super) flat: Option<&'a BoxLabel>,
    pub(super) space: Option<&'a SpaceLabel>,
    pub(super) social: Option<&'a SocialLabel>,
}

/// The objects of one frame by id, and what could not be read.
#[derive(Default)]
pub(super) struct Joined<'a> {
    things: BTreeMap<EntityId, Parts<'a>>,
    issues: Vec<Issue>,
}

impl<'a> Joined<'a> {
    /// Adds the objects of one file; of two with the same id the first counts.
    pub(super) fn add<T: Label>(
        &mut self,
        file: &str,
        labels: &'a [Result<T, Trouble>],
        put: impl Fn(&mut Parts<'a>, &'a T),
    ) {
        let mut seen = BTreeSet::new();
        for label in labels {
            match label {
                Ok(label) if seen.insert(label.id()) => {
                    put(self.things.entry(label.id().clone()).or_default(), label);
                }
                Ok(label) => {
                    self.bad_label(
                        Some(label.id()),
                        &format!("{file}: a second label with this id"),
                    );
                }
                Err(Trouble { subject, message }) => {
                    self.bad_label(subject.as_ref(), &format!("{file}: {message}"));
                }
            }
        }
    }

    fn bad_label(&mut self, subject: Option<&EntityId>, message: &str) {
        let issue = Issue::new(IssueKind::BadLabel, message);
        self.issues.push(Issue { subject: subject.cloned(), ..issue });
    }

    pub(super) fn into_detections(mut self, frame: &FrameId, image: ImageGeometry) -> Detections {
        let things = std::mem::take(&mut self.things);
        let detections =
            things.iter().filter_map(|(id, parts)| self.detection(id, parts, image)).collect();
        self.issues.sort();
        Detections { issues: self.issues, ..Detections::new(frame.clone(), image, detections) }
    }

    fn detection(
        &mut self,
        id: &EntityId,
        parts: &Parts<'_>,
        image: ImageGeometry,
    ) -> Option<Detection> {
        let Some(bbox) = flat_box(parts) else {
            let file = if parts.space.is_some() { "3d" } else { "social" };
            self.bad_label(Some(id), &format!("{file} label without a 2d box"));
            return None;
        };
        let bbox = boxes::checked(bbox, image)
            .map_err(|message| self.issues.push(Issue::about(IssueKind::BadBox, id, message)))
            .ok()?;
        let box3d = parts.space.and_then(|label| self.box3d(id, label.bbox));
        Some(Detection {
            camera: None,
            id: id.clone(),
            category: boxes::category(id),
            score: 1.0,
            bbox,
            attributes: parts.social.map(attributes).unwrap_or_default(),
            interactions: parts
                .social
                .map(|label| self.interactions(id, label))
                .unwrap_or_default(),
            group: parts.social.and_then(|label| Some(label.social_group.0.as_ref()?.cluster_id)),
            occlusion: occlusion(parts).and_then(JrdbWord::from_jrdb_word),
            heading_rad: box3d.map(|bbox| bbox.heading_rad),
            box3d,
        })
    }

    fn box3d(&mut self, id: &EntityId, label: SpaceBox) -> Option<Box3d> {
        let numbers = [label.cx, label.cy, label.cz, label.l, label.w, label.h, label.rot_z];
        let numbers @ [cx, cy, cz, l, w, h, rot_z] = numbers.map(|Real(number)| number);
        if numbers.iter().all(|number| number.is_finite()) && l > 0.0 && w > 0.0 && h > 0.0 {
            let heading_rad = wrap_rad(PI - rot_z);
            return Some(Box3d { center: [cx, cy, cz], size: [l, w, h], heading_rad });
        }
        let message = format!("expected a 3d box with a volume, found {numbers:?}");
        self.issues.push(Issue::about(IssueKind::BadBox, id, message));
        None
    }

    fn interactions(&mut self, id: &EntityId, label: &SocialLabel) -> Vec<Interaction> {
        let mut interactions = Vec::new();
        for entry in label.interactions.0.iter().flatten() {
            let partner: EntityId = match entry.pair.parse() {
                Ok(partner) => boxes::usual_id(partner),
                Err(error) => {
                    self.bad_label(Some(id), &format!("interaction: {error}"));
                    continue;
                }
            };
            let with =
                |label: &String| Interaction { partner: partner.clone(), label: label.clone() };
            interactions.extend(entry.inter_labels.keys().iter().map(with));
        }
        interactions.sort();
        interactions.dedup();
        interactions
    }
}

fn flat_box(parts: &Parts<'_>) -> Option<PixelBox> {
    let flat = parts.flat.map(|label| label.bbox);
    let numbers = flat.or_else(|| parts.social?.bbox.0)?;
    Some(numbers.map(|Real(number)| number).into())
}

fn occlusion<'a>(parts: &Parts<'a>) -> Option<&'a str> {
    let flat = parts.flat.and_then(|label| label.attributes.0.as_ref());
    let social = || parts.social.and_then(|label| label.attributes.0.as_ref());
    flat.or_else(social)?.occlusion.as_deref()
}

fn attributes(label: &SocialLabel) -> Attributes {
    let demographics = label.demographics().cloned().unwrap_or_default();
    let action: Option<Action> =
        label.action_label.keys().iter().find_map(|word| JrdbWord::from_jrdb_word(word));
    let values = [
        first::<Age>(&demographics.age),
        first::<Gender>(&demographics.gender),
        first::<Race>(&demographics.race),
        action.map(Into::into),
    ];
    Attributes::certain(values.into_iter().flatten())
}

/// The first key, as the benchmark reads demographics.
fn first<T: JrdbWord + Into<AttributeValue>>(section: &Loose<Keys>) -> Option<AttributeValue> {
    section.keys().first().and_then(|word| T::from_jrdb_word(word)).map(Into::into)
}

/// The same direction in (-π, π].
pub(crate) fn wrap_rad(angle_rad: f64) -> f64 {
    let turned = angle_rad.rem_euclid(TAU);
    if turned > PI { turned - TAU } else { turned }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn wrapped_angles_point_the_same_way(angle in -20.0..20.0_f64) {
            let wrapped = wrap_rad(angle);
            prop_assert!(wrapped > -PI && wrapped <= PI);
            prop_assert!((wrapped.sin() - angle.sin()).abs() < 1e-12);
            prop_assert!((wrapped.cos() - angle.cos()).abs() < 1e-12);
        }
    }

    #[test]
    fn backwards_is_plus_pi() {
        assert_eq!(wrap_rad(-PI), PI);
        assert_eq!(wrap_rad(PI), PI);
        assert_eq!(wrap_rad(-1e-300), 0.0);
    }
}
