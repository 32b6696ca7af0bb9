//! Several frames of one recording, for questions about time.

use std::sync::{Arc, OnceLock};

use jrdb_search::Pooling;
use jrdb_types::{Answer, Query, SceneGraph};

use crate::query::read_query;
use crate::{Error, PipelineConfig, Scene};

/// The frames of a recording, in the order of time. Only their graphs are kept.
#[derive(Default)]
pub struct Recording {
    graphs: Vec<SceneGraph>,
    /// The graphs as the benchmark's engine has them, made by the first question that needs them.
    timeless: OnceLock<Vec<SceneGraph>>,
    config: Option<Arc<PipelineConfig>>,
}

impl Recording {
    /// A recording without frames.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds the next frame.
    pub fn push(&mut self, scene: Scene) {
        self.add(Arc::clone(&scene.config), scene.into_graph());
    }

    /// Adds the next frame and leaves the scene to others.
    pub fn push_graph_of(&mut self, scene: &Scene) {
        self.add(Arc::clone(&scene.config), scene.graph().clone());
    }

    fn add(&mut self, config: Arc<PipelineConfig>, graph: SceneGraph) {
        self.config = Some(config);
        self.graphs.push(graph);
        self.timeless = OnceLock::new();
    }

    /// How many frames there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.graphs.len()
    }

    /// Whether there is no frame.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.graphs.is_empty()
    }

    /// Answers a question that may speak of time: "who sits down and then walks?".
    ///
    /// # Errors
    /// As [`Scene::ask`].
    pub fn ask(&self, question: &str) -> Result<Answer, Error> {
        let config = self.config();
        Ok(self.ask_query(&read_query(question, &config.parser)?, &[]))
    }

    /// Answers a question that was read already. `slots` gives the numbers of the frames that each moment of the question
    /// may be in; where it is empty the question's own times count.
    #[must_use]
    pub fn ask_query(&self, query: &Query, slots: &[Vec<u32>]) -> Answer {
        let config = self.config();
        let at = |number: &u32| self.graphs.iter().position(|g| g.frame.frame == *number);
        let slots: Vec<Vec<usize>> =
            slots.iter().map(|frames| frames.iter().filter_map(at).collect()).collect();
        let slots = (!slots.is_empty()).then_some(slots.as_slice());
        let graphs = match config.search.pooling {
            Pooling::PerCondition => self.timeless(),
            _ => &self.graphs,
        };
        jrdb_search::search_frames(graphs, slots, query, &config.search)
    }

    /// The benchmark's engine has edges that carry no frame.
    fn timeless(&self) -> &[SceneGraph] {
        self.timeless.get_or_init(|| {
            let mut timeless = self.graphs.clone();
            jrdb_graph::make_timeless(&mut timeless);
            timeless
        })
    }

    fn config(&self) -> Arc<PipelineConfig> {
        self.config.clone().unwrap_or_default()
    }
}
