//! From a frame to a scene: perception, places, relations, graph and index, each once.

use std::sync::Arc;

use jrdb_calibration::FloorConfig;
use jrdb_graph::IndexedGraph;
use jrdb_perception::{Perceive, View};
use jrdb_projection::{BaseCloud, Motions, Placement, Space};
use jrdb_types::{
    Capabilities, Coverage, Detection, Detections, EntityId, FloorPlane, Issue, IssueKind,
    Localizer, PointCloud,
};

use crate::motion::Places;
use crate::scene::Scene;
use crate::{Error, Frame, PipelineConfig, Robot};

/// A robot, what it perceives with, and how the stages work. Cloning is cheap: all of it is shared.
#[derive(Clone)]
pub struct Pipeline {
    pub(crate) robot: Arc<Robot>,
    pub(crate) perception: Arc<dyn Perceive>,
    pub(crate) config: Arc<PipelineConfig>,
}

/// A frame whose things have places, but no headings and relations yet: those may depend on how the things move.
pub struct PlacedFrame {
    pub(crate) frame: Frame,
    pub(crate) detections: Detections,
    pub(crate) cloud: BaseCloud,
    floor: Option<FloorPlane>,
    placements: Vec<Placement>,
    issues: Vec<Issue>,
}

impl PlacedFrame {
    /// Where the things are, to be compared with other frames.
    #[must_use]
    pub fn places(&self) -> Places {
        let placed = self.detections.detections.iter().zip(&self.placements);
        let centers = placed.filter_map(|(detection, placement)| {
            let [x, y, _] = placement.center_m()?;
            Some((detection.id.clone(), [x, y]))
        });
        Places::new(self.frame.id.clone(), centers)
    }
}

impl Pipeline {
    /// A pipeline for one robot.
    pub fn new(
        robot: impl Into<Arc<Robot>>,
        perception: impl Perceive + 'static,
        config: PipelineConfig,
    ) -> Self {
        Self::sharing(robot.into(), Arc::new(perception), Arc::new(config))
    }

    /// A pipeline with parts that others use, too.
    #[must_use]
    pub fn sharing(
        robot: Arc<Robot>,
        perception: Arc<dyn Perceive>,
        config: Arc<PipelineConfig>,
    ) -> Self {
        Self { robot, perception, config }
    }

    /// The robot.
    #[must_use]
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// How the stages work.
    #[must_use]
    pub fn config(&self) -> &PipelineConfig {
        &self.config
    }

    /// What the robot perceives with.
    #[must_use]
    pub fn perception(&self) -> &dyn Perceive {
        &*self.perception
    }

    /// Sees a frame: the result can be asked any number of questions.
    ///
    /// # Errors
    /// When perception fails, or the detections do not fit the rig. What cannot be used of the frame is an issue in the
    /// scene, not an error.
    pub fn see(&self, frame: Frame) -> Result<Scene, Error> {
        Ok(self.complete(self.place(frame)?, &Motions::new()))
    }

    /// The first half of [`Pipeline::see`]: detections and their places.
    ///
    /// # Errors
    /// As [`Pipeline::see`].
    pub fn place(&self, frame: Frame) -> Result<PlacedFrame, Error> {
        let detections = self.perceive(&frame)?;
        self.place_detections(frame, detections)
    }

    /// Sees a frame whose detections are known already.
    ///
    /// # Errors
    /// When the detections do not fit the rig.
    pub fn see_detections(&self, frame: Frame, detections: Detections) -> Result<Scene, Error> {
        Ok(self.complete(self.place_detections(frame, detections)?, &Motions::new()))
    }

    /// A scene whose things have no places, and so no relations; the cloud is there to be drawn.
    pub(crate) fn unplaced(&self, frame: Frame, detections: Detections) -> Result<Scene, Error> {
        let nothing = Detections { detections: Vec::new(), ..detections.clone() };
        let placed = self.place_detections(frame, nothing)?;
        let placements = vec![Placement::UNKNOWN; detections.detections.len()];
        let inputs = detections.issues.iter().filter(|issue| issue.kind.loses_input()).cloned();
        let issues = placed.issues.iter().cloned().chain(inputs).collect();
        let placed = PlacedFrame { detections, placements, ..placed };
        let mut scene = self.complete(placed, &Motions::new());
        // That things have no place is no trouble here.
        scene.entities.issues = issues;
        Ok(scene)
    }

    /// The second half of [`Pipeline::see`]: headings, relations, the graph and its index.
    #[must_use]
    pub fn complete(&self, placed: PlacedFrame, motions: &Motions) -> Scene {
        let PlacedFrame { frame, detections, cloud, floor, placements, issues } = placed;
        let uses_points = self.config.projection.localizer != Localizer::Given;
        let has_blind_lidar = uses_points && self.robot.rig().lidars.len() > usable(&frame.sweeps);
        let space = Space { cloud: &cloud, sensors: self.robot.sensors(), floor };
        let config = &self.config.projection;
        let mut entities =
            jrdb_projection::entities(&detections, placements, &space, motions, config);
        entities.issues.splice(0..0, issues);
        if has_blind_lidar {
            let capabilities = entities.capabilities.get_or_insert_with(Capabilities::none);
            capabilities.places = Coverage::Partial;
        }
        let graph = IndexedGraph::new(jrdb_graph::build(&entities, &self.config.graph));
        let (perception, config) = (Arc::clone(&self.perception), Arc::clone(&self.config));
        Scene { perception, config, frame, detections, cloud, entities, graph }
    }

