//! The stage: detections and points in, entities and relations out.

use std::collections::BTreeMap;

use jrdb_types::entity::FloorContact;
use jrdb_types::issue::IssueKind;
use jrdb_types::{
    Box3d, Detection, Detections, Entities, Entity, EntityId, FloorPlane, Heading, ImageGeometry,
    Issue, Localizer, PixelBox, PointCloud, Position, Rig, detection::PERSON,
};

use crate::box_view::BoxView;
use crate::heading::motion::Motion;
use crate::person_box::{box_around, person_box};
use crate::place::{Placement, Space, Spot, place};
use crate::relation::occlusion::Silhouette;
use crate::relation::{Thing, between_all, relate};
use crate::{BaseCloud, CameraModel, Error, ProjectionConfig, Sensors, heading, relation};

/// How things move, by id; in a frame at rest with the axes of the base frame.
pub type Motions = BTreeMap<EntityId, Motion>;

/// What the robot knows of a frame besides the detections.
#[derive(Debug, Clone, Copy)]
pub struct Scan<'a> {
    /// One sweep per LiDAR, in the sensors' frames; all are merged in the base frame.
    pub clouds: &'a [PointCloud],
    /// The sensors.
    pub rig: &'a Rig,
    /// The camera that the detections were made with; the rig's first when absent.
    pub camera: Option<&'a str>,
    /// The floor, where it is known.
    pub floor: Option<FloorPlane>,
    /// How things move, where that is known.
    pub motions: Option<&'a Motions>,
}

impl<'a> Scan<'a> {
    /// Sweeps and a rig; nothing else is known.
    #[must_use]
    pub fn new(clouds: &'a [PointCloud], rig: &'a Rig) -> Self {
        Self { clouds, rig, camera: None, floor: None, motions: None }
    }
}

/// Places every detection in space and relates every pair of placed ones.
///
/// A detection without points keeps its place in the list, without a position and with an issue. Where
/// many frames share a rig, or a frame's points are needed elsewhere, [`crate::place`] and [`entities`]
/// do the same with sensors and points that are prepared once.
///
/// # Errors
/// [`Error::ImageSize`] and [`Error::Rig`]; everything else is an issue in the result.
pub fn project(
    detections: &Detections,
    scan: &Scan<'_>,
    config: &ProjectionConfig,
) -> Result<Entities, Error> {
    let sensors = Sensors::new(scan.rig, scan.camera)?;
    let mut issues = Vec::new();
    let cloud = BaseCloud::merge(scan.clouds, &sensors, &mut issues);
    let space = Space { cloud: &cloud, sensors: &sensors, floor: scan.floor };
    let placements = place(detections, &space, config)?;
    let nothing = Motions::new();
    let motions = scan.motions.unwrap_or(&nothing);
    let mut found = entities(detections, placements, &space, motions, config);
    found.issues.splice(0..0, issues);
    Ok(found)
}

/// Entities and the relations of every pair of them, from detections whose places are known. Issues of the detections
/// about lost inputs are carried on: they decide what can be said about the frame.
///
/// `placements` are those of [`crate::place`] for the same detections and points. `motions` may be empty.
#[must_use]
pub fn entities(
    detections: &Detections,
    placements: Vec<Placement>,
    space: &Space<'_>,
    motions: &Motions,
    config: &ProjectionConfig,
) -> Entities {
    let mut issues = Vec::new();
    let frame = Frame { space, motions, config };
    let all = detections.detections.iter().zip(placements);
    let placed: Vec<Placed> =
        all.map(|(detection, place)| frame.placed(detection, place, &mut issues)).collect();
    let things: Vec<Thing<'_>> = placed.iter().filter_map(Placed::thing).collect();
    let image = space.sensors.camera.image();
    let relations = relate(&things, image, config.lateral, &config.relation);
    let between = between_all(&things, &config.relation);
    let frame = detections.frame.clone();
    let entities = placed.into_iter().map(|placed| placed.entity).collect();
    let (lateral, capabilities) = (config.lateral, detections.capabilities.clone());
    let inputs = detections.issues.iter().filter(|issue| issue.kind.loses_input());
    issues.splice(0..0, inputs.cloned());
    Entities { frame, lateral, entities, relations, between, capabilities, issues }
}

/// An entity and its points.
struct Placed {
    entity: Entity,
    own: Vec<u32>,
    up_to_it: Vec<u32>,
}

