//! The scene graph as a graph of petgraph's, for what its algorithms do best.

use std::collections::BTreeMap;

use jrdb_types::{Edge, EdgeRelation, EntityId, Node, SceneGraph};
use petgraph::algo::astar;
use petgraph::graph::{DiGraph, NodeIndex};
use petgraph::unionfind::UnionFind;
use petgraph::visit::EdgeRef;

/// A scene graph whose nodes and edges are those of petgraph.
pub type Network<'g> = DiGraph<&'g Node, &'g Edge>;

/// The scene graph as a petgraph graph, to be used with any of its algorithms.
///
/// Nodes have the indices of their places in [`SceneGraph::nodes`]; edges keep their order. Edges from or to things that are
/// not nodes are left out.
///
/// ```
/// use jrdb_graph::{GraphConfig, as_petgraph, build};
/// # use jrdb_types::{Entities, FrameId, LateralConvention};
/// # let entities = Entities::new(FrameId::default(), LateralConvention::Physical);
/// let graph = build(&entities, &GraphConfig::default());
/// let network = as_petgraph(&graph);
/// assert_eq!(network.node_count(), graph.nodes.len());
/// ```
#[must_use]
pub fn as_petgraph(scene: &SceneGraph) -> Network<'_> {
    let mut network = DiGraph::with_capacity(scene.nodes.len(), scene.edges.len());
    let places: BTreeMap<&EntityId, NodeIndex> =
        scene.nodes.iter().map(|node| (&node.id, network.add_node(node))).collect();
    for edge in &scene.edges {
        if let (Some(&from), Some(&to)) = (places.get(&edge.from), places.get(&edge.to)) {
            network.add_edge(from, to, edge);
        }
    }
    network
}

/// The connected components of the things that some relations join, in either direction: groups.
///
/// `joins` decides which relations join. Every node is in one group, alone if nothing joins it. Groups are sorted by
/// their first member, members by id.
#[must_use]
pub fn groups(scene: &SceneGraph, joins: impl Fn(&EdgeRelation) -> bool) -> Vec<Vec<&EntityId>> {
    let network = as_petgraph(scene);
    let mut sets = UnionFind::new(network.node_count());
    for edge in network.edge_references().filter(|edge| joins(&edge.weight().relation)) {
        sets.union(edge.source().index(), edge.target().index());
    }
    let mut groups: BTreeMap<usize, Vec<&EntityId>> = BTreeMap::new();
    for (node, set) in network.node_weights().zip(sets.into_labeling()) {
        groups.entry(set).or_default().push(&node.id);
    }
    let mut groups: Vec<Vec<&EntityId>> = groups.into_values().collect();
    groups.iter_mut().for_each(|group| group.sort());
    groups.sort();
    groups
}

/// The chain of relations from one thing to another with the least cost in all: how they are connected.
///
/// `cost` gives what a step along a relation costs, at least 0; a relation without a cost is not walked. `None` when no chain
/// leads there, or one of the two is not a node; empty when both are the same.
///
/// ```
/// use jrdb_graph::{chain, metres_within};
/// # use jrdb_types::{EntityId, FrameId, LateralConvention, SceneGraph};
/// # let graph = SceneGraph::new(FrameId::default(), LateralConvention::Physical, Vec::new());
/// # let (first, second) = (EntityId::new("pedestrian", 1), EntityId::new("pedestrian", 2));
/// let chain = chain(&graph, &first, &second, metres_within(1.5));
/// assert_eq!(chain, None);
/// ```
#[must_use]
pub fn chain<'g>(
    scene: &'g SceneGraph,
    from: &EntityId,
    to: &EntityId,
    cost: impl Fn(&EdgeRelation) -> Option<f64>,
) -> Option<Vec<&'g Edge>> {
    let network = as_petgraph(scene);
    let place = |id: &EntityId| network.node_indices().find(|&place| network[place].id == *id);
    let (from, to) = (place(from)?, place(to)?);
    let step = |edge: &Edge| cost(&edge.relation).filter(|cost| *cost >= 0.0);
    let walkable =
        network.filter_map(|_, node| Some(*node), |_, edge| step(edge).map(|c| (*edge, c)));
    let (_, nodes) = astar(&walkable, from, |node| node == to, |edge| edge.weight().1, |_| 0.0)?;
    let cheapest = |pair: &[NodeIndex]| {
        let between = walkable.edges_connecting(pair[0], pair[1]);
        between.map(|edge| *edge.weight()).min_by(|a, b| a.1.total_cmp(&b.1)).map(|(edge, _)| edge)
    };
    nodes.windows(2).map(cheapest).collect()
}

/// The cost of steps in metres: places at most so far away, and interactions, which cost nothing.
pub fn metres_within(limit_m: f64) -> impl Fn(&EdgeRelation) -> Option<f64> {
    move |relation| match relation {
        EdgeRelation::Spatial(place) => place.distance_m.filter(|metres| *metres <= limit_m),
        EdgeRelation::Interaction { .. } => Some(0.0),
        EdgeRelation::Pair { .. } => None,
    }
}

