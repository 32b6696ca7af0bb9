//! Graphs to search.

use std::collections::BTreeMap;

use jrdb_types::entity::Between;
use jrdb_types::vocab::{Color, PairWord};
use jrdb_types::*;

use crate::geometry::{along, apart_m, robot_seen_by};

pub(crate) const PHYSICAL: LateralConvention = LateralConvention::Physical;

pub(crate) fn id(number: u32) -> EntityId {
    EntityId::new("pedestrian", number)
}

pub(crate) fn person(number: u32, age: Age, gender: Gender, race: Race) -> Node {
    let attributes = Attributes::certain([age.into(), gender.into(), race.into()]);
    Node { attributes, ..nobody(id(number), "person") }
}

/// Something of which nothing is known.
pub(crate) fn nobody(id: EntityId, category: &str) -> Node {
    Node {
        bbox: PixelBox::from([f64::from(id.number), 0.0, 1.0, 1.0]),
        id,
        category: category.into(),
        score: 1.0,
        attributes: Attributes::default(),
        center: None,
        heading_rad: None,
        height_m: None,
        velocity_mps: None,
        group: None,
        from_robot: None,
    }
}

/// The same at a place, seen from the robot.
pub(crate) fn at(node: Node, center: [f64; 3], heading_rad: Option<f64>) -> Node {
    Node {
        center: Some(center),
        heading_rad,
        from_robot: Some(seen([0.0; 3], 0.0, center)),
        ..node
    }
}

/// Where a place is, seen from another: the robot's, turned and moved.
pub(crate) fn seen(from: [f64; 3], heading_rad: f64, to: [f64; 3]) -> SpatialRelation {
    let back = [0, 1, 2].map(|axis| from[axis] - to[axis]);
    robot_seen_by(back, heading_rad, PHYSICAL)
}

pub(crate) fn edge(from: u32, to: u32, relation: SpatialRelation) -> Edge {
    Edge { from: id(from), to: id(to), relation: EdgeRelation::Spatial(relation) }
}

pub(crate) fn pair(from: u32, to: u32, word: PairWord) -> Edge {
    Edge { from: id(from), to: id(to), relation: EdgeRelation::Pair { word, value: None } }
}

pub(crate) fn deed(from: u32, to: u32, label: &str) -> Edge {
    let relation = EdgeRelation::Interaction { label: label.into() };
    Edge { from: id(from), to: id(to), relation }
}

pub(crate) fn graph(nodes: Vec<Node>, edges: Vec<Edge>) -> SceneGraph {
    SceneGraph {
        frame: FrameId::default(),
        lateral: PHYSICAL,
        nodes,
        edges,
        between: Vec::new(),
        capabilities: Some(Capabilities::open()),
        issues: Vec::new(),
    }
}

/// The spatial edges of all pairs with places.
pub(crate) fn connected(nodes: Vec<Node>) -> SceneGraph {
    let mut edges = Vec::new();
    for from in &nodes {
        for to in nodes.iter().filter(|to| to.id != from.id) {
            let (Some(a), Some(b)) = (from.center, to.center) else { continue };
            let relation = match from.heading_rad {
                Some(heading) => seen(a, heading, b),
                None => {
                    let distance_m = apart_m(a, b);
                    let distance = DistanceWord::of_metres(distance_m);
                    SpatialRelation {
                        distance,
                        distance_m: Some(distance_m),
                        ..SpatialRelation::default()
                    }
                }
            };
            let relation = EdgeRelation::Spatial(relation);
            edges.push(Edge { from: from.id.clone(), to: to.id.clone(), relation });
        }
    }
    graph(nodes, edges)
}

/// SplitMix64: the same numbers on every machine.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In `[0, 1)`.
    pub(crate) fn uniform(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    pub(crate) fn below(&mut self, n: usize) -> usize {
        ((self.uniform() * n as f64) as usize).min(n.saturating_sub(1))
    }

    pub(crate) fn one_of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())]
    }

    pub(crate) fn chance(&mut self, probability: f64) -> bool {
        self.uniform() < probability
    }
}

/// How beliefs of random graphs look.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Beliefs {
    /// Certain, all known.
    Certain,
    /// Certain, uncertain or unknown.
    Mixed,
}

/// A graph with a bit of everything, numbers and words in agreement; ends that are no nodes among them.
pub(crate) fn random(random: &mut Random, beliefs: Beliefs) -> SceneGraph {
    let people = 2 + random.below(7);
    of_people(random, people, beliefs)
}

