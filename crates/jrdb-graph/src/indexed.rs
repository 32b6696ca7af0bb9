//! A scene graph together with its index, for many questions about one frame.

use std::sync::Arc;

use jrdb_types::SceneGraph;

use crate::index::{GraphIndex, Tables};

/// A scene graph that is indexed once and may be searched any number of times.
///
/// ```
/// use jrdb_graph::IndexedGraph;
/// use jrdb_types::{FrameId, LateralConvention, SceneGraph};
/// # let graph = SceneGraph::new(FrameId::default(), LateralConvention::Physical, vec![]);
/// let graph = IndexedGraph::new(graph);
/// assert_eq!(graph.index().node_count(), graph.graph().nodes.len());
/// ```
#[derive(Debug)]
pub struct IndexedGraph {
    graph: SceneGraph,
    tables: Arc<Tables>,
}

impl IndexedGraph {
    /// Indexes a graph.
    #[must_use]
    pub fn new(graph: SceneGraph) -> Self {
        let tables = GraphIndex::new(&graph).into_tables();
        Self { graph, tables }
    }

    /// The graph.
    #[must_use]
    pub fn graph(&self) -> &SceneGraph {
        &self.graph
    }

    /// The graph without its index.
    #[must_use]
    pub fn into_graph(self) -> SceneGraph {
        self.graph
    }

    /// The index; it costs nothing to obtain.
    #[must_use]
    pub fn index(&self) -> GraphIndex<'_> {
        GraphIndex::over(&self.graph, Arc::clone(&self.tables))
    }
}
