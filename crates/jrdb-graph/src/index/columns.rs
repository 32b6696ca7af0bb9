//! Who has which value: one set per word.

use jrdb_types::detection::PERSON;
use jrdb_types::vocab::{Elevation, Sector};
use jrdb_types::{Attribute, AttributeBelief, AttributeValue, Direction, DistanceWord, Node};

use crate::BitSet;

/// Words in `Direction`: eight sectors at three heights.
pub(super) const DIRECTIONS: usize = 24;

/// Place of a direction in a list of all: sectors, level ones first.
pub(super) fn direction_code(direction: Direction) -> usize {
    direction.elevation as usize * Sector::ALL.len() + direction.sector as usize
}

/// The sets of one attribute.
#[derive(Debug, Clone, PartialEq)]
struct Column {
    values: Vec<BitSet>,
    known: BitSet,
}

impl Column {
    fn new(values: usize, size: usize) -> Self {
        Self { values: vec![BitSet::new(size); values], known: BitSet::new(size) }
    }

    fn put(&mut self, number: usize, value: Option<usize>) {
        if let Some(value) = value {
            self.values[value].insert(number);
            self.known.insert(number);
        }
    }
}

/// Sets of node numbers by what nodes are: the best value of each belief, the words of where the robot sees them.
#[derive(Debug, Clone, PartialEq)]
pub struct Columns {
    /// Who has each value, by its place among all values.
    values: Vec<BitSet>,
    /// Of whom each attribute is known.
    known: Vec<BitSet>,
    distance: Column,
    direction: Column,
    people: BitSet,
}

impl Columns {
    pub(super) fn new<'a>(nodes: impl Iterator<Item = &'a Node>, size: usize) -> Self {
        let mut columns = Self {
            values: vec![BitSet::new(size); AttributeValue::COUNT],
            known: vec![BitSet::new(size); Attribute::ALL.len()],
            distance: Column::new(DistanceWord::ALL.len(), size),
            direction: Column::new(DIRECTIONS, size),
            people: BitSet::new(size),
        };
        nodes.enumerate().for_each(|(number, node)| columns.put(number, node));
        columns
    }

    fn put(&mut self, number: usize, node: &Node) {
        for value in node.attributes.beliefs().filter_map(AttributeBelief::best) {
            self.values[value.place()].insert(number);
            self.known[value.attribute() as usize].insert(number);
        }
        let place = node.from_robot.unwrap_or_default();
        self.distance.put(number, place.distance.map(|v| v as usize));
        self.direction.put(number, place.direction.map(direction_code));
        if node.category == PERSON {
            self.people.insert(number);
        }
    }

    pub(super) fn people_mut(&mut self) -> &mut BitSet {
        &mut self.people
    }

    /// People; ends of edges that are no nodes count as what their id's class is.
    #[must_use]
    #[inline]
    pub fn people(&self) -> &BitSet {
        &self.people
    }

    /// Those of whom a value of an attribute is the most probable, and those of whom the attribute is known.
    #[must_use]
    #[inline]
    pub fn attribute(&self, value: AttributeValue) -> (&BitSet, &BitSet) {
        (&self.values[value.place()], &self.known[value.attribute() as usize])
    }

    /// Those so far from the robot, and those at a known distance.
    #[must_use]
    #[inline]
    pub fn distance(&self, value: DistanceWord) -> (&BitSet, &BitSet) {
        (&self.distance.values[value as usize], &self.distance.known)
    }

    /// Those in this direction from the robot, and those in a known one.
    #[must_use]
    #[inline]
    pub fn direction(&self, value: Direction) -> (&BitSet, &BitSet) {
        (&self.direction.values[direction_code(value)], &self.direction.known)
    }
}

/// Every direction has its own place below [`DIRECTIONS`].
const _: () = assert!(Elevation::ALL.len() * Sector::ALL.len() == DIRECTIONS);
