//! The stage: entities and relations in, a flat graph out.

use jrdb_types::vocab::{Occlusion, PairWord};
use jrdb_types::{
    DistanceWord, Edge, EdgeRelation, Entities, Entity, Node, PairRelation, SceneGraph,
    SpatialRelation,
};
use serde::{Deserialize, Serialize};

/// Which pairs get a spatial edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Pairs {
    /// Every pair.
    #[default]
    All,
    /// Pairs at most 1.5 m apart ("close" and "very close"), as the benchmark builds its graphs.
    Close,
}

/// What happens to people whom others hide.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Hidden {
    /// They are nodes like others.
    #[default]
    Keep,
    /// Severely and fully occluded ones are no nodes, as in the benchmark; their edges stay.
    LeaveOut,
}

/// Configuration of [`build`]. It is written into the artefact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct GraphConfig {
    /// Which pairs get a spatial edge.
    pub pairs: Pairs,
    /// What happens to people whom others hide.
    pub hidden: Hidden,
}

/// Builds the scene graph of one frame: nodes sorted by id, edges by their ends.
#[must_use]
pub fn build(entities: &Entities, config: &GraphConfig) -> SceneGraph {
    let visible = |entity: &&Entity| config.hidden == Hidden::Keep || !is_hidden(entity);
    let mut nodes: Vec<Node> = entities.entities.iter().filter(visible).map(node).collect();
    nodes.sort_by(|a, b| a.id.cmp(&b.id));
    let close = |relation: &SpatialRelation| {
        config.pairs == Pairs::All
            || relation.distance.is_some_and(|word| word <= DistanceWord::Close)
    };
    let pairs = entities.relations.iter().filter(|pair| close(&pair.relation));
    let spatial = pairs.flat_map(|pair| {
        let edge =
            |relation| Edge { from: pair.subject.clone(), to: pair.object.clone(), relation };
        let words =
            pair.words.iter().map(|&word| EdgeRelation::Pair { word, value: value(pair, word) });
        std::iter::once(EdgeRelation::Spatial(pair.relation)).chain(words).map(edge)
    });
    let interactions = entities.entities.iter().flat_map(|entity| {
        entity.interactions.iter().map(|interaction| Edge {
            from: entity.id.clone(),
            to: interaction.partner.clone(),
            relation: EdgeRelation::Interaction { label: interaction.label.clone() },
        })
    });
    let mut edges: Vec<Edge> = spatial.chain(interactions).collect();
    // Stable: of one pair, the spatial edge stays first and the interactions last.
    edges.sort_by(|a, b| (&a.from, &a.to).cmp(&(&b.from, &b.to)));
    let (frame, issues) = (entities.frame.clone(), entities.issues.clone());
    let between = entities.between.clone();
    let (lateral, capabilities) = (entities.lateral, entities.capabilities.clone());
    SceneGraph { frame, lateral, nodes, edges, between, capabilities, issues }
}

/// The number behind a word of a pair.
fn value(pair: &PairRelation, word: PairWord) -> Option<f64> {
    match word {
        PairWord::Adjacent => pair.gap_m,
        PairWord::Overlapping => pair.overlap,
        PairWord::Hides => pair.hides.map(|hides| hides.image_fraction),
        _ => None,
    }
}

fn is_hidden(entity: &Entity) -> bool {
    matches!(entity.occlusion, Some(Occlusion::SeverelyOccluded | Occlusion::FullyOccluded))
}