impl Placed {
    fn thing(&self) -> Option<Thing<'_>> {
        let entity = &self.entity;
        let position = entity.position?;
        let range_m = position.range_m;
        let (own, up_to_it) = (self.own.as_slice(), self.up_to_it.as_slice());
        Some(Thing {
            id: &entity.id,
            is_person: entity.category == PERSON,
            center: position.center.into(),
            heading: entity.heading,
            box3d: entity.box3d,
            velocity_mps: entity.velocity_mps,
            silhouette: Silhouette { bbox: &entity.bbox, range_m, own, up_to_it },
        })
    }
}

struct Frame<'a> {
    space: &'a Space<'a>,
    motions: &'a Motions,
    config: &'a ProjectionConfig,
}

impl Frame<'_> {
    fn placed(
        &self,
        detection: &Detection,
        Placement(spot): Placement,
        issues: &mut Vec<Issue>,
    ) -> Placed {
        let view = BoxView::new(&detection.bbox, &self.space.sensors.camera);
        let motion = self.motions.get(&detection.id);
        let heading = self.heading(detection, spot.as_ref(), motion);
        let position = spot.as_ref().map(|spot| spot.position);
        let entity = Entity {
            id: detection.id.clone(),
            category: detection.category.clone(),
            score: detection.score,
            bbox: detection.bbox,
            attributes: detection.attributes.clone(),
            interactions: detection.interactions.clone(),
            group: detection.group,
            occlusion: detection.occlusion,
            position,
            box3d: spot.as_ref().and_then(|spot| self.box3d(detection, spot, view, heading)),
            heading,
            velocity_mps: motion.map(|motion| motion.velocity_mps),
            floor: position.zip(view).and_then(|(position, view)| self.floor(&position, &view)),
            from_robot: position
                .map(|p| relation::from_robot(&p.center.into(), self.config.lateral)),
        };
        self.report(&entity, issues);
        let (own, up_to_it) = spot.map_or_else(Default::default, |spot| (spot.own, spot.up_to_it));
        Placed { entity, own, up_to_it }
    }

    /// Without a place only a label or motion can tell a heading.
    fn heading(
        &self,
        detection: &Detection,
        spot: Option<&Spot>,
        motion: Option<&Motion>,
    ) -> Option<Heading> {
        let center = spot.map(|spot| &spot.of_points);
        let own = spot.map_or(&[][..], |spot| spot.own.as_slice());
        heading::heading(detection, center, motion, (self.space.cloud, own), &self.config.heading)
    }

    fn box3d(
        &self,
        detection: &Detection,
        spot: &Spot,
        view: Option<BoxView>,
        heading: Option<Heading>,
    ) -> Option<Box3d> {
        let config = self.config;
        if config.localizer == Localizer::Given {
            return detection.box3d;
        }
        if detection.category != PERSON {
            return box_around(&spot.own, self.space.cloud, &spot.of_points, config);
        }
        let heading_rad = heading.map(|heading| heading.angle_rad);
        view.map(|view| person_box(&spot.of_points, &view, heading_rad, config))
    }

    fn floor(&self, position: &Position, view: &BoxView) -> Option<FloorContact> {
        let [x, y, _] = position.center;
        let [_, bottom] = view.heights_m(view.range_m(&position.center.into()));
        let gap_m = bottom - self.space.floor?.height_at_m(x, y);
        let touches = gap_m.abs() <= self.config.floor_tolerance_m && !view.cut_off[1];
        Some(FloorContact { gap_m, touches })
    }

    fn report(&self, entity: &Entity, issues: &mut Vec<Issue>) {
        let id = &entity.id;
        let few = self.config.few_points;
        if let Some(wrong) = wrong_with(&entity.bbox, self.space.sensors.camera.image()) {
            issues.push(Issue::about(IssueKind::BadBox, id, wrong));
        }
        match entity.position {
            None if self.config.localizer == Localizer::Given => {
                let message = "the detection brings no 3d box";
                issues.push(Issue::about(IssueKind::NoPoints, id, message));
            }
            None => issues.push(Issue::about(IssueKind::NoPoints, id, "no lidar point in the box")),
            Some(p) if p.localizer != Localizer::Given && p.points_used < few => {
                let message = format!("placed from {} points, fewer than {few}", p.points_used);
                issues.push(Issue::about(IssueKind::FewPoints, id, message));
            }
            Some(_) => {}
        }
        if entity.category == PERSON && entity.heading.is_none() {
            let message = "the heading is unknown: no left, right, front or back of this person";
            issues.push(Issue::about(IssueKind::NoHeading, id, message));
        }
    }
}

