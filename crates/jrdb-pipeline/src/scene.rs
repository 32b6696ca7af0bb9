//! A frame that was seen, and can be asked.

use std::sync::Arc;

use jrdb_graph::IndexedGraph;
use jrdb_perception::Perceive;
use jrdb_projection::BaseCloud;
use jrdb_types::{Answer, Detections, Entities, FrameId, Image, Query, SceneGraph};

use crate::looks::Eyes;
use crate::query::read_query;
use crate::{Error, Frame, PipelineConfig};

/// A frame that was seen: entities in 3D, their relations, and an index over them.
///
/// Asking changes nothing and costs microseconds. The scene keeps the frame's image and what perceived it, so that
/// perception can be asked again about a crop.
pub struct Scene {
    pub(crate) perception: Arc<dyn Perceive>,
    pub(crate) config: Arc<PipelineConfig>,
    pub(crate) frame: Frame,
    pub(crate) detections: Detections,
    pub(crate) cloud: BaseCloud,
    pub(crate) entities: Entities,
    pub(crate) graph: IndexedGraph,
}

impl Scene {
    /// Answers a question in English, or in the notation of the query algebra.
    ///
    /// # Errors
    /// [`Error::Query`] for a text of which nothing is understood, and for notation that does not fit together.
    pub fn ask(&self, question: &str) -> Result<Answer, Error> {
        Ok(self.ask_query(&read_query(question, &self.config().parser)?))
    }

    /// Answers a question that was read already.
    #[must_use]
    pub fn ask_query(&self, query: &Query) -> Answer {
        let config = self.config();
        let mut answer = match Eyes::of(self.perception(), &self.frame, &self.detections) {
            Some(eyes) => self.ask_seeing(query, eyes),
            None => jrdb_search::search_indexed(&self.graph.index(), query, &config.search),
        };
        if config.sensitivity {
            answer.sensitivity = jrdb_search::sensitivity(self.graph(), query, &config.search);
        }
        answer
    }

    /// Answers a question with somebody who can look at crops.
    fn ask_seeing(&self, query: &Query, eyes: Eyes<'_>) -> Answer {
        let (index, config) = (self.graph.index(), &self.config().search);
        let mut answer = jrdb_search::search_with(&index, query, config, &eyes);
        answer.issues.extend(eyes.into_failures());
        answer
    }

    /// Which frame it is.
    #[must_use]
    pub fn id(&self) -> &FrameId {
        &self.frame.id
    }

    /// The frame's images and sweeps.
    #[must_use]
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// The pixels of the image, decoded now if they have not been; `None` when there are none.
    #[must_use]
    pub fn image(&self) -> Option<&Image> {
        self.frame.pixels()
    }

    /// All sweeps in the base frame.
    #[must_use]
    pub fn cloud(&self) -> &BaseCloud {
        &self.cloud
    }

    /// What perception found.
    #[must_use]
    pub fn detections(&self) -> &Detections {
        &self.detections
    }

    /// People and objects in space, with their relations.
    #[must_use]
    pub fn entities(&self) -> &Entities {
        &self.entities
    }

    /// The scene graph.
    #[must_use]
    pub fn graph(&self) -> &SceneGraph {
        self.graph.graph()
    }

    /// The scene graph with its index.
    #[must_use]
    pub fn indexed_graph(&self) -> &IndexedGraph {
        &self.graph
    }

    /// The scene graph alone; everything else is given up.
    #[must_use]
    pub fn into_graph(self) -> SceneGraph {
        self.graph.into_graph()
    }

    /// What perceived the scene.
    #[must_use]
    pub fn perception(&self) -> &dyn Perceive {
        &*self.perception
    }

    /// How the stages work.
    #[must_use]
    pub fn config(&self) -> &PipelineConfig {
        &self.config
    }
}
