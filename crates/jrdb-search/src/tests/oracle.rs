//! The algebra a second time, to doubt the search with: three-valued, by plain recursion over nodes and edges, no index, no sets, nothing
//! kept. Written from what the types and the README say; shares no code with the search.

mod picks;
mod relations;

use jrdb_types::query::{Category, Compared, Measure, Order, Place};
use jrdb_types::vocab::{Elevation, MatchPolicy, Sector};
use jrdb_types::*;
use proptest::prelude::*;

use super::graphs::{self, Beliefs, Random};
use super::{asked, under};
use crate::{SearchConfig, search, select};

/// Yes, no, or not known.
type Truth = Option<bool>;
/// The robot, or the place of a thing in [`World::things`].
type Partner = Option<usize>;

struct World<'g> {
    graph: &'g SceneGraph,
    /// Nodes, then ends of edges that are no nodes; each sorted by id.
    things: Vec<(&'g EntityId, Option<&'g Node>)>,
    config: SearchConfig,
}

fn all(parts: impl Iterator<Item = Truth>) -> Truth {
    let mut all = Some(true);
    for part in parts {
        match part {
            Some(false) => return Some(false),
            None => all = None,
            Some(true) => {}
        }
    }
    all
}

fn not(truth: Truth) -> Truth {
    truth.map(|truth| !truth)
}

fn any(parts: impl Iterator<Item = Truth>) -> Truth {
    not(all(parts.map(not)))
}

/// Whether a number that is only known to lie between two others is as asked.
fn counted(quantity: Quantity, sure: usize, at_most: usize) -> Truth {
    let first = quantity.holds(sure);
    (sure..=at_most).all(|number| quantity.holds(number) == first).then_some(first)
}

fn is_distance(place: &Place) -> bool {
    matches!(place, Place::Distance(_) | Place::Metres(_))
}

/// Words by words, numbers by numbers.
fn placed(asked: &Place, found: &SpatialRelation) -> Truth {
    match asked {
        Place::Distance(word) => Some(found.distance? == *word),
        Place::Direction(word) => Some(found.direction? == *word),
        Place::Metres(interval) => Some(interval.contains(found.distance_m?)),
        Place::Degrees { center, half_width } => {
            let off = (found.bearing_rad?.to_degrees() - center).rem_euclid(360.0);
            Some(off.min(360.0 - off) <= *half_width)
        }
    }
}

/// What lies so far ahead, to the left and up of somebody.
fn seen(ahead: f64, left: f64, up: f64) -> SpatialRelation {
    let distance_m = (ahead * ahead + left * left + up * up).sqrt();
    let degrees = left.atan2(ahead).to_degrees();
    let sector = match degrees.abs() {
        a if a <= 30.0 => Sector::Front,
        a if a <= 45.0 => Sector::FrontLeft,
        a if a <= 135.0 => Sector::Left,
        a if a <= 145.0 => Sector::BackLeft,
        _ => Sector::Back,
    };
    let sector = if degrees < 0.0 { sector.mirrored() } else { sector };
    let elevation = match up {
        up if up > 1.5 => Elevation::Up,
        up if up < -1.5 => Elevation::Down,
        _ => Elevation::Level,
    };
    SpatialRelation {
        distance: DistanceWord::ALL.iter().copied().find(|word| distance_m <= word.bounds_m().1),
        direction: Some(Direction { sector, elevation }),
        distance_m: Some(distance_m),
        bearing_rad: Some(degrees.to_radians()),
        rise_m: Some(up),
        direction_probability: None,
    }
}

impl<'g> World<'g> {
    fn new(graph: &'g SceneGraph) -> Self {
        let mut nodes: Vec<_> = graph.nodes.iter().map(|node| (&node.id, Some(node))).collect();
        nodes.sort_by_key(|(id, _)| *id);
        let mut outside: Vec<_> = graph
            .edges
            .iter()
            .flat_map(|edge| [&edge.from, &edge.to])
            .filter(|id| graph.nodes.iter().all(|node| node.id != **id))
            .map(|id| (id, None))
            .collect();
        outside.sort_by_key(|(id, _)| *id);
        outside.dedup_by_key(|(id, _)| *id);
        nodes.extend(outside);
        Self { graph, things: nodes, config: under(MatchPolicy::Strict) }
    }