/// Why no point can be in a box; `None` when some can.
fn wrong_with(bbox: &PixelBox, image: ImageGeometry) -> Option<&'static str> {
    let [width, height] = [image.width_px, image.height_px].map(f64::from);
    let beside = !image.wraps && (bbox.x >= width || bbox.x + bbox.w <= 0.0);
    if !bbox.is_proper() {
        Some("the box has no area")
    } else if beside || bbox.y >= height || bbox.y + bbox.h <= 0.0 {
        Some("the box lies outside the image")
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{RigError, testing};
    use jrdb_types::FrameId;

    fn rig() -> Rig {
        testing::rig([0.0; 3], 0.0)
    }

    fn person(number: u32, bbox: [f64; 4], heading_rad: Option<f64>) -> Detection {
        Detection {
            camera: None,
            id: EntityId::new("pedestrian", number),
            category: PERSON.into(),
            score: 1.0,
            bbox: PixelBox::from(bbox),
            attributes: Default::default(),
            interactions: Vec::new(),
            group: None,
            occlusion: None,
            heading_rad,
            box3d: None,
        }
    }

    fn detections(detections: Vec<Detection>) -> Detections {
        let image = rig().cameras[0].lens.image();
        Detections::new(FrameId::default(), image, detections)
    }

    /// Two people, 4 m ahead and 4 m to the left, ten points each.
    fn two_people() -> (Detections, PointCloud) {
        let people = vec![
            person(1, [1850.0, 130.0, 60.0, 204.0], Some(-2.9)),
            person(2, [910.0, 130.0, 60.0, 204.0], None),
        ];
        let x = [vec![3.9; 10], vec![0.0; 10]].concat();
        let y = [vec![0.0; 10], vec![3.9; 10]].concat();
        let z = (0..20_u8).map(|i| 0.02 * f32::from(i % 10)).collect();
        (
            detections(people),
            PointCloud { sensor: "upper".into(), x, y, z, ..PointCloud::default() },
        )
    }

    #[test]
    fn people_are_placed_and_related_in_both_directions() {
        let (detections, cloud) = two_people();
        let found =
            project(&detections, &Scan::new(&[cloud], &rig()), &ProjectionConfig::default())
                .unwrap();
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
        let found =
            project(&detections, &Scan::new(&[], &rig()), &ProjectionConfig::default()).unwrap();
        assert_eq!(found.entities.len(), 2);
        assert!(found.entities.iter().all(|e| e.position.is_none() && e.from_robot.is_none()));
        assert_eq!(found.issues.iter().filter(|i| i.kind == IssueKind::NoPoints).count(), 2);
    }

    #[test]
    fn boxes_and_sweeps_that_hold_nothing_are_named() {
        let boxes = [[1850.0, 130.0, 0.0, 9.0], [5.0, 480.0, 9.0, 9.0], [5.0, f64::NAN, 9.0, 9.0]];
        let people = (1..).zip(boxes).map(|(n, bbox)| person(n, bbox, Some(0.0))).collect();
        let sweep = PointCloud { sensor: "upper".into(), ..PointCloud::default() };
        let (rig, config) = (rig(), ProjectionConfig::default());
        let found = project(&detections(people), &Scan::new(&[sweep], &rig), &config).unwrap();
        let messages: Vec<&str> = found.issues.iter().map(|issue| issue.message.as_str()).collect();
        let nothing = "no lidar point in the box";
        assert_eq!(
            messages,
            [
                r#"the sweep of "upper" has no points"#,
                "the box has no area",
                nothing,
                "the box lies outside the image",
                nothing,
                "the box has no area",
                nothing
            ]
        );
    }

    #[test]
    fn detections_on_another_image_are_refused() {
        let (mut detections, _) = two_people();
        detections.image.width_px = 1880;
        let error = project(&detections, &Scan::new(&[], &rig()), &ProjectionConfig::default())
            .unwrap_err();
        assert_eq!(
            error.to_string(),
            "expected detections on a [3760, 480] px image as the rig has, found [1880, 480] px"
        );
    }

    #[test]
    fn a_rig_that_is_not_a_number_is_refused() {
        let mut rig = rig();
        rig.transforms[1].translation_m[0] = f64::NAN;
        let found = detections(Vec::new());
        let found = project(&found, &Scan::new(&[], &rig), &ProjectionConfig::default());
        assert!(matches!(found, Err(Error::Rig(RigError::Frames(_)))));
    }
}
