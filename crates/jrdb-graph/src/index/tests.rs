//! The index of small graphs.

use jrdb_types::vocab::Sector;
use jrdb_types::{Attributes, Edge, FrameId, Gender, LateralConvention, PixelBox};

use super::*;

fn id(number: u32) -> EntityId {
    EntityId::new("pedestrian", number)
}

fn node(id: EntityId, gender: Option<Gender>) -> Node {
    Node {
        id,
        category: "person".into(),
        score: 1.0,
        bbox: PixelBox::from([0.0, 0.0, 1.0, 1.0]),
        attributes: Attributes::certain(gender.map(Into::into)),
        center: None,
        heading_rad: None,
        height_m: None,
        velocity_mps: None,
        group: None,
        from_robot: None,
    }
}

fn sees(from: u32, to: u32, sector: Sector, distance: DistanceWord) -> Edge {
    let relation = SpatialRelation {
        direction: Some(Direction::level(sector)),
        distance: Some(distance),
        ..SpatialRelation::default()
    };
    Edge { from: id(from), to: id(to), relation: EdgeRelation::Spatial(relation) }
}

/// Three people of whom the third is no node, all to the left of the first.
fn scene() -> SceneGraph {
    SceneGraph {
        frame: FrameId::default(),
        lateral: LateralConvention::Physical,
        nodes: vec![node(id(1), Some(Gender::Male)), node(id(7), None)],
        edges: vec![
            sees(1, 3, Sector::Left, DistanceWord::Close),
            sees(1, 7, Sector::Left, DistanceWord::Far),
            sees(3, 7, Sector::Back, DistanceWord::Close),
            sees(7, 7, Sector::Back, DistanceWord::Close),
        ],
        between: Vec::new(),
        capabilities: Some(Capabilities::open()),
        issues: Vec::new(),
    }
}

#[test]
fn ends_that_are_no_nodes_follow_the_nodes() {
    let scene = scene();
    let index = GraphIndex::new(&scene);
    assert_eq!((index.node_count(), index.size()), (2, 3));
    assert_eq!(index.number(&id(3)), Some(2));
    assert_eq!((index.id(2), index.node(2)), (Some(&id(3)), None));
    assert_eq!((index.number(&id(4)), index.id(3)), (None, None));
    assert!(index.columns().people().contains(2));
}

#[test]
fn rows_lead_both_ways_and_leave_out_loops() {
    let scene = scene();
    let index = GraphIndex::new(&scene);
    assert_eq!(index.outgoing(0).others, [1, 2]);
    assert_eq!(index.incoming(1).others, [0, 2]);
    assert_eq!(index.outgoing(1).others, [0_u32; 0]);
    assert_eq!(index.outgoing(0).with(2).edges, [0]);
    assert!(index.outgoing(0).with(0).others.is_empty());
}

#[test]
fn runs_are_by_direction_and_distance() {
    let scene = scene();
    let index = GraphIndex::new(&scene);
    let left = Direction::level(Sector::Left);
    assert_eq!(index.seen(0, left, None), [2, 1]);
    assert_eq!(index.seen(0, left, Some(DistanceWord::Far)), [1]);
    assert_eq!(index.seen(1, left, None), [0_u32; 0]);
    assert_eq!(index.seen(99, left, None), [0_u32; 0]);
}

#[test]
fn sets_hold_those_with_the_value_and_those_with_any() {
    let scene = scene();
    let index = GraphIndex::new(&scene);
    let (male, known) = index.columns().attribute(Gender::Male.into());
    assert_eq!((male, known.count()), (known, 1));
    assert!(index.columns().attribute(Gender::Female.into()).0.is_empty());
}

#[test]
fn the_order_of_the_lists_does_not_matter() {
    let (sorted, mut turned) = (scene(), scene());
    turned.nodes.reverse();
    turned.edges.reverse();
    let (sorted, turned) = (GraphIndex::new(&sorted), GraphIndex::new(&turned));
    assert_eq!(sorted.columns(), turned.columns());
    for number in 0..3 {
        assert_eq!(sorted.id(number), turned.id(number));
        assert_eq!(sorted.outgoing(number).others, turned.outgoing(number).others);
        assert_eq!(sorted.incoming(number).others, turned.incoming(number).others);
    }
}

#[test]
fn ids_are_found_by_table_and_by_search() {
    let mut scene = scene();
    scene.edges.clear();
    scene.nodes =
        [5, 6, 9, 4_000_000_000].map(|number| node(id(number), None)).into_iter().collect();
    scene.nodes.push(node(EntityId::new("table", 3), None));
    let index = GraphIndex::new(&scene);
    let ids = [5, 6, 9, 4_000_000_000].map(id);
    assert_eq!(ids.map(|id| index.number(&id)), [Some(0), Some(1), Some(2), Some(3)]);
    assert_eq!(index.number(&EntityId::new("table", 3)), Some(4));
    assert_eq!(index.number(&EntityId::new("table", 2)), None);
    assert_eq!(index.number(&EntityId::new("zebra", 2)), None);
}
