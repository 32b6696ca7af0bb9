//! Who has which value: one set per word.

use jrdb_types::detection::PERSON;
use jrdb_types::vocab::{Color, Elevation, Sector};
use jrdb_types::{Action, Age, Direction, DistanceWord, Gender, Node, Race};

use crate::BitSet;

/// Words in `Direction`: eight sectors at three heights.
pub(super) const DIRECTIONS: usize = 24;

/// Place of a direction in a list of all: sectors, level ones first.
pub(super) fn direction_code(direction: Direction) -> usize {
    direction.elevation as usize * Sector::ALL.len() + direction.sector as usize
}

/// The sets of one attribute.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
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

    /// Those of whom it is known.
    #[must_use]
    pub fn known(&self) -> &BitSet {
        &self.known
    }
}

/// Sets of node numbers by what nodes are: the best value of each belief, the words of where the robot sees them.
#[derive(Debug, Clone, PartialEq)]
pub struct Columns {
    age: Column,
    gender: Column,
    race: Column,
    action: Column,
    upper_color: Column,
    lower_color: Column,
    distance: Column,
    direction: Column,
    people: BitSet,
}

impl Columns {
    pub(super) fn new<'a>(nodes: impl Iterator<Item = &'a Node>, size: usize) -> Self {
        let column = |values| Column::new(values, size);
        let mut columns = Self {
            age: column(Age::ALL.len()),
            gender: column(Gender::ALL.len()),
            race: column(Race::ALL.len()),
            action: column(Action::ALL.len()),
            upper_color: column(Color::ALL.len()),
            lower_color: column(Color::ALL.len()),
            distance: column(DistanceWord::ALL.len()),
            direction: column(DIRECTIONS),
            people: BitSet::new(size),
        };
        nodes.enumerate().for_each(|(number, node)| columns.put(number, node));
        columns
    }

    fn put(&mut self, number: usize, node: &Node) {
        let believed = &node.attributes;
        self.age.put(number, believed.age.best().map(|v| v as usize));
        self.gender.put(number, believed.gender.best().map(|v| v as usize));
        self.race.put(number, believed.race.best().map(|v| v as usize));
        self.action.put(number, believed.action.best().map(|v| v as usize));
        self.upper_color.put(number, believed.upper_color.best().map(|v| v as usize));
        self.lower_color.put(number, believed.lower_color.best().map(|v| v as usize));
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

    /// Those of this age group, and of known age.
    #[must_use]
    #[inline]
    pub fn age(&self, value: Age) -> (&BitSet, &BitSet) {
        (&self.age.values[value as usize], &self.age.known)
    }

    /// Those of this gender, and of known gender.
    #[must_use]
    #[inline]
    pub fn gender(&self, value: Gender) -> (&BitSet, &BitSet) {
        (&self.gender.values[value as usize], &self.gender.known)
    }

    /// Those with this race word, and with any.
    #[must_use]
    #[inline]
    pub fn race(&self, value: Race) -> (&BitSet, &BitSet) {
        (&self.race.values[value as usize], &self.race.known)
    }

    /// Those who do this, and those of whom it is known what they do.
    #[must_use]
    #[inline]
    pub fn action(&self, value: Action) -> (&BitSet, &BitSet) {
        (&self.action.values[value as usize], &self.action.known)
    }

    /// Those who wear this colour above the waist, and those of whom a colour is known there.
    #[must_use]
    #[inline]
    pub fn upper_color(&self, value: Color) -> (&BitSet, &BitSet) {
        (&self.upper_color.values[value as usize], &self.upper_color.known)
    }

    /// Those who wear this colour below the waist, and those of whom a colour is known there.
    #[must_use]
    #[inline]
    pub fn lower_color(&self, value: Color) -> (&BitSet, &BitSet) {
        (&self.lower_color.values[value as usize], &self.lower_color.known)
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
