//! How people were placed beside where they stand: errors of position and heading, and sides taken
//! for others.

use std::collections::BTreeMap;

use jrdb_types::detection::PERSON;
use jrdb_types::graph::EdgeRelation;
use jrdb_types::vocab::Sector;
use jrdb_types::{EntityId, Node, PixelBox, SceneGraph};
use serde::{Deserialize, Serialize};

use crate::same::pairs;
use crate::table::{Cell, Origin, Role, Row, Table, Unit};

/// A person who is there, and what was seen of it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PlacedPerson {
    /// True distance from the robot over the ground, metres.
    pub range_m: f64,
    /// Whether a box of the method shows the person.
    pub is_seen: bool,
    /// Distance over the ground between the place found and the true one, metres; absent where no
    /// place was found.
    pub position_m: Option<f64>,
    /// Angle between the heading found and the true one, degrees in `[0, 180]`; absent where one of
    /// them is not known.
    pub heading_deg: Option<f64>,
}

/// On which side something is, and on which it was said to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct SidePair {
    /// Whether the side is a person's own; else it is the robot's.
    pub of_person: bool,
    /// The true side.
    pub truth: Side,
    /// The side that was said.
    pub said: Side,
}

impl SidePair {
    fn words(&self) -> (&'static str, &'static str) {
        (self.truth.word(), self.said.word())
    }
}

/// A side of somebody.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Left, front left or back left.
    Left,
    /// Right, front right or back right.
    Right,
    /// Straight in front or behind.
    Neither,
    /// Not known.
    Unknown,
}

impl Side {
    /// Its name.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Left => "left",
            Self::Right => "right",
            Self::Neither => "neither",
            Self::Unknown => "unknown",
        }
    }

    fn of(sector: Sector) -> Self {
        match sector {
            Sector::Left | Sector::FrontLeft | Sector::BackLeft => Self::Left,
            Sector::Right | Sector::FrontRight | Sector::BackRight => Self::Right,
            Sector::Front | Sector::Back => Self::Neither,
        }
    }
}

/// The people of some frames as they were placed, and the sides that were told.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Placements {
    /// Everybody who is there and whose true place is known.
    pub people: Vec<PlacedPerson>,
    /// Sides of the robot, and of people who have a true heading.
    pub sides: Vec<SidePair>,
}

impl Placements {
    /// Compares a frame as a method sees it with how it is. `period_px` is the width of an image that
    /// wraps, pixels.
    ///
    /// Boxes show the same person from an IoU of 0.5 on. A side that somebody has no true direction
    /// for is left out.
    #[must_use]
    pub fn of(seen: &SceneGraph, truth: &SceneGraph, period_px: Option<f64>) -> Self {
        let [seen_people, true_people] = [seen, truth].map(people);
        let [seen_boxes, true_boxes] = [&seen_people, &true_people].map(|all| boxes(all));
        let seen_of = pairs(&true_boxes, &seen_boxes, period_px);
        let counterpart = |at: usize| seen_of.get(&at).map(|at| seen_people[*at]);
        let both = || true_people.iter().enumerate().map(|(at, node)| (*node, counterpart(at)));
        let mut sides: Vec<SidePair> =
            both().filter_map(|(truth, seen)| from_robot(truth, seen?)).collect();
        let names = both().filter_map(|(truth, seen)| Some((&truth.id, &seen?.id))).collect();
        sides.extend(between(seen, truth, &names));
        Self { people: both().filter_map(|(truth, seen)| person(truth, seen)).collect(), sides }
    }

    /// Adds those of another frame.
    pub fn extend(&mut self, other: Self) {
        self.people.extend(other.people);
        self.sides.extend(other.sides);
    }

    /// Whether there is nothing to tell: no frame had true places.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.people.is_empty()
    }

    /// Pairs of the true side of the robot and the one that was said.
    pub fn sides_of_robot(&self) -> impl Iterator<Item = (&'static str, &'static str)> {
        self.sides.iter().filter(|one| !one.of_person).map(SidePair::words)
    }

    /// Pairs of the true side of a person and the one that was said.
    pub fn sides_of_people(&self) -> impl Iterator<Item = (&'static str, &'static str)> {
        self.sides.iter().filter(|one| one.of_person).map(SidePair::words)
    }

    /// A row for each stretch of the range: how many people there are, how many were seen and placed,
    /// and the median and the 90 % quantile of the errors.
    #[must_use]
    pub fn table(&self, method: &str) -> Table {
        let rows = RANGES.iter().map(|range| row(range, &self.people));
        Table {
            title: format!("{method}: places"),
            unit: Unit::Mixed,
            categories: vec!["people".into()],
            metrics: COLUMNS.map(Into::into).to_vec(),
            rows: rows.filter(|row| row.cells[0].is_some()).collect(),
            notes: vec![
                "Errors are those of people who were seen: distance over the ground, angle of heading."
                    .into(),
            ],
        }
    }
}