fn node(entity: &Entity) -> Node {
    Node {
        id: entity.id.clone(),
        category: entity.category.clone(),
        score: entity.score,
        bbox: entity.bbox,
        attributes: entity.attributes.clone(),
        center: entity.position.map(|position| position.center),
        heading_rad: entity.heading.map(|heading| heading.angle_rad),
        height_m: entity.box3d.map(|box3d| box3d.size[2]),
        velocity_mps: entity.velocity_mps,
        group: entity.group,
        from_robot: entity.from_robot,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use jrdb_types::detection::Interaction;
    use jrdb_types::{EntityId, FrameId, LateralConvention, PixelBox};

    fn person(number: u32, occlusion: Option<Occlusion>) -> Entity {
        Entity {
            id: EntityId::new("pedestrian", number),
            category: "person".into(),
            score: 1.0,
            bbox: PixelBox::from([0.0, 0.0, 1.0, 1.0]),
            attributes: Default::default(),
            interactions: Vec::new(),
            occlusion,
            position: None,
            box3d: None,
            group: None,
            heading: None,
            velocity_mps: None,
            floor: None,
            from_robot: None,
        }
    }

    fn pair(subject: u32, object: u32, distance: DistanceWord) -> PairRelation {
        let relation = SpatialRelation { distance: Some(distance), ..SpatialRelation::default() };
        let id = |n| EntityId::new("pedestrian", n);
        PairRelation::of(id(subject), id(object), relation)
    }

    fn scene() -> Entities {
        let mut second = person(2, None);
        second.interactions = vec![Interaction {
            partner: EntityId::new("pedestrian", 1),
            label: "conversation".into(),
        }];
        Entities {
            frame: FrameId::default(),
            lateral: LateralConvention::Physical,
            entities: vec![second, person(1, Some(Occlusion::FullyOccluded)), person(3, None)],
            relations: vec![pair(2, 1, DistanceWord::Close), pair(1, 3, DistanceWord::Far)],
            between: Vec::new(),
            capabilities: None,
            issues: Vec::new(),
        }
    }

    fn edges(graph: &SceneGraph) -> Vec<(u32, u32, &'static str)> {
        let kind = |relation: &EdgeRelation| match relation {
            EdgeRelation::Spatial(_) => "spatial",
            EdgeRelation::Pair { word, .. } => word.word(),
            EdgeRelation::Interaction { .. } => "interaction",
        };
        graph.edges.iter().map(|e| (e.from.number, e.to.number, kind(&e.relation))).collect()
    }

    #[test]
    fn everything_is_kept_and_sorted() {
        let graph = build(&scene(), &GraphConfig::default());
        assert_eq!(graph.nodes.iter().map(|n| n.id.number).collect::<Vec<_>>(), [1, 2, 3]);
        assert_eq!(edges(&graph), [(1, 3, "spatial"), (2, 1, "spatial"), (2, 1, "interaction")]);
    }

    #[test]
    fn a_pair_of_unknown_distance_is_not_close() {
        let mut scene = scene();
        scene.relations[0].relation.distance = None;
        let config = GraphConfig { pairs: Pairs::Close, hidden: Hidden::Keep };
        assert_eq!(edges(&build(&scene, &config)), [(2, 1, "interaction")]);
    }

    #[test]
    fn words_of_a_pair_are_edges_with_their_number_between_spatial_and_interaction() {
        let mut scene = scene();
        scene.relations[0].words = vec![PairWord::Adjacent, PairWord::Facing];
        scene.relations[0].gap_m = Some(0.25);
        let graph = build(&scene, &GraphConfig::default());
        let kinds = ["spatial", "next to", "facing", "interaction"];
        assert_eq!(edges(&graph)[1..], kinds.map(|kind| (2, 1, kind)));
        let next_to = EdgeRelation::Pair { word: PairWord::Adjacent, value: Some(0.25) };
        assert_eq!(graph.edges[2].relation, next_to);
    }

    #[test]
    fn the_benchmark_leaves_out_hidden_nodes_and_far_pairs_but_not_edges_of_the_hidden() {
        let config = GraphConfig { pairs: Pairs::Close, hidden: Hidden::LeaveOut };
        let graph = build(&scene(), &config);
        assert_eq!(graph.nodes.len(), 2);
        assert_eq!(edges(&graph), [(2, 1, "spatial"), (2, 1, "interaction")]);
    }
}