    /// What perception finds in a frame, without points.
    ///
    /// # Errors
    /// When perception fails.
    pub fn perceive(&self, frame: &Frame) -> Result<Detections, Error> {
        let image = frame.images.first();
        let pixels = match image {
            Some(image) if self.perception.looks_at_images() => image.pixels().ok(),
            _ => None,
        };
        let view = View { geometry: self.robot.image(), image: pixels };
        let found = self.perception.perceive(&frame.id, &view);
        let fail = |source| Error::Perception { frame: frame.id.clone(), source };
        let mut detections = found.map_err(fail)?;
        let sees = detections.capabilities.get_or_insert_with(|| self.perception.capabilities());
        if detections.issues.iter().any(|issue| is_lost(issue, &detections.detections)) {
            sees.categories = Capabilities::none().categories;
        }
        detections.issues.extend(image.and_then(|image| image.known_issue()).cloned());
        Ok(detections)
    }

    fn place_detections(&self, frame: Frame, detections: Detections) -> Result<PlacedFrame, Error> {
        let detections = most_confident(detections, self.config.detections_max);
        let mut issues = frame.issues.clone();
        let sensors = self.robot.sensors();
        let cloud = BaseCloud::merge(&frame.sweeps, sensors, &mut issues);
        let floor = floor(&cloud, &self.config.floor);
        let space = Space { cloud: &cloud, sensors, floor };
        let fail = |source| Error::Projection { frame: frame.id.to_string(), source };
        let placements = jrdb_projection::place(&detections, &space, &self.config.projection);
        let placements = placements.map_err(fail)?;
        Ok(PlacedFrame { frame, detections, cloud, floor, placements, issues })
    }
}

/// Whether an issue is about something that is not among the detections: who is not seen may be that one.
fn is_lost(issue: &Issue, found: &[Detection]) -> bool {
    let is_about = |subject: &EntityId| found.iter().any(|detection| detection.id == *subject);
    match issue.kind {
        IssueKind::BadBox | IssueKind::MissingInput => true,
        IssueKind::BadLabel => !issue.subject.as_ref().is_some_and(is_about),
        _ => false,
    }
}

/// How many sweeps have any points.
fn usable(sweeps: &[PointCloud]) -> usize {
    sweeps.iter().filter(|sweep| !sweep.is_empty()).count()
}

/// The most confident detections where there are too many, with an issue.
fn most_confident(mut found: Detections, most: usize) -> Detections {
    let count = found.detections.len();
    if count > most {
        // Stable: of equally confident ones those of the lower ids are kept.
        found.detections.sort_by(|a, b| b.score.total_cmp(&a.score));
        found.detections.truncate(most);
        found.detections.sort_by(|a, b| a.id.cmp(&b.id));
        let message = format!(
            "expected at most {most} detections in a frame, found {count}: the {most} most confident are used; \
             does the detector suppress overlapping boxes?"
        );
        found.issues.push(Issue::new(IssueKind::MissingInput, message));
        let sees = found.capabilities.get_or_insert_with(Capabilities::none);
        sees.categories = Capabilities::none().categories;
    }
    found
}

/// The floor under the robot, where enough of it is seen.
fn floor(cloud: &BaseCloud, config: &FloorConfig) -> Option<FloorPlane> {
    let points: Vec<_> = (0..cloud.len()).map(|i| cloud.point(i)).collect();
    let floor = jrdb_calibration::fit_floor(&points, config).ok()?;
    let [x, y, z] = floor.normal;
    Some(FloorPlane { height_m: floor.height_m, slope: [-x / z, -y / z] })
}

#[cfg(test)]
mod tests {
    use super::*;
    use jrdb_types::{FrameId, ImageGeometry, PixelBox};

    fn detection(number: u32, score: f64) -> Detection {
        let bbox = PixelBox::from([0.0, 0.0, 5.0, 5.0]);
        Detection::new(EntityId::new("person", number), "person", score, bbox)
    }

    #[test]
    fn the_most_confident_detections_are_kept_and_an_issue_says_so() {
        let scores = [0.2, 0.9, 0.5, 0.9];
        let found = Detections {
            frame: FrameId::default(),
            image: ImageGeometry { width_px: 100, height_px: 50, wraps: true },
            detections: (1..).zip(scores).map(|(number, score)| detection(number, score)).collect(),
            capabilities: None,
            issues: Vec::new(),
        };
        assert_eq!(most_confident(found.clone(), 4), found);
        let kept = most_confident(found, 3);
        let ids: Vec<u32> = kept.detections.iter().map(|one| one.id.number).collect();
        assert_eq!(ids, [2, 3, 4]);
        assert!(kept.issues[0].message.contains("found 4: the 3 most confident are used"));
    }
}