    fn node(&self, thing: usize) -> Option<&'g Node> {
        self.things[thing].1
    }

    fn others(&self, thing: usize) -> impl Iterator<Item = usize> {
        (0..self.things.len()).filter(move |other| *other != thing)
    }

    /// What the edges from one thing to another say.
    fn edges(&self, from: usize, to: usize) -> impl Iterator<Item = &'g EdgeRelation> {
        let (from, to) = (self.things[from].0, self.things[to].0);
        let edges = self.graph.edges.iter();
        edges.filter(move |e| e.from == *from && e.to == *to).map(|edge| &edge.relation)
    }

    fn spatial(&self, from: usize, to: usize) -> Vec<&'g SpatialRelation> {
        let relations = self.edges(from, to).filter_map(|relation| match relation {
            EdgeRelation::Spatial(relation) => Some(relation),
            _ => None,
        });
        relations.collect()
    }

    fn is_kind(&self, thing: usize, category: &Category) -> bool {
        let (id, node) = self.things[thing];
        let is_person = node.map_or(id.class == "pedestrian", |node| node.category == "person");
        match category {
            Category::Person => is_person,
            Category::Object => !is_person,
            Category::Anything => true,
            Category::Class(name) => {
                object::may_be(node.map_or(&id.class, |node| &node.category), name)
            }
            Category::Robot => false,
        }
    }

    /// Who matches a pattern, its pick included.
    fn matches(&self, pattern: &Pattern) -> Vec<Truth> {
        let held = self.unpicked(pattern);
        match &pattern.pick {
            Some(pick) if self.config.world == crate::World::Open => {
                self.surely_picked(&held, pick)
            }
            Some(pick) => self.picked(held, pick),
            None => held,
        }
    }

    fn unpicked(&self, pattern: &Pattern) -> Vec<Truth> {
        (0..self.things.len())
            .map(|thing| {
                let kind = Some(self.is_kind(thing, &pattern.category));
                let conditions = pattern.conditions.iter().map(|c| self.condition(thing, c));
                if kind == Some(true) { all(conditions) } else { kind }
            })
            .collect()
    }

    fn condition(&self, thing: usize, condition: &Condition) -> Truth {
        let known = self.node(thing).map(|node| &node.attributes);
        match condition {
            Condition::Attribute(asked) => Some(known?.belief(asked.attribute()).best()? == *asked),
            Condition::FromRobot(asked) => placed(asked, &self.by_robot(thing)?),
            Condition::GroupSize(quantity) => Some(quantity.holds(self.group_size(thing)?)),
            Condition::Related(related) => self.related(thing, related),
            Condition::Compared(compared) => self.compared(thing, compared),
            Condition::Measures(_)
            | Condition::Nearer(_)
            | Condition::Looks(_)
            | Condition::Id(_) => None,
            Condition::Phrase(_) => None,
            Condition::Is(pattern) => self.matches(pattern)[thing],
            Condition::Not(inner) => not(self.condition(thing, inner)),
            Condition::Any(parts) => any(parts.iter().map(|part| self.condition(thing, part))),
            Condition::All(parts) => all(parts.iter().map(|part| self.condition(thing, part))),
        }
    }

    fn by_robot(&self, thing: usize) -> Option<SpatialRelation> {
        let node = self.node(thing)?;
        let Some([x, y, z]) = node.center else { return node.from_robot };
        let (numbers, told) = (seen(x, y, z), node.from_robot.unwrap_or_default());
        Some(SpatialRelation {
            distance_m: told.distance_m.or(numbers.distance_m),
            bearing_rad: told.bearing_rad.or(numbers.bearing_rad),
            ..told
        })
    }

    /// The robot, from somebody's place and heading.
    fn robot_from(&self, thing: usize) -> Option<SpatialRelation> {
        let node = self.node(thing)?;
        let ([x, y, z], heading) = (node.center?, node.heading_rad?);
        let (sin, cos) = (-heading).sin_cos();
        Some(seen(-x * cos + y * sin, -x * sin - y * cos, -z))
    }

    fn group_size(&self, thing: usize) -> Option<usize> {
        if !self.is_kind(thing, &Category::Person) {
            return None;
        }
        let number = self.node(thing)?.group;
        let people = (0..self.things.len())
            .filter(|&other| self.node(other).is_some() && self.is_kind(other, &Category::Person));
        if number.is_some() {
            return Some(
                people.filter(|&n| self.node(n).is_some_and(|n| n.group == number)).count(),
            );
        }
        let (id, node) = self.things[thing];
        let has_edge =
            self.graph.edges.iter().any(|e| e.from != e.to && (e.from == *id || e.to == *id));
        if !has_edge && node?.center.is_none() {
            return None;
        }
        let free: Vec<usize> =
            people.filter(|&n| self.node(n).is_some_and(|n| n.group.is_none())).collect();
        let mut group = vec![thing];
        while let Some(next) = free.iter().find(|&&next| {
            !group.contains(&next)
                && group.iter().any(|&one| self.joined(one, next) || self.joined(next, one))
        }) {
            group.push(*next);
        }
        Some(group.len())
    }

    fn joined(&self, a: usize, b: usize) -> bool {
        self.edges(a, b).any(|relation| match relation {
            EdgeRelation::Interaction { .. } => true,
            EdgeRelation::Spatial(place) => match place.distance_m {
                Some(metres) => metres <= self.config.close_m,
                None => place.distance.is_some_and(|word| word <= DistanceWord::Close),
            },
            EdgeRelation::Pair { .. } => false,
        })
    }

    fn measure(&self, thing: usize, measure: &Measure) -> Option<f64> {
        let node = self.node(thing);
        match measure {
            Measure::Height => node?.height_m,
            Measure::Age => {
                let age = node?.attributes.age().best()?;
                Age::ALL.iter().position(|other| *other == age).map(|place| place as f64)
            }
            Measure::Speed => node?.velocity_mps.map(|[x, y]| (x * x + y * y).sqrt()),
            Measure::FromLeft => Some(-self.by_robot(thing)?.bearing_rad?),
            Measure::DistanceTo(pattern) if pattern.category == Category::Robot => {
                self.by_robot(thing)?.distance_m
            }
            Measure::DistanceTo(pattern) => {
                let held = self.matches(pattern);
                let those = self.others(thing).filter(|other| held[*other] == Some(true));
                let nearest =
                    those.filter_map(|other| self.apart(thing, other)).min_by(f64::total_cmp)?;
                let is_open = self.config.world == crate::World::Open
                    && self.others(thing).filter(|other| held[*other].is_none()).any(|other| {
                        self.apart(thing, other).is_none_or(|metres| metres < nearest)
                    });
                (!is_open).then_some(nearest)
            }
        }
    }

    fn apart(&self, a: usize, b: usize) -> Option<f64> {
        let center = |thing| self.node(thing)?.center;
        if let (Some(a), Some(b)) = (center(a), center(b)) {
            return seen(a[0] - b[0], a[1] - b[1], a[2] - b[2]).distance_m;
        }
        let both = [self.spatial(a, b), self.spatial(b, a)].concat();
        both.iter().find_map(|relation| relation.distance_m)
    }

    fn compared(&self, thing: usize, compared: &Compared) -> Truth {
        let than = self.matches(&compared.than);
        let mine = self.measure(thing, &compared.measure)?;
        let others = self.others(thing).filter(|other| than[*other] == Some(true));
        let values: Vec<f64> =
            others.filter_map(|other| self.measure(other, &compared.measure)).collect();
        let beaten = |theirs: &f64| match compared.order {
            Order::Least => mine < *theirs,
            Order::Most => mine > *theirs,
        };
        let holds = (!values.is_empty()).then(|| values.iter().all(beaten))?;
        let loses_to_unknown = self.others(thing).any(|other| {
            let theirs = self.measure(other, &compared.measure);
            match than[other] {
                Some(true) => theirs.is_none(),
                Some(false) => false,
                None => theirs.is_none_or(|theirs| !beaten(&theirs)),
            }
        });
        let is_open = self.config.world == crate::World::Open && holds && loses_to_unknown;
        (!is_open).then_some(holds)
    }

    /// The answer under the strict policy.
    fn answer(&self, query: &Query) -> Vec<EntityId> {
        let mut held = self.matches(&Pattern { pick: None, ..query.target.clone() });
        // Only what is in the picture is an answer.
        for (thing, held) in held.iter_mut().enumerate() {
            if self.node(thing).is_none() {
                *held = Some(false);
            }
        }
        if let Some(pick) = &query.target.pick {
            held = self.picked(held, pick);
        }
        let ids = self.things.iter().zip(held).filter(|(_, held)| *held == Some(true));
        ids.map(|((id, _), _)| (*id).clone()).collect()
    }
}

