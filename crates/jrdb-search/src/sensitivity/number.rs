//! The numbers of a graph, changed one at a time.

use jrdb_types::answer::Unit;
use jrdb_types::entity::Between;
use jrdb_types::vocab::Sector;
use jrdb_types::{
    AttributeValue, Attributes, DistanceWord, Edge, EdgeRelation, EntityId, LateralConvention,
    Node, SceneGraph, SpatialRelation,
};

use crate::geometry::{apart_m, near_deg};

/// Which number of a graph.
pub(super) enum Number {
    /// Probability of the value that a condition asks for.
    Belief(EntityId, AttributeValue),
    /// Distance from the robot, metres.
    Range(EntityId),
    /// Bearing from the robot, degrees.
    Bearing(EntityId),
    /// Distance of two things, metres: of the edges both ways.
    Apart(EntityId, EntityId),
    /// Bearing of the second in the first's own frame, degrees.
    Seen(EntityId, EntityId),
    /// Place of the first beside the second as the robot sees both, degrees: it goes round the second.
    Beside(EntityId, EntityId),
    /// Place in the row from left to right, degrees from straight behind the robot.
    Row(EntityId),
    /// Distance of the first from the straight line between the second and the third, or the robot where there is none, metres.
    Aside(EntityId, EntityId, Option<EntityId>),
}

impl Number {
    pub(super) fn unit(&self) -> Unit {
        match self {
            Self::Belief(..) => Unit::Probability,
            Self::Range(_) | Self::Apart(..) | Self::Aside(..) => Unit::Metres,
            Self::Bearing(_) | Self::Seen(..) | Self::Beside(..) | Self::Row(_) => Unit::Degrees,
        }
    }
}

/// A copy of a graph, perhaps without some of its edges, with one number changed at a time.
pub(super) struct Scratch<'g> {
    original: &'g SceneGraph,
    copy: SceneGraph,
    /// What was there before, with its place.
    changed_nodes: Vec<(usize, Node)>,
    changed_edges: Vec<(usize, Edge)>,
    changed_between: Vec<(usize, Between)>,
}

impl<'g> Scratch<'g> {
    /// A copy with these of its edges.
    pub(super) fn with_edges(original: &'g SceneGraph, edges: Vec<Edge>) -> Self {
        let (changed_nodes, changed_edges, changed_between) = (Vec::new(), Vec::new(), Vec::new());
        let copy = SceneGraph {
            frame: original.frame.clone(),
            lateral: original.lateral,
            nodes: original.nodes.clone(),
            edges,
            between: original.between.clone(),
            capabilities: original.capabilities.clone(),
            issues: Vec::new(),
        };
        Self { original, copy, changed_nodes, changed_edges, changed_between }
    }

    /// Takes these of the edges instead.
    pub(super) fn set_edges(&mut self, edges: Vec<Edge>) {
        self.changed_edges.clear();
        self.copy.edges = edges;
    }

    pub(super) fn graph(&self) -> &SceneGraph {
        self.original
    }

