//! What the labels of a study's frames say: where people are and how well they can be seen.

use std::collections::BTreeMap;
use std::sync::Arc;

use jrdb_models::PerceptionSource;
use jrdb_models::demographics::Demographics;
use jrdb_models::loader::EngineOptions;
use jrdb_perception::Perceive;
use jrdb_pipeline::{Pipeline, PipelineConfig, Scene};
use jrdb_types::detection::PERSON;
use jrdb_types::vocab::Occlusion;
use jrdb_types::{FrameId, Localizer, PixelBox};
use rayon::prelude::*;

use crate::source::{FrameSource, open_perception};

/// A person as labelled.
pub(super) struct PersonFacts {
    /// Where in the image, pixels.
    pub(super) bbox: PixelBox,
    /// Distance from the robot over the ground, metres; absent without a labelled place.
    pub(super) range_m: Option<f64>,
    /// How much of the person others hide, where the labels say so.
    pub(super) occlusion: Option<Occlusion>,
    /// LiDAR points in the box in the image; absent where the person has no place.
    pub(super) points: Option<usize>,
}

/// The people of each frame, as far as frames are labelled.
pub(super) type Facts = BTreeMap<FrameId, Vec<PersonFacts>>;

/// The labels of frames; none where the data has none.
pub(super) struct Truth {
    labels: Option<Arc<dyn Perceive>>,
    config: Arc<PipelineConfig>,
}

impl Truth {
    pub(super) fn open(frames: &[FrameSource], engine: &EngineOptions) -> Self {
        let opened =
            open_perception(&PerceptionSource::Labels, frames, engine, Demographics::default());
        let labels = opened.ok().map(|labels| Arc::new(labels) as Arc<dyn Perceive>);
        let mut config = PipelineConfig::default();
        config.projection.localizer = Localizer::Given;
        Self { labels, config: Arc::new(config) }
    }

    /// A frame as its labels have it; none where it has no labels.
    pub(super) fn scene(&self, frame: &FrameSource) -> Option<Scene> {
        let labels = self.labels.clone()?;
        let pipeline = Pipeline::sharing(frame.robot.clone(), labels, self.config.clone());
        let scene = pipeline.see(frame.read()).ok()?;
        (!scene.detections().detections.is_empty()).then_some(scene)
    }

    /// What the labels say of the people in these frames.
    pub(super) fn facts(&self, frames: &[&FrameSource]) -> Facts {
        let one = |frame: &&FrameSource| Some((frame.id.clone(), people(&self.scene(frame)?)));
        frames.par_iter().filter_map(one).collect()
    }
}

/// The frames of a study by name, and their labels.
pub(super) struct Labelled<'s> {
    pub(super) frames: BTreeMap<&'s FrameId, &'s FrameSource>,
    pub(super) truth: &'s Truth,
}

fn people(scene: &Scene) -> Vec<PersonFacts> {
    let people = scene.entities().entities.iter().filter(|one| one.category == PERSON);
    let facts = people.map(|one| {
        let place = one.position.as_ref();
        PersonFacts {
            bbox: one.bbox,
            range_m: place.map(|place| place.center[0].hypot(place.center[1])),
            occlusion: one.occlusion,
            points: place.map(|place| place.points_in_box),
        }
    });
    facts.collect()
}