/// The scene graph in the DOT language of Graphviz: interactions, and places at most `limit_m` metres away.
///
/// Equal graphs give equal text.
#[must_use]
pub fn dot(scene: &SceneGraph, limit_m: f64) -> String {
    let network = as_petgraph(scene);
    let is_shown = metres_within(limit_m);
    let mut text = String::from("digraph scene {\n");
    for place in network.node_indices() {
        let node = network[place];
        let label = escaped(&format!("{} {}", node.id.short(), node.category));
        text += &format!("    {} [label=\"{label}\"];\n", place.index());
    }
    let shown = network.edge_references().filter(|e| is_shown(&e.weight().relation).is_some());
    for edge in shown {
        let (from, to) = (edge.source().index(), edge.target().index());
        let label = escaped(&relation_label(&edge.weight().relation));
        text += &format!("    {from} -> {to} [label=\"{label}\"];\n");
    }
    text + "}\n"
}

fn relation_label(relation: &EdgeRelation) -> String {
    match relation {
        EdgeRelation::Spatial(place) => {
            let direction = place.direction.map(|word| word.to_string());
            let metres = place.distance_m.map(|metres| format!("{metres:.2} m"));
            direction.into_iter().chain(metres).collect::<Vec<_>>().join(", ")
        }
        EdgeRelation::Interaction { label } => label.clone(),
        EdgeRelation::Pair { .. } => String::new(),
    }
}

fn escaped(text: &str) -> String {
    text.replace('\\', "\\\\").replace('"', "\\\"")
}

#[cfg(test)]
mod tests {
    use super::*;
    use jrdb_types::{FrameId, LateralConvention, PixelBox, SpatialRelation};

    fn id(number: u32) -> EntityId {
        EntityId::new("pedestrian", number)
    }

    fn apart(from: u32, to: u32, metres: f64) -> Edge {
        let place = SpatialRelation { distance_m: Some(metres), ..SpatialRelation::default() };
        Edge { from: id(from), to: id(to), relation: EdgeRelation::Spatial(place) }
    }

    /// Four people in a row, 1 m, 1 m and 3 m apart; the first talks to the last.
    fn row() -> SceneGraph {
        let bbox = PixelBox::from([0.0, 0.0, 9.0, 9.0]);
        let nodes = (1..=4).map(|number| Node::new(id(number), "person", bbox)).collect();
        let mut scene = SceneGraph::new(FrameId::default(), LateralConvention::Physical, nodes);
        scene.edges = vec![
            apart(1, 2, 1.0),
            apart(1, 3, 2.0),
            apart(2, 3, 1.0),
            apart(3, 4, 3.0),
            apart(3, 9, 0.1),
        ];
        scene
    }

    #[test]
    fn groups_are_what_near_relations_join() {
        let near = |limit_m: f64| {
            let cost = metres_within(limit_m);
            move |relation: &EdgeRelation| cost(relation).is_some()
        };
        let scene = row();
        let sizes =
            |limit_m| groups(&scene, near(limit_m)).iter().map(Vec::len).collect::<Vec<_>>();
        assert_eq!((sizes(0.5), sizes(1.5), sizes(5.0)), (vec![1; 4], vec![3, 1], vec![4]));
    }

    #[test]
    fn a_chain_takes_the_cheapest_way_along_the_edges() {
        let scene = row();
        let steps = |limit_m| {
            let edges = chain(&scene, &id(1), &id(4), metres_within(limit_m))?;
            Some(edges.iter().map(|edge| edge.to.number).collect::<Vec<_>>())
        };
        assert_eq!(steps(5.0), Some(vec![3, 4]));
        assert_eq!(steps(1.5), None);
        assert_eq!(
            chain(&scene, &id(4), &id(1), metres_within(9.0)),
            None,
            "edges have directions"
        );
        assert_eq!(chain(&scene, &id(2), &id(2), metres_within(9.0)), Some(Vec::new()));
        assert_eq!(chain(&scene, &id(2), &id(9), metres_within(9.0)), None, "not a node");
    }

    #[test]
    fn dot_shows_near_edges_and_escapes_labels() {
        let mut scene = row();
        let relation = EdgeRelation::Interaction { label: "saying \"hi\"".into() };
        scene.edges.push(Edge { from: id(1), to: id(4), relation });
        let text = dot(&scene, 1.5);
        assert!(text.starts_with("digraph scene {\n    0 [label=\"#1 person\"];\n"), "{text}");
        assert!(text.contains("0 -> 1 [label=\"1.00 m\"];") && !text.contains("2 -> 3"), "{text}");
        assert!(text.contains(r#"0 -> 3 [label="saying \"hi\""];"#), "{text}");
    }
}
