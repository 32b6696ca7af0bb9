//! The stage: detections and points in, entities and relations out.

use jrdb_types::issue::IssueKind;
use jrdb_types::{
    Box3d, Detection, Detections, Entities, Entity, Issue, Localizer, PairRelation, PointCloud,
    Position, Rig, detection::PERSON,
};
use nalgebra::Point3;

use crate::localize::{self, Located, densest_range::IsPerson};
use crate::person_box::person_box;
use crate::select::points_in_boxes;
use crate::{BaseCloud, ProjectionConfig, relation};

/// Why a frame cannot be projected at all.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The detections were made on an image of another size than the rig's.
    #[error(
        "expected detections on a {expected_px:?} px image as the rig has, found {found_px:?} px"
    )]
    ImageSize {
        /// Columns and rows of the rig's panorama.
        expected_px: [u32; 2],
        /// Columns and rows of the image of the detections.
        found_px: [u32; 2],
    },
    /// The rig's numbers are unusable.
    #[error("expected a finite, positive focal length and finite mounts in the rig, found {found}")]
    BadRig {
        /// What was found.
        found: String,
    },
}

/// Places every detection in space and relates every pair of placed ones.
///
/// `clouds` are single sweeps in their sensors' frames; all are merged in the base frame.
/// A detection without points keeps its place in the list, without a position and with an issue.
///
/// # Errors
/// [`Error::ImageSize`] and [`Error::BadRig`]; everything else is an issue in the result.
pub fn project(
    detections: &Detections,
    clouds: &[PointCloud],
    rig: &Rig,
    config: &ProjectionConfig,
) -> Result<Entities, Error> {
    check(detections, rig)?;
    let mut issues = Vec::new();
    let cloud = BaseCloud::merge(clouds, rig, &mut issues);
    let boxes: Vec<_> = detections.detections.iter().map(|d| d.bbox).collect();
    let inside = points_in_boxes(&cloud, &boxes, detections.image);
    let frame = Frame { cloud: &cloud, rig, config };
    let entities: Vec<Entity> = detections
        .detections
        .iter()
        .zip(&inside)
        .map(|(detection, inside)| frame.entity(detection, inside, &mut issues))
        .collect();
    let relations = relate(&entities, config);
    let frame = detections.frame.clone();
    Ok(Entities { frame, lateral: config.lateral, entities, relations, issues })
}

fn check(detections: &Detections, rig: &Rig) -> Result<(), Error> {
    let expected_px = [rig.panorama.width_px, rig.panorama.height_px];
    let found_px = [detections.image.width_px, detections.image.height_px];
    if expected_px != found_px {
        return Err(Error::ImageSize { expected_px, found_px });
    }
    let mount = |m: &jrdb_types::LidarMount| {
        m.yaw_rad.is_finite() && m.offset_m.iter().all(|c| c.is_finite())
    };
    let camera = &rig.panorama;
    if camera.focal_px <= 0.0 || !(camera.focal_px + camera.horizon_px).is_finite() {
        return Err(Error::BadRig { found: format!("{camera:?}") });
    }
    match rig.lidars.iter().find(|m| !mount(m)) {
        Some(broken) => Err(Error::BadRig { found: format!("{broken:?}") }),
        None => Ok(()),
    }
}

struct Frame<'a> {
    cloud: &'a BaseCloud,
    rig: &'a Rig,
    config: &'a ProjectionConfig,
}

impl Frame<'_> {
    fn entity(&self, detection: &Detection, inside: &[usize], issues: &mut Vec<Issue>) -> Entity {
        let placed = match self.config.localizer {
            Localizer::Given => given(detection, inside),
            Localizer::Mean | Localizer::DensestRange => self.placed_by_points(detection, inside),
        };
        self.report(detection, placed.as_ref().map(|(position, _)| position), issues);
        let (position, box3d) =
            placed.map_or((None, None), |(position, box3d)| (Some(position), box3d));
        Entity {
            id: detection.id.clone(),
            category: detection.category.clone(),
            score: detection.score,
            bbox: detection.bbox,
            attributes: detection.attributes.clone(),
            interactions: detection.interactions.clone(),
            occlusion: detection.occlusion,
            position,
            box3d,
            heading_rad: detection.heading_rad,
            from_robot: position
                .map(|p| relation::from_robot(&p.center.into(), self.config.lateral)),
        }
    }

    fn placed_by_points(
        &self,
        detection: &Detection,
        inside: &[usize],
    ) -> Option<(Position, Option<Box3d>)> {
        let is_person = if detection.category == PERSON { IsPerson::Yes } else { IsPerson::No };
        let (camera, config) = (&self.rig.panorama, self.config);
        let points = &self.cloud.points;
        let Located { center, used } = match config.localizer {
            Localizer::Mean => localize::mean(points, inside),
            _ => localize::densest_range(
                self.cloud,
                inside,
                &detection.bbox,
                is_person,
                camera,
                config,
            ),
        }?;
        let box3d = (is_person == IsPerson::Yes)
            .then(|| person_box(&center, &detection.bbox, detection.heading_rad, camera, config));
        // The mean is the paper's own centre; the median height of a few rings is not a person's middle.
        let center = match (config.localizer, box3d) {
            (Localizer::DensestRange, Some(box3d)) => box3d.center,
            _ => center.into(),
        };
        let ranges = used.iter().map(|&i| points[i].x.hypot(points[i].y));
        let range_m =
            ranges.fold([f64::INFINITY, 0.0], |[near, far], r| [near.min(r), f64::max(far, r)]);
        let (localizer, points_in_box, points_used) = (config.localizer, inside.len(), used.len());
        Some((Position { center, localizer, points_in_box, points_used, range_m }, box3d))
    }

    fn report(&self, detection: &Detection, position: Option<&Position>, issues: &mut Vec<Issue>) {
        let id = &detection.id;
        let few = self.config.few_points;
        match position {
            None if self.config.localizer == Localizer::Given => {
                issues.push(Issue::about(
                    IssueKind::NoPoints,
                    id,
                    "the detection brings no 3d box",
                ));
            }
            None => issues.push(Issue::about(IssueKind::NoPoints, id, "no lidar point in the box")),
            Some(p) if p.localizer != Localizer::Given && p.points_used < few => {
                let message = format!("placed from {} points, fewer than {few}", p.points_used);
                issues.push(Issue::about(IssueKind::FewPoints, id, message));
            }
            Some(_) => {}
        }
        if detection.category == PERSON && detection.heading_rad.is_none() {
            let message = "the heading is unknown: no left, right, front or back of this person";
            issues.push(Issue::about(IssueKind::NoHeading, id, message));
        }
    }
}