const COLUMNS: [&str; 7] = [
    "there",
    "seen %",
    "placed %",
    "position m, median",
    "90 %",
    "heading °, median",
    "heading 90 %",
];

/// A stretch of the range: its name, where it begins and where it ends, metres.
struct Range(&'static str, f64, f64);

const RANGES: [Range; 5] = [
    Range("at any range", 0.0, f64::INFINITY),
    Range("0 to 3 m", 0.0, 3.0),
    Range("3 to 6 m", 3.0, 6.0),
    Range("6 to 12 m", 6.0, 12.0),
    Range("12 m or more", 12.0, f64::INFINITY),
];

/// The name of the stretch that a range is in, for rows of tables.
#[must_use]
pub fn range_name(range_m: f64) -> &'static str {
    let found = RANGES[1..].iter().find(|Range(_, from, to)| (*from..*to).contains(&range_m));
    found.map_or("12 m or more", |Range(name, ..)| name)
}

fn row(Range(name, from, to): &Range, people: &[PlacedPerson]) -> Row {
    let here: Vec<&PlacedPerson> =
        people.iter().filter(|one| (*from..*to).contains(&one.range_m)).collect();
    let share = |part: usize| 100.0 * part as f64 / here.len() as f64;
    let seen = here.iter().filter(|one| one.is_seen).count();
    let positions: Vec<f64> = here.iter().filter_map(|one| one.position_m).collect();
    let headings: Vec<f64> = here.iter().filter_map(|one| one.heading_deg).collect();
    let cells = [
        (!here.is_empty()).then_some(here.len() as f64),
        Some(share(seen)),
        Some(share(positions.len())),
        quantile(&positions, 0.5),
        quantile(&positions, 0.9),
        quantile(&headings, 0.5),
        quantile(&headings, 0.9),
    ];
    Row {
        method: (*name).into(),
        role: Role::Method,
        origin: Origin::Measured,
        cells: cells.map(|value| value.map(Cell::plain)).to_vec(),
        failure: None,
    }
}

/// The number below which this part of the numbers is.
fn quantile(numbers: &[f64], part: f64) -> Option<f64> {
    let mut numbers = numbers.to_vec();
    numbers.sort_by(f64::total_cmp);
    let at = (part * numbers.len() as f64) as usize;
    numbers.get(at.min(numbers.len().checked_sub(1)?)).copied()
}

fn people(graph: &SceneGraph) -> Vec<&Node> {
    graph.nodes.iter().filter(|node| node.category == PERSON).collect()
}

fn boxes(nodes: &[&Node]) -> Vec<PixelBox> {
    nodes.iter().map(|node| node.bbox).collect()
}

fn person(truth: &Node, seen: Option<&Node>) -> Option<PlacedPerson> {
    let [x, y, _] = truth.center?;
    let off = |[seen_x, seen_y, _]: [f64; 3]| (seen_x - x).hypot(seen_y - y);
    let turned = |heading: f64| {
        let turn = (heading - truth.heading_rad?).to_degrees().rem_euclid(360.0);
        Some(turn.min(360.0 - turn))
    };
    Some(PlacedPerson {
        range_m: x.hypot(y),
        is_seen: seen.is_some(),
        position_m: seen.and_then(|node| node.center).map(off),
        heading_deg: seen.and_then(|node| node.heading_rad).and_then(turned),
    })
}

/// The side of the robot that somebody is on.
fn from_robot(truth: &Node, seen: &Node) -> Option<SidePair> {
    let side = |node: &Node| Some(Side::of(node.from_robot.as_ref()?.direction?.sector));
    let said = side(seen).unwrap_or(Side::Unknown);
    Some(SidePair { of_person: false, truth: side(truth)?, said })
}

