//! What perception saw, with parts of it replaced by the truth: to learn what each part costs.

use std::collections::BTreeMap;

use jrdb_types::detection::{Interaction, occurring};
use jrdb_types::{Capabilities, Detection, Detections, EntityId};

use crate::same;

/// The parts of the truth that a frame can be given, in the order in which a table shows them. The
/// last is not part of what was seen: questions then have the query that their file states.
pub const TRUTHS: [&str; 6] =
    ["detection", "attributes", "position", "heading", "interactions", "parsing"];

/// Which parts of the truth are given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Truths(pub usize);

impl Truths {
    /// Things, their classes and their boxes in the image.
    pub const DETECTION: Self = Self(1);
    /// What they look like and do.
    pub const ATTRIBUTES: Self = Self(2);
    /// Their boxes in space.
    pub const POSITION: Self = Self(4);
    /// The direction they face.
    pub const HEADING: Self = Self(8);
    /// With whom they do what, and their groups.
    pub const INTERACTIONS: Self = Self(16);
    /// What questions mean.
    pub const PARSING: Self = Self(32);

    /// Whether a part is given.
    #[must_use]
    pub fn has(self, part: Self) -> bool {
        self.0 & part.0 != 0
    }
}

/// Two views of one frame.
#[derive(Debug, Clone, Copy)]
pub struct Views<'a> {
    /// What perception saw, with boxes in space where it was placed.
    pub seen: &'a Detections,
    /// What is there.
    pub truth: &'a Detections,
}

/// What perception saw, with parts of it replaced by the truth.
///
/// A thing that was seen and one that is there are the same where their boxes overlap by an IoU of
/// at least 0.5, greatest overlap first. With true detections, things that were not seen are there
/// without a description, and what was seen and is not there is gone; without them, a description
/// is replaced where the thing is there.
#[must_use]
pub fn inject(views: Views<'_>, truths: Truths) -> Detections {
    let Views { seen, truth } = views;
    let (base, other) = if truths.has(Truths::DETECTION) { (truth, seen) } else { (seen, truth) };
    let pairs = pairs(base, other);
    let names = Names::new(base, other, &pairs);
    let inject_one = |(index, own): (usize, &Detection)| {
        let counterpart = pairs.get(&index).map(|at| &other.detections[*at]);
        let (seen, truth) = match truths.has(Truths::DETECTION) {
            true => (counterpart, Some(own)),
            false => (Some(own), counterpart),
        };
        injected(own, Sides { seen, truth }, truths, &names)
    };
    let detections = base.detections.iter().enumerate().map(inject_one).collect();
    Detections {
        detections,
        capabilities: Some(capabilities(views, truths)),
        issues: seen.issues.clone(),
        ..base.clone()
    }
}

/// One thing in both views, as far as it is there.
#[derive(Clone, Copy)]
struct Sides<'a> {
    seen: Option<&'a Detection>,
    truth: Option<&'a Detection>,
}

impl<'a> Sides<'a> {
    /// Where a part comes from. What is seen and is not there keeps what was seen of it.
    fn of(self, part: Truths, truths: Truths) -> Option<&'a Detection> {
        if truths.has(part) { self.truth.or(self.seen) } else { self.seen }
    }
}

fn injected(own: &Detection, sides: Sides<'_>, truths: Truths, names: &Names<'_>) -> Detection {
    let of = |part| sides.of(part, truths);
    let (with, faces) = (of(Truths::INTERACTIONS), of(Truths::HEADING));
    let mut attributes = of(Truths::ATTRIBUTES).map(|d| d.attributes.clone()).unwrap_or_default();
    // Where somebody faces in the image tells the heading.
    attributes.facing = faces.map(|d| d.attributes.facing.clone()).unwrap_or_default();
    Detection {
        attributes,
        interactions: with.map(|d| names.translated(&d.interactions)).unwrap_or_default(),
        group: with.and_then(|d| d.group),
        heading_rad: faces.and_then(|d| d.heading_rad),
        box3d: of(Truths::POSITION).and_then(|d| d.box3d),
        ..own.clone()
    }
}

/// Which thing of another view each thing is.
fn pairs(base: &Detections, other: &Detections) -> BTreeMap<usize, usize> {
    let boxes = |view: &Detections| view.detections.iter().map(|one| one.bbox).collect::<Vec<_>>();
    same::pairs(&boxes(base), &boxes(other), base.image.period_px())
}

/// The names that things of either view have in the result.
struct Names<'a>(BTreeMap<&'a EntityId, &'a EntityId>);

impl<'a> Names<'a> {
    fn new(base: &'a Detections, other: &'a Detections, pairs: &BTreeMap<usize, usize>) -> Self {
        let others = pairs.iter().map(|(a, b)| (&other.detections[*b].id, &base.detections[*a].id));
        let own = base.detections.iter().map(|one| (&one.id, &one.id));
        Self(others.chain(own).collect())
    }

