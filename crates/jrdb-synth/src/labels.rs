//! The true labels of a frame.

use std::collections::BTreeMap;

use jrdb_dataset::LabelledFrame;
use jrdb_projection::BaseCloud;
use jrdb_projection::nalgebra::{Point3, Vector3};
use jrdb_types::detection::{Interaction, PERSON};
use jrdb_types::vocab::Occlusion;
use jrdb_types::{
    Attributes, Box3d, Detection, Detections, EntityId, FrameId, LensModel, PointCloud,
};

use super::paint::{Drawn, Subject};
use super::person::Person;
use super::robot;
use super::solid::{Shape, Solid};

/// Shares of visible pixels at which JRDB's words for occlusion begin.
const FULLY_VISIBLE: f64 = 0.9;
const MOSTLY_VISIBLE: f64 = 0.6;
const SEVERELY_OCCLUDED: f64 = 0.2;

/// Everything drawn, sorted by id, with the number of LiDAR points in each 3D box.
pub(super) fn labels(
    frame: &FrameId,
    subjects: &[Subject<'_>],
    drawn: &[Drawn],
    clouds: &[PointCloud],
) -> LabelledFrame {
    let cloud = BaseCloud::merge(clouds, &robot::sensors(), &mut Vec::new());
    let mut detections: Vec<Detection> = drawn
        .iter()
        .filter_map(|drawn| {
            Some(detection(subjects.iter().find(|subject| subject.id() == drawn.id)?, drawn))
        })
        .collect();
    detections.sort_by(|a, b| a.id.cmp(&b.id));
    let count = |detection: &Detection| {
        let inside = detection.box3d.map_or(0, |label| points_inside(&cloud, &label));
        (detection.id.clone(), inside)
    };
    let num_points: BTreeMap<EntityId, usize> = detections.iter().map(count).collect();
    let image = LensModel::Cylindrical(robot::calibration().panorama).image();
    let detections = Detections::new(frame.clone(), image, detections);
    LabelledFrame { detections, num_points }
}

fn detection(subject: &Subject<'_>, drawn: &Drawn) -> Detection {
    let (category, box3d, attributes, interactions) = match subject {
        Subject::Person(person, pose) => {
            (PERSON.into(), person.box3d(pose), attributes(person), interactions(person))
        }
        Subject::Furniture(thing) => {
            (thing.id.class.clone(), thing.box3d(), Attributes::default(), Vec::new())
        }
    };
    Detection {
        camera: None,
        id: drawn.id.clone(),
        category,
        score: 1.0,
        bbox: drawn.bbox,
        attributes,
        interactions,
        group: None,
        occlusion: Some(occlusion(drawn.visible)),
        heading_rad: Some(box3d.heading_rad),
        box3d: Some(box3d),
    }
}

pub(super) fn attributes(person: &Person) -> Attributes {
    Attributes::certain([
        person.age.into(),
        person.gender.into(),
        person.race.into(),
        person.action.into(),
    ])
}

fn interactions(person: &Person) -> Vec<Interaction> {
    let with = |(number, label): (u32, &str)| Interaction {
        partner: EntityId::new("pedestrian", number),
        label: label.into(),
    };
    person.company.map(with).into_iter().collect()
}

fn occlusion(visible: f64) -> Occlusion {
    match visible {
        share if share >= FULLY_VISIBLE => Occlusion::FullyVisible,
        share if share >= MOSTLY_VISIBLE => Occlusion::MostlyVisible,
        share if share >= SEVERELY_OCCLUDED => Occlusion::SeverelyOccluded,
        _ => Occlusion::FullyOccluded,
    }
}

fn points_inside(cloud: &BaseCloud, label: &Box3d) -> usize {
    let solid = Solid {
        shape: Shape::Block,
        center: Point3::from(label.center),
        half: Vector3::from(label.size) / 2.0,
        yaw_rad: label.heading_rad,
    };
    (0..cloud.len()).filter(|&point| solid.contains(&cloud.point(point))).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn occlusion_words_begin_at_their_shares() {
        let words = [1.0, 0.9, 0.89, 0.6, 0.59, 0.2, 0.19].map(|share| occlusion(share).word());
        let [full, most] = ["fully visible", "mostly visible"];
        let [severe, hidden] = ["severely occluded", "fully occluded"];
        assert_eq!(words, [full, full, most, most, severe, severe, hidden]);
    }
}