/// The same of 6 to 14 things, with who is really between whom besides; one in three with edges to the near only.
pub(crate) fn crowd(random: &mut Random, beliefs: Beliefs) -> SceneGraph {
    let people = 6 + random.below(7);
    let mut graph = of_people(random, people, beliefs);
    let nodes = graph.nodes.clone();
    for (middle, a) in nodes.iter().flat_map(|m| nodes.iter().map(move |a| (m, a))) {
        for b in nodes.iter().filter(|b| b.id > a.id && a.id != middle.id && b.id != middle.id) {
            let (Some(m), Some(p), Some(q)) = (middle.center, a.center, b.center) else { continue };
            let Some((offset_m, fraction)) = along(m, [p, q], 0.3) else { continue };
            let ends = [a.id.clone(), b.id.clone()];
            if offset_m <= 0.5 {
                graph.between.push(Between { middle: middle.id.clone(), ends, offset_m, fraction });
            }
        }
    }
    if random.chance(0.3) {
        graph.edges.retain(|edge| match &edge.relation {
            EdgeRelation::Spatial(place) => place.distance <= Some(DistanceWord::Close),
            _ => true,
        });
    }
    graph
}

fn of_people(random: &mut Random, people: usize, beliefs: Beliefs) -> SceneGraph {
    let mut nodes: Vec<Node> =
        (0..people).map(|n| random_person(random, n as u32 * 2, beliefs)).collect();
    for number in 0..random.below(3) {
        let category = random.one_of(&["bag", "table"]);
        let object = nobody(EntityId::new("thing", number as u32), category);
        nodes.push(placed(random, object));
    }
    let mut graph = connected(nodes);
    let ids: Vec<EntityId> =
        graph.nodes.iter().map(|node| node.id.clone()).chain([id(1), id(3)]).collect();
    for _ in 0..random.below(12) {
        let (from, to) = (random.below(ids.len()), random.below(ids.len()));
        let relation = match random.below(3) {
            0 => EdgeRelation::Pair { word: random.one_of(PairWord::ALL), value: None },
            1 => EdgeRelation::Interaction {
                label: random.one_of(&["conversation", "holding"]).into(),
            },
            _ => EdgeRelation::Spatial(words(random)),
        };
        graph.edges.push(Edge { from: ids[from].clone(), to: ids[to].clone(), relation });
    }
    graph.edges.sort_by(|a, b| (&a.from, &a.to).cmp(&(&b.from, &b.to)));
    for _ in 0..random.below(4) {
        let [a, b, c] = [0; 3].map(|_| random.below(graph.nodes.len()));
        if a != b && b != c && a != c {
            let ends = [graph.nodes[a.min(b)].id.clone(), graph.nodes[a.max(b)].id.clone()];
            let (offset_m, fraction) = (random.within(0.0, 0.5), 0.5);
            graph.between.push(Between {
                middle: graph.nodes[c].id.clone(),
                ends,
                offset_m,
                fraction,
            });
        }
    }
    graph
}

fn words(random: &mut Random) -> SpatialRelation {
    let sector = random.one_of(vocab::Sector::ALL);
    SpatialRelation {
        distance: Some(random.one_of(DistanceWord::ALL)),
        direction: Some(Direction::level(sector)),
        ..SpatialRelation::default()
    }
}

fn placed(random: &mut Random, node: Node) -> Node {
    if random.chance(0.15) {
        return node;
    }
    let center = [random.within(-4.0, 4.0), random.within(-4.0, 4.0), random.within(-0.2, 0.2)];
    let heading = random.within(-3.1, 3.1);
    let node = at(node, center, random.chance(0.8).then_some(heading));
    Node {
        height_m: random.chance(0.8).then(|| random.within(1.0, 2.0)),
        velocity_mps: random.chance(0.7).then(|| [random.within(-1.0, 1.0), 0.3]),
        ..node
    }
}

fn random_person(random: &mut Random, number: u32, beliefs: Beliefs) -> Node {
    let mut node = nobody(id(number), "person");
    node.attributes = Attributes::default()
        .with_age(belief(random, Age::ALL, beliefs))
        .with_gender(belief(random, Gender::ALL, beliefs))
        .with_race(belief(random, Race::ALL, beliefs))
        .with_action(belief(random, &Action::ALL[..3], beliefs))
        .with_upper_color(belief(random, &Color::ALL[..3], beliefs))
        .with_lower_color(belief(random, &Color::ALL[..3], beliefs));
    node.group = random.chance(0.3).then(|| random.below(2) as u32);
    placed(random, node)
}

fn belief<T: Ord + Copy>(random: &mut Random, all: &[T], beliefs: Beliefs) -> Belief<T> {
    let certain = Belief::certain(random.one_of(all));
    match random.below(3) {
        _ if beliefs == Beliefs::Certain => certain,
        0 => certain,
        1 => Belief::default(),
        _ => {
            let weights: Vec<(T, f64)> =
                all.iter().map(|&value| (value, random.within(0.0, 1.0))).collect();
            let sum: f64 = weights.iter().map(|(_, w)| w).sum();
            Belief(weights.into_iter().map(|(v, w)| (v, w / sum)).collect::<BTreeMap<_, _>>())
        }
    }
}