fn given(detection: &Detection, inside: &[usize]) -> Option<(Position, Option<Box3d>)> {
    let box3d = detection.box3d?;
    let [x, y, _] = box3d.center;
    let range_m = x.hypot(y);
    let position = Position {
        center: box3d.center,
        localizer: Localizer::Given,
        points_in_box: inside.len(),
        points_used: 0,
        range_m: [range_m; 2],
    };
    Some((position, Some(box3d)))
}

fn relate(entities: &[Entity], config: &ProjectionConfig) -> Vec<PairRelation> {
    let placed: Vec<(&Entity, Point3<f64>)> =
        entities.iter().filter_map(|e| Some((e, e.position?.center.into()))).collect();
    let mut relations = Vec::new();
    for (subject, from) in &placed {
        for (object, to) in placed.iter().filter(|(object, _)| object.id != subject.id) {
            relations.push(PairRelation {
                subject: subject.id.clone(),
                object: object.id.clone(),
                relation: relation::from_person(from, subject.heading_rad, to, config.lateral),
            });
        }
    }
    relations
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing;
    use jrdb_types::rig::CylindricalPanorama;
    use jrdb_types::{EntityId, FrameId, PixelBox};

    fn rig() -> Rig {
        testing::rig([0.0; 3], 0.0)
    }

    fn person(number: u32, bbox: [f64; 4], heading_rad: Option<f64>) -> Detection {
        Detection {
            id: EntityId::new("pedestrian", number),
            category: PERSON.into(),
            score: 1.0,
            bbox: PixelBox::from(bbox),
            attributes: Default::default(),
            interactions: Vec::new(),
            occlusion: None,
            heading_rad,
            box3d: None,
        }
    }

    fn detections(detections: Vec<Detection>) -> Detections {
        let image = CylindricalPanorama::image(&rig().panorama);
        Detections { frame: FrameId::default(), image, detections, issues: Vec::new() }
    }

    /// Two people, 4 m ahead and 4 m to the left, ten points each.
    fn two_people() -> (Detections, PointCloud) {
        let people = vec![
            person(1, [1850.0, 130.0, 60.0, 204.0], Some(-2.9)),
            person(2, [910.0, 130.0, 60.0, 204.0], None),
        ];
        let x = [vec![3.9; 10], vec![0.0; 10]].concat();
        let y = [vec![0.0; 10], vec![3.9; 10]].concat();
        let z = (0..20).map(|i| 0.02 * f64::from(i % 10)).collect();
        (
            detections(people),
            PointCloud { sensor: "upper".into(), x, y, z, ..PointCloud::default() },
        )
    }

    #[test]
    fn people_are_placed_and_related_in_both_directions() {
        let (detections, cloud) = two_people();
        let found = project(&detections, &[cloud], &rig(), &ProjectionConfig::default()).unwrap();
        let robot = found.entities[1].from_robot.unwrap();
        assert_eq!(robot.direction.unwrap().to_string(), "left");
        assert_eq!(found.relations.len(), 2);
        // The first person looks back at the robot: what is left of the robot is on their right.
        let relation = &found.relations[0].relation;
        assert_eq!(relation.direction.unwrap().to_string(), "right");
        assert_eq!(found.relations[1].relation.direction, None);
        assert_eq!(found.issues[0].kind, IssueKind::NoHeading);
    }

    #[test]
    fn a_person_without_points_stays_without_a_place() {
        let (detections, _) = two_people();
        let found = project(&detections, &[], &rig(), &ProjectionConfig::default()).unwrap();
        assert_eq!(found.entities.len(), 2);
        assert!(found.entities.iter().all(|e| e.position.is_none() && e.from_robot.is_none()));
        assert_eq!(found.issues.iter().filter(|i| i.kind == IssueKind::NoPoints).count(), 2);
    }

    #[test]
    fn detections_on_another_image_are_refused() {
        let (mut detections, _) = two_people();
        detections.image.width_px = 1880;
        let error = project(&detections, &[], &rig(), &ProjectionConfig::default()).unwrap_err();
        assert_eq!(
            error.to_string(),
            "expected detections on a [3760, 480] px image as the rig has, found [1880, 480] px"
        );
    }

    #[test]
    fn a_rig_that_is_not_a_number_is_refused() {
        let mut rig = rig();
        rig.lidars[0].yaw_rad = f64::NAN;
        assert!(project(&detections(Vec::new()), &[], &rig, &ProjectionConfig::default()).is_err());
    }
}
