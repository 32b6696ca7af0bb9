//! The numbers of a graph, changed one at a time.

use jrdb_types::answer::Unit;
use jrdb_types::{
    Action, Age, Belief, Condition, Edge, EdgeRelation, EntityId, Gender, LateralConvention, Node,
    Race, SceneGraph, SpatialRelation,
};

use crate::attribute::rival;
use crate::geometry::{distance_word, named, near_deg, physical_sector};

/// Which number of a graph.
pub(super) enum Number<'q> {
    /// Probability of the value that a condition asks for.
    Belief(EntityId, &'q Condition),
    /// Distance from the robot, metres.
    Range(EntityId),
    /// Bearing from the robot, degrees.
    Bearing(EntityId),
    /// Distance of two things, metres: of the edges both ways.
    Apart(EntityId, EntityId),
    /// Bearing of the second in the first's own frame, degrees.
    Seen(EntityId, EntityId),
}

impl Number<'_> {
    pub(super) fn unit(&self) -> Unit {
        match self {
            Self::Belief(..) => Unit::Probability,
            Self::Range(_) | Self::Apart(..) => Unit::Metres,
            Self::Bearing(_) | Self::Seen(..) => Unit::Degrees,
        }
    }
}

/// A copy of a graph with one number changed at a time.
pub(super) struct Scratch<'g> {
    original: &'g SceneGraph,
    copy: SceneGraph,
    changed_nodes: Vec<usize>,
    changed_edges: Vec<usize>,
}

impl<'g> Scratch<'g> {
    pub(super) fn new(original: &'g SceneGraph) -> Self {
        let (changed_nodes, changed_edges) = (Vec::new(), Vec::new());
        Self { original, copy: original.clone(), changed_nodes, changed_edges }
    }

    pub(super) fn graph(&self) -> &SceneGraph {
        self.original
    }

    fn node(&self, id: &EntityId) -> Option<&'g Node> {
        self.original.nodes.iter().find(|node| node.id == *id)
    }

    /// How far the thing is that a bearing is told of, metres.
    pub(super) fn range_m(&self, number: &Number<'_>) -> Option<f64> {
        match number {
            Number::Bearing(id) => {
                let node = self.node(id)?;
                let center = node.center.map(|[x, y, z]| x.hypot(y).hypot(z));
                node.from_robot.and_then(|place| place.distance_m).or(center)
            }
            Number::Seen(from, to) => {
                let edges = self.original.edges.iter();
                edges.filter(|edge| edge.from == *from && edge.to == *to).find_map(distance_m)
            }
            _ => None,
        }
    }

    /// Probabilities of the asked value and of its strongest rival.
    pub(super) fn rivals(&self, id: &EntityId, condition: &Condition) -> [f64; 2] {
        let Some(known) = self.node(id).map(|node| &node.attributes) else { return [0.0; 2] };
        match condition {
            Condition::Age(asked) => both(&known.age, *asked),
            Condition::Gender(asked) => both(&known.gender, *asked),
            Condition::Race(asked) => both(&known.race, *asked),
            Condition::Action(asked) => both(&known.action, *asked),
            _ => [0.0; 2],
        }
    }

    /// The graph with one number changed from what it is; the words for it change too.
    pub(super) fn with(&mut self, number: &Number<'_>, from: f64, to: f64) -> &SceneGraph {
        self.restore();
        let lateral = self.original.lateral;
        match number {
            Number::Belief(id, condition) => {
                self.change_node(id, |node| believe(node, condition, to));
            }
            Number::Range(id) => self.change_node(id, |node| {
                set_distance(node.from_robot.get_or_insert_default(), to);
            }),
            Number::Bearing(id) => self.change_node(id, |node| {
                set_bearing(node.from_robot.get_or_insert_default(), to, lateral);
            }),
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
        for place in self.changed_nodes.drain(..) {
            self.copy.nodes[place] = self.original.nodes[place].clone();
        }
        for place in self.changed_edges.drain(..) {
            self.copy.edges[place] = self.original.edges[place].clone();
        }
    }

    fn change_node(&mut self, id: &EntityId, change: impl Fn(&mut Node)) {
        for (place, node) in self.copy.nodes.iter_mut().enumerate() {
            if node.id == *id {
                change(node);
                self.changed_nodes.push(place);
            }
        }
    }

    fn change_edges(
        &mut self,
        pairs: [(&EntityId, &EntityId); 2],
        change: impl Fn(&mut SpatialRelation),
    ) {
        for (place, edge) in self.copy.edges.iter_mut().enumerate() {
            if pairs.contains(&(&edge.from, &edge.to))
                && let EdgeRelation::Spatial(relation) = &mut edge.relation
            {
                change(relation);
                self.changed_edges.push(place);
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

fn both<T: Ord + Copy>(belief: &Belief<T>, asked: T) -> [f64; 2] {
    [belief.probability(asked), rival(belief, asked).map_or(0.0, |(_, p)| p)]
}

fn believe(node: &mut Node, condition: &Condition, to: f64) {
    let known = &mut node.attributes;
    match condition {
        Condition::Age(asked) => trade(&mut known.age, *asked, Age::ALL, to),
        Condition::Gender(asked) => trade(&mut known.gender, *asked, Gender::ALL, to),
        Condition::Race(asked) => trade(&mut known.race, *asked, Race::ALL, to),
        Condition::Action(asked) => trade(&mut known.action, *asked, Action::ALL, to),
        _ => {}
    }
}

/// Moves probability between a value and its strongest rival; of a value believed for sure that is the first other word.
fn trade<T: Ord + Copy>(belief: &mut Belief<T>, asked: T, all: &[T], to: f64) {
    let other = rival(belief, asked).map(|(value, _)| value);
    let other = other.or_else(|| all.iter().copied().find(|value| *value != asked));
    let Some(other) = other else { return };
    let sum = belief.probability(asked) + belief.probability(other);
    let to = to.clamp(0.0, sum);
    belief.0.insert(asked, to);
    belief.0.insert(other, sum - to);
}

fn set_distance(relation: &mut SpatialRelation, metres: f64) {
    relation.distance_m = Some(metres);
    if relation.distance.is_some() {
        relation.distance = distance_word(metres);
    }
}

fn set_bearing(relation: &mut SpatialRelation, degrees: f64, lateral: LateralConvention) {
    relation.bearing_rad = Some(near_deg(degrees, 0.0).to_radians());
    if let Some(direction) = &mut relation.direction {
        direction.sector = named(physical_sector(degrees), lateral);
    }
}
