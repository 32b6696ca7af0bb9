//! A scene graph that can be walked.

use std::collections::BTreeMap;

use jrdb_types::{EdgeRelation, EntityId, Node, SceneGraph};
use petgraph::Direction;
use petgraph::graph::{DiGraph, EdgeIndex, NodeIndex};
use petgraph::visit::EdgeRef;

/// What lies at the other end of an edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neighbor<'a> {
    /// The other end.
    pub id: &'a EntityId,
    /// Its node; absent when the graph has an edge to something it does not describe.
    pub node: Option<&'a Node>,
    /// What the edge says.
    pub relation: &'a EdgeRelation,
}

/// Adjacency over a borrowed [`SceneGraph`]. Building costs one pass over nodes and edges, a
/// neighbourhood costs its size.
#[derive(Debug)]
pub struct GraphIndex<'a> {
    scene: &'a SceneGraph,
    graph: DiGraph<(&'a EntityId, Option<&'a Node>), &'a EdgeRelation>,
    by_id: BTreeMap<&'a EntityId, NodeIndex>,
}

impl<'a> GraphIndex<'a> {
    /// Indexes a graph. Ends of edges that are no nodes are known by their id only.
    #[must_use]
    pub fn new(scene: &'a SceneGraph) -> Self {
        let mut graph = DiGraph::with_capacity(scene.nodes.len(), scene.edges.len());
        let mut by_id = BTreeMap::new();
        for node in &scene.nodes {
            by_id.insert(&node.id, graph.add_node((&node.id, Some(node))));
        }
        for edge in &scene.edges {
            let [from, to] = [&edge.from, &edge.to]
                .map(|id| *by_id.entry(id).or_insert_with(|| graph.add_node((id, None))));
            graph.add_edge(from, to, &edge.relation);
        }
        Self { scene, graph, by_id }
    }

    /// The graph's nodes, sorted by id as built.
    #[must_use]
    pub fn nodes(&self) -> &'a [Node] {
        &self.scene.nodes
    }

    /// What the edges from `id` lead to, in the order of the flat list.
    #[must_use]
    pub fn outgoing(&self, id: &EntityId) -> Vec<Neighbor<'a>> {
        self.neighbors(id, Direction::Outgoing)
    }

    /// Where the edges to `id` come from, in the order of the flat list.
    #[must_use]
    pub fn incoming(&self, id: &EntityId) -> Vec<Neighbor<'a>> {
        self.neighbors(id, Direction::Incoming)
    }

    fn neighbors(&self, id: &EntityId, direction: Direction) -> Vec<Neighbor<'a>> {
        let Some(&index) = self.by_id.get(id) else { return Vec::new() };
        let mut edges: Vec<(EdgeIndex, NodeIndex)> = self
            .graph
            .edges_directed(index, direction)
            .map(|edge| match direction {
                Direction::Outgoing => (edge.id(), edge.target()),
                Direction::Incoming => (edge.id(), edge.source()),
            })
            .collect();
        edges.sort_unstable();
        edges
            .into_iter()
            .map(|(edge, end)| {
                let (id, node) = self.graph[end];
                Neighbor { id, node, relation: self.graph[edge] }
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use jrdb_types::{Edge, FrameId, LateralConvention};

    fn id(number: u32) -> EntityId {
        EntityId::new("pedestrian", number)
    }

    fn edge(from: u32, to: u32, label: &str) -> Edge {
        let relation = EdgeRelation::Interaction { label: label.into() };
        Edge { from: id(from), to: id(to), relation }
    }

    #[test]
    fn neighbours_come_in_the_order_of_the_list_in_both_directions() {
        let graph = SceneGraph {
            frame: FrameId::default(),
            lateral: LateralConvention::Physical,
            nodes: Vec::new(),
            edges: vec![edge(1, 2, "hugging"), edge(1, 3, "hugging"), edge(3, 2, "conversation")],
            issues: Vec::new(),
        };
        let index = GraphIndex::new(&graph);
        let numbers =
            |found: Vec<Neighbor<'_>>| found.iter().map(|n| n.id.number).collect::<Vec<_>>();
        assert_eq!(numbers(index.outgoing(&id(1))), [2, 3]);
        assert_eq!(numbers(index.incoming(&id(2))), [1, 3]);
        assert!(index.outgoing(&id(9)).is_empty());
        assert!(index.outgoing(&id(1))[0].node.is_none());
    }
}