fn agrees(scene: &SceneGraph, query: &Query) -> Result<(), TestCaseError> {
    agrees_in(scene, query, crate::World::Open)?;
    agrees_in(scene, query, crate::World::Closed)
}

fn agrees_in(scene: &SceneGraph, query: &Query, world: crate::World) -> Result<(), TestCaseError> {
    let config = SearchConfig { world, ..under(MatchPolicy::Strict) };
    let wanted = World { config, ..World::new(scene) }.answer(query);
    let index = jrdb_graph::GraphIndex::new(scene);
    let numbers = select(&index, query, &config);
    let by_sets: Vec<EntityId> = numbers.iter().filter_map(|n| index.id(n)).cloned().collect();
    prop_assert_eq!(&wanted, &by_sets, "select: {:#?}", query);
    prop_assert_eq!(&wanted, &search(scene, query, &config).selection, "search: {:#?}", query);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(4000) })]

    #[test]
    fn search_and_oracle_agree(seed: u64, question: u64, certain: bool) {
        let beliefs = if certain { Beliefs::Certain } else { Beliefs::Mixed };
        let scene = graphs::crowd(&mut Random(seed), beliefs);
        agrees(&scene, &asked::random(&mut Random(question)))?;
    }

    #[test]
    fn search_and_oracle_agree_on_one_condition(seed: u64, question: u64) {
        let scene = graphs::crowd(&mut Random(seed), Beliefs::Mixed);
        agrees(&scene, &asked::single(&mut Random(question)))?;
    }
}

#[test]
fn the_questions_compared_are_neither_all_empty_nor_all_full() {
    let (mut some, mut of) = (0, 0);
    for seed in 0..300 {
        let scene = graphs::crowd(&mut Random(seed), Beliefs::Mixed);
        let answer = World::new(&scene).answer(&asked::single(&mut Random(seed)));
        some += usize::from(!answer.is_empty() && answer.len() < scene.nodes.len());
        of += 1;
    }
    assert!(some * 4 > of, "{some} of {of}");
}