/// The sides of people that others are on, as far as both were seen.
fn between(
    seen: &SceneGraph,
    truth: &SceneGraph,
    names: &BTreeMap<&EntityId, &EntityId>,
) -> Vec<SidePair> {
    let said = sides(seen);
    let told = sides(truth).into_iter().filter_map(|((from, to), truth)| {
        let pair = (*names.get(from)?, *names.get(to)?);
        let said = said.get(&pair).copied().unwrap_or(Side::Unknown);
        Some(SidePair { of_person: true, truth, said })
    });
    told.collect()
}

/// The side of the first that the second is on, for all pairs with a known one.
fn sides(graph: &SceneGraph) -> BTreeMap<(&EntityId, &EntityId), Side> {
    let known = graph.edges.iter().filter_map(|edge| match &edge.relation {
        EdgeRelation::Spatial(relation) => {
            Some(((&edge.from, &edge.to), Side::of(relation.direction?.sector)))
        }
        _ => None,
    });
    known.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use jrdb_types::vocab::Direction;
    use jrdb_types::{Edge, FrameId, LateralConvention, SpatialRelation};

    fn relation(sector: Sector) -> SpatialRelation {
        let direction = Some(Direction::level(sector));
        let (distance, distance_m, bearing_rad) = (None, None, None);
        let (rise_m, direction_probability) = (None, None);
        SpatialRelation {
            distance,
            direction,
            distance_m,
            bearing_rad,
            rise_m,
            direction_probability,
        }
    }

    /// A person with a box at this column, a place on the robot's left and a heading.
    fn node(number: u32, column: f64, forward_m: f64, heading_deg: f64) -> Node {
        let id = EntityId::new(PERSON, number);
        Node {
            center: Some([forward_m, 1.0, 0.0]),
            heading_rad: Some(heading_deg.to_radians()),
            from_robot: Some(relation(Sector::Left)),
            ..Node::new(id, PERSON, PixelBox::from([column, 0.0, 40.0, 90.0]))
        }
    }

    fn graph(nodes: Vec<Node>, sector: Sector) -> SceneGraph {
        let ends = [nodes[0].id.clone(), nodes[1].id.clone()];
        let [from, to] = ends;
        let mut graph = SceneGraph::new(FrameId::default(), LateralConvention::Physical, nodes);
        let relation = EdgeRelation::Spatial(relation(sector));
        graph.edges.push(Edge { from, to, relation });
        graph
    }

    #[test]
    fn errors_and_sides_are_those_of_the_same_people() {
        let there =
            vec![node(1, 100.0, 2.0, 170.0), node(2, 300.0, 8.0, 0.0), node(3, 600.0, 20.0, 0.0)];
        let found = [node(7, 305.0, 8.5, 10.0), node(8, 98.0, 2.0, -170.0)];
        let truth = graph(there, Sector::Left);
        // In what was found the second comes first.
        let seen = graph(vec![found[1].clone(), found[0].clone()], Sector::FrontRight);
        let all = Placements::of(&seen, &truth, Some(1000.0));
        assert_eq!(
            all.people.iter().map(|one| one.is_seen).collect::<Vec<_>>(),
            [true, true, false]
        );
        assert!((all.people[0].heading_deg.unwrap() - 20.0).abs() < 1e-9);
        assert!((all.people[1].position_m.unwrap() - 0.5).abs() < 1e-9);
        assert_eq!(all.sides_of_robot().collect::<Vec<_>>(), [("left", "left"); 2]);
        assert_eq!(all.sides_of_people().collect::<Vec<_>>(), [("left", "right")]);
        let table = all.table("m");
        let names: Vec<&str> = table.rows.iter().map(|row| row.method.as_str()).collect();
        assert_eq!(names, ["at any range", "0 to 3 m", "6 to 12 m", "12 m or more"]);
        let seen = |row: usize| table.rows[row].cells[1].map(|cell| cell.value);
        assert_eq!((seen(1), seen(3)), (Some(100.0), Some(0.0)));
        assert_eq!(table.rows[3].cells[3], None);
    }

    #[test]
    fn a_side_that_was_not_said_is_unknown() {
        let there = || vec![node(1, 100.0, 2.0, 0.0), node(2, 300.0, 8.0, 0.0)];
        let truth = graph(there(), Sector::Back);
        let silent = SceneGraph { edges: Vec::new(), ..graph(there(), Sector::Back) };
        let all = Placements::of(&silent, &truth, None);
        assert_eq!(all.sides_of_people().collect::<Vec<_>>(), [("neither", "unknown")]);
        assert_eq!(range_name(5.9), "3 to 6 m");
        assert!(Placements::default().is_empty());
    }
}
