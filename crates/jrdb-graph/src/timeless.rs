//! Edges without time, as the benchmark's engine has them.

use jrdb_types::{Edge, EdgeRelation, SceneGraph};

/// Gives every frame of a recording the edges of all frames: what two people did once, they do always.
///
/// That is what JRDB-Reasoning's engine does, whose edges carry no frame, and its answers depend on it. Edges are sorted by their ends,
/// equal ones stay once; of things that a frame does not show they stay, too.
///
/// ```
/// use jrdb_types::{Edge, EdgeRelation, EntityId, FrameId, LateralConvention, SceneGraph};
/// let id = |number| EntityId::new("pedestrian", number);
/// let relation = EdgeRelation::Interaction { label: "hugging".into() };
/// let mut then = SceneGraph::new(FrameId::default(), LateralConvention::Physical, vec![]);
/// then.edges = vec![Edge { from: id(1), to: id(2), relation }];
/// let mut recording = [then.clone(), SceneGraph { edges: vec![], ..then }];
/// jrdb_graph::make_timeless(&mut recording);
/// assert_eq!(recording[1].edges, recording[0].edges);
/// ```
pub fn make_timeless(frames: &mut [SceneGraph]) {
    let mut all: Vec<Edge> = frames.iter().flat_map(|frame| frame.edges.iter().cloned()).collect();
    // Stable: what one pair is to each other stays in the order of the frames within each kind.
    all.sort_by(|a, b| (&a.from, &a.to, kind(a)).cmp(&(&b.from, &b.to, kind(b))));
    all.dedup();
    for frame in frames {
        frame.edges.clone_from(&all);
    }
}

/// Spatial edges before words of the pair before interactions, as in every graph.
fn kind(edge: &Edge) -> u8 {
    match edge.relation {
        EdgeRelation::Spatial(_) => 0,
        EdgeRelation::Pair { .. } => 1,
        EdgeRelation::Interaction { .. } => 2,
    }
}