    /// Interactions with those that the result has.
    fn translated(&self, interactions: &[Interaction]) -> Vec<Interaction> {
        let translate = |one: &Interaction| {
            let partner = (*self.0.get(&one.partner)?).clone();
            Some(Interaction { partner, ..one.clone() })
        };
        interactions.iter().filter_map(translate).collect()
    }
}

fn capabilities(Views { seen, truth }: Views<'_>, truths: Truths) -> Capabilities {
    let stated = |view: &Detections| {
        view.capabilities.clone().unwrap_or_else(|| occurring(&view.detections))
    };
    let (seen, truth) = (stated(seen), stated(truth));
    let of = |part| if truths.has(part) { truth.clone() } else { seen.clone() };
    Capabilities {
        categories: of(Truths::DETECTION).categories,
        attributes: of(Truths::ATTRIBUTES).attributes,
        interactions: of(Truths::INTERACTIONS).interactions,
        ..seen
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use jrdb_types::Belief;
    use jrdb_types::vocab::Facing;
    use jrdb_types::{FrameId, Gender, ImageGeometry, PixelBox};

    fn detection(class: &str, number: u32, x: f64, gender: Gender) -> Detection {
        let bbox = PixelBox::from([x, 10.0, 40.0, 100.0]);
        let mut one = Detection::new(EntityId::new(class, number), "person", 0.5, bbox);
        one.attributes.set_gender(Belief::certain(gender));
        one
    }

    fn view(detections: Vec<Detection>) -> Detections {
        let image = ImageGeometry { width_px: 1000, height_px: 200, wraps: true };
        Detections::new(FrameId::default(), image, detections)
    }

    fn talks(mut one: Detection, class: &str, number: u32) -> Detection {
        let (partner, label) = (EntityId::new(class, number), "conversation".into());
        one.interactions.push(Interaction { partner, label });
        one
    }

    /// Two people talk; the first is seen a little aside and as a woman, the second is not seen, and
    /// somebody is seen who is not there.
    fn views() -> [Detections; 2] {
        let truth = view(vec![
            talks(detection("pedestrian", 1, 100.0, Gender::Male), "pedestrian", 2),
            talks(detection("pedestrian", 2, 300.0, Gender::Female), "pedestrian", 1),
        ]);
        let seen = view(vec![
            detection("person", 7, 104.0, Gender::Female),
            detection("person", 8, 600.0, Gender::Female),
        ]);
        [seen, truth]
    }

    fn given(truths: &[Truths]) -> Detections {
        let [seen, truth] = views();
        let all = truths.iter().fold(0, |all, one| all | one.0);
        inject(Views { seen: &seen, truth: &truth }, Truths(all))
    }

    #[test]
    fn nothing_given_is_what_was_seen_and_everything_given_is_the_truth() {
        let [seen, truth] = views();
        assert_eq!(given(&[]).detections, seen.detections);
        let all = [
            Truths::DETECTION,
            Truths::ATTRIBUTES,
            Truths::POSITION,
            Truths::HEADING,
            Truths::INTERACTIONS,
        ];
        assert_eq!(given(&all).detections, truth.detections);
    }

    #[test]
    fn true_attributes_go_to_what_was_seen_and_is_there() {
        let found = given(&[Truths::ATTRIBUTES]).detections;
        let genders: Vec<_> = found.iter().map(|one| one.attributes.gender().best()).collect();
        assert_eq!(genders, [Some(Gender::Male), Some(Gender::Female)]);
        assert_eq!(found[0].id, EntityId::new("person", 7));
    }

    #[test]
    fn true_attributes_leave_the_heading_that_was_seen() {
        let [mut seen, truth] = views();
        seen.detections[0].attributes.facing = Belief::certain(Facing::Left);
        let given = inject(Views { seen: &seen, truth: &truth }, Truths::ATTRIBUTES);
        assert_eq!(given.detections[0].attributes.facing.best(), Some(Facing::Left));
    }

    #[test]
    fn true_detections_keep_the_descriptions_that_were_seen() {
        let found = given(&[Truths::DETECTION]).detections;
        let genders: Vec<_> = found.iter().map(|one| one.attributes.gender().best()).collect();
        assert_eq!(genders, [Some(Gender::Female), None]);
    }

    #[test]
    fn interactions_are_with_those_who_are_in_the_result() {
        assert!(given(&[Truths::INTERACTIONS]).detections[0].interactions.is_empty());
        let both = given(&[Truths::DETECTION, Truths::INTERACTIONS]).detections;
        assert_eq!(both[0].interactions[0].partner, both[1].id);
    }
}