    fn node(&self, id: &EntityId) -> Option<&'g Node> {
        self.original.nodes.iter().find(|node| node.id == *id)
    }

    /// How far away the thing is whose bearing a number is, metres.
    pub(super) fn range_m(&self, number: &Number) -> Option<f64> {
        match number {
            Number::Bearing(id) | Number::Row(id) => {
                let node = self.node(id)?;
                let center = node.center.map(|[x, y, z]| x.hypot(y).hypot(z));
                node.from_robot.and_then(|place| place.distance_m).or(center)
            }
            Number::Seen(from, to) => {
                let edges = self.original.edges.iter();
                edges.filter(|edge| edge.from == *from && edge.to == *to).find_map(distance_m)
            }
            Number::Beside(id, other) => {
                Some(apart_m(self.node(id)?.center?, self.node(other)?.center?))
            }
            _ => None,
        }
    }

    /// Probabilities of the asked value and of its strongest rival.
    pub(super) fn rivals(&self, id: &EntityId, asked: AttributeValue) -> [f64; 2] {
        let Some(known) = self.node(id).map(|node| &node.attributes) else { return [0.0; 2] };
        let belief = known.belief(asked.attribute());
        [belief.probability(asked), belief.rival(asked).map_or(0.0, |(_, p)| p)]
    }

    /// The graph with one number changed from what it is; the words for it change too.
    pub(super) fn with(&mut self, number: &Number, from: f64, to: f64) -> &SceneGraph {
        self.restore();
        let lateral = self.original.lateral;
        match number {
            Number::Belief(id, asked) => {
                self.change_node(id, |node| trade(&mut node.attributes, *asked, to));
            }
            Number::Range(id) => self.change_node(id, |node| {
                set_distance(node.from_robot.get_or_insert_default(), to);
            }),
            Number::Bearing(id) => self.change_node(id, |node| {
                set_bearing(node.from_robot.get_or_insert_default(), to, lateral);
            }),
            Number::Row(id) => self.change_node(id, |node| {
                set_bearing(
                    node.from_robot.get_or_insert_default(),
                    STRAIGHT_BEHIND_DEG - to,
                    lateral,
                );
            }),
            Number::Beside(id, other) => {
                let Some(middle) = self.node(other).and_then(|node| node.center) else {
                    return &self.copy;
                };
                self.change_node(id, |node| {
                    // Clockwise for the eye above is counter-clockwise for the thing, which looks at the robot.
                    node.center = node.center.map(|center| turned(center, middle, from - to));
                });
            }
            Number::Aside(id, a, Some(b)) => self.change_between(id, [a, b], to),
            Number::Aside(id, end, None) => {
                let Some(end) = self.node(end).and_then(|node| node.center) else {
                    return &self.copy;
                };
                self.change_node(id, |node| {
                    node.center = node.center.map(|center| moved_aside(center, end, to));
                });
            }
            Number::Apart(a, b) => {
                self.change_edges([(a, b), (b, a)], |relation| {
                    let is_it =
                        relation.distance_m.is_some_and(|metres| (metres - from).abs() < 1e-9);
                    if is_it {
                        set_distance(relation, to);
                    }
                });
            }
            Number::Seen(viewer, seen) => self.change_edges([(viewer, seen); 2], |relation| {
                let bearing = relation.bearing_rad.map(f64::to_degrees);
                if bearing.is_some_and(|bearing| (near_deg(bearing, from) - from).abs() < 1e-9) {
                    set_bearing(relation, to, lateral);
                }
            }),
        }
        &self.copy
    }

    fn restore(&mut self) {
        for (place, node) in self.changed_nodes.drain(..) {
            self.copy.nodes[place] = node;
        }
        for (place, edge) in self.changed_edges.drain(..) {
            self.copy.edges[place] = edge;
        }
        for (place, entry) in self.changed_between.drain(..) {
            self.copy.between[place] = entry;
        }
    }

    fn change_node(&mut self, id: &EntityId, change: impl Fn(&mut Node)) {
        for (place, node) in self.copy.nodes.iter_mut().enumerate() {
            if node.id == *id {
                self.changed_nodes.push((place, node.clone()));
                change(node);
            }
        }
    }

    fn change_between(&mut self, middle: &EntityId, ends: [&EntityId; 2], to: f64) {
        for (place, entry) in self.copy.between.iter_mut().enumerate() {
            let has_ends = ends.iter().all(|end| entry.ends.contains(end));
            if entry.middle == *middle && has_ends {
                self.changed_between.push((place, entry.clone()));
                entry.offset_m = to;
            }
        }
    }

    fn change_edges(
        &mut self,
        pairs: [(&EntityId, &EntityId); 2],
        change: impl Fn(&mut SpatialRelation),
    ) {
        for (place, edge) in self.copy.edges.iter_mut().enumerate() {
            if !pairs.contains(&(&edge.from, &edge.to)) {
                continue;
            }
            let before = edge.clone();
            if let EdgeRelation::Spatial(relation) = &mut edge.relation {
                change(relation);
                self.changed_edges.push((place, before));
            }
        }
    }
}

fn distance_m(edge: &Edge) -> Option<f64> {
    match &edge.relation {
        EdgeRelation::Spatial(relation) => relation.distance_m,
        _ => None,
    }
}

/// Moves probability between a value and its strongest rival; of a value believed for sure that is the first other word.
fn trade(known: &mut Attributes, asked: AttributeValue, to: f64) {
    let belief = known.belief(asked.attribute());
    let other = belief.rival(asked).map(|(value, _)| value);
    let other = other.or_else(|| asked.attribute().values().find(|value| *value != asked));
    let Some(other) = other else { return };
    let sum = belief.probability(asked) + belief.probability(other);
    let to = to.clamp(0.0, sum);
    known.set_probability(asked, to);
    known.set_probability(other, sum - to);
}

/// A place on the same side of the line from the robot to an end, so far from it, metres.
fn moved_aside([x, y, z]: [f64; 3], end: [f64; 3], offset_m: f64) -> [f64; 3] {
    let length_m = end[0].hypot(end[1]);
    let (along, left) =
        ([end[0] / length_m, end[1] / length_m], [-end[1] / length_m, end[0] / length_m]);
    let along_m = x * along[0] + y * along[1];
    let side = (x * left[0] + y * left[1]).signum();
    let [x, y] = [0, 1].map(|axis| along_m * along[axis] + side * offset_m * left[axis]);
    [x, y, z]
}

/// The bearing of what comes first in the row from left to right.
const STRAIGHT_BEHIND_DEG: f64 = 180.0;

/// A place turned about another, counter-clockwise, degrees.
fn turned([x, y, z]: [f64; 3], middle: [f64; 3], angle_deg: f64) -> [f64; 3] {
    let (sin, cos) = angle_deg.to_radians().sin_cos();
    let (x, y) = (x - middle[0], y - middle[1]);
    [middle[0] + cos * x - sin * y, middle[1] + sin * x + cos * y, z]
}

fn set_distance(relation: &mut SpatialRelation, metres: f64) {
    relation.distance_m = Some(metres);
    if relation.distance.is_some() {
        relation.distance = DistanceWord::of_metres(metres);
    }
}

fn set_bearing(relation: &mut SpatialRelation, degrees: f64, lateral: LateralConvention) {
    relation.bearing_rad = Some(near_deg(degrees, 0.0).to_radians());
    if let Some(direction) = &mut relation.direction {
        direction.sector = Sector::of_degrees(degrees).named(lateral);
    }
}
