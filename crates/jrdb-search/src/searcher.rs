//! What every part of the search looks things up in.

use std::borrow::Cow;
use std::cell::OnceCell;
use std::rc::Rc;

use jrdb_graph::{BitSet, GraphIndex};
use jrdb_types::object;
use jrdb_types::query::{Category, Measure};
use jrdb_types::vocab::MatchPolicy;
use jrdb_types::{Capabilities, LateralConvention, Node, Pattern, SpatialRelation};

use crate::group::{self, Membership};
use crate::looks::{Blind, Looks, Seen};
use crate::observer::{Front, Observer};
use crate::{SearchConfig, World};

/// What the closed world of the benchmark sees.
static EVERYTHING: Capabilities = Capabilities::open();

/// A graph, how it is searched, and what was already found out about it.
pub(crate) struct Searcher<'i, 'a> {
    pub(crate) index: &'i GraphIndex<'a>,
    pub(crate) config: SearchConfig,
    pub(crate) sees: &'i Capabilities,
    pub(crate) eyes: &'i dyn Looks,
    pub(crate) seen: Rc<Seen>,
    groups: OnceCell<Vec<Option<Membership>>>,
}

impl<'i, 'a> Searcher<'i, 'a> {
    pub(crate) fn new(index: &'i GraphIndex<'a>, config: &SearchConfig) -> Self {
        Self::seeing(index, config, &Blind)
    }

    /// The same with somebody who can be asked how things look.
    pub(crate) fn seeing(
        index: &'i GraphIndex<'a>,
        config: &SearchConfig,
        eyes: &'i dyn Looks,
    ) -> Self {
        let sees = match config.world {
            World::Closed => &EVERYTHING,
            World::Open => index.capabilities(),
        };
        Self { index, config: *config, sees, eyes, seen: Rc::default(), groups: OnceCell::new() }
    }

    /// The same graph under another policy.
    pub(crate) fn with(&self, policy: MatchPolicy) -> Self {
        let other = Self::seeing(self.index, &self.config.with(policy), self.eyes);
        Self { seen: Rc::clone(&self.seen), ..other }
    }

    pub(crate) fn lateral(&self) -> LateralConvention {
        self.index.scene().lateral
    }

    /// What the robot sees with.
    pub(crate) fn robot_observer(&self) -> Observer<'_> {
        Observer { lateral: self.lateral(), front: Front::OfRobot, config: &self.config }
    }

    /// What somebody of uncertain heading sees with.
    pub(crate) fn person_observer(&self) -> Observer<'_> {
        Observer { front: Front::OfPerson, ..self.robot_observer() }
    }

    /// The numbers of a kind; none for the robot, which is no node.
    #[inline]
    pub(crate) fn kind(&self, category: &Category) -> Cow<'i, BitSet> {
        match category {
            Category::Person => Cow::Borrowed(self.index.columns().people()),
            other => Cow::Owned(self.other_kind(other)),
        }
    }

    fn other_kind(&self, category: &Category) -> BitSet {
        let size = self.index.size();
        let people = self.index.columns().people();
        match category {
            Category::Person => people.clone(),
            Category::Anything => BitSet::below(size, size),
            Category::Robot => BitSet::new(size),
            Category::Object => {
                let mut objects = BitSet::below(size, size);
                objects.subtract(people);
                objects
            }
            Category::Class(name) => {
                let mut set = BitSet::new(size);
                let is_meant = |n| self.class(n).is_some_and(|found| object::may_be(found, name));
                (0..size).filter(|&n| is_meant(n)).for_each(|n| set.insert(n));
                set
            }
        }
    }

    /// Class of a thing: its category, or that of its id where nothing else is known.
    fn class(&self, number: usize) -> Option<&'a str> {
        let node = self.index.node(number);
        node.map_or_else(
            || self.index.id(number).map(|id| id.class.as_str()),
            |node| Some(node.category.as_str()),
        )
    }

    /// Where a node is, seen from the robot: the graph's words, and numbers from its centre where the words have none.
    pub(crate) fn seen_by_robot(&self, node: &Node) -> Option<SpatialRelation> {
        let Some([x, y, z]) = node.center else { return node.from_robot };
        let words = node.from_robot.unwrap_or_default();
        Some(SpatialRelation {
            distance_m: words.distance_m.or_else(|| Some(x.hypot(y).hypot(z))),
            bearing_rad: words.bearing_rad.or_else(|| Some(y.atan2(x))),
            ..words
        })
    }

    /// How many people somebody's group has.
    pub(crate) fn group_size(&self, number: usize) -> Option<u32> {
        self.membership(number).map(|membership| membership.size)
    }

    /// Somebody's group; none if it is unknown.
    pub(crate) fn membership(&self, number: usize) -> Option<Membership> {
        let groups = self.groups.get_or_init(|| group::memberships(self.index, &self.config));
        groups.get(number).copied().flatten()
    }

    /// Whether the graph tells a thing's place in any way, so that it can be said that it is not near something.
    pub(crate) fn has_place(&self, number: usize) -> bool {
        let is_placed = |node: &Node| node.center.is_some() || node.from_robot.is_some();
        let row_says = |row| self.index.spatial(row).next().is_some();
        self.index.node(number).is_some_and(is_placed)
            || row_says(self.index.outgoing(number))
            || row_says(self.index.incoming(number))
    }

    /// The centre of a numbered node.
    pub(crate) fn center(&self, number: usize) -> Option<[f64; 3]> {
        self.index.node(number)?.center
    }
}

/// The pattern that a measure speaks of.
pub(crate) fn measured_pattern(measure: &Measure) -> Option<&Pattern> {
    match measure {
        Measure::DistanceTo(pattern) => Some(pattern),
        _ => None,
    }
}
