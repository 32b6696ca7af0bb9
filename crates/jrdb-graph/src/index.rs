//! A scene graph that can be searched: nodes by number, sets by value, edges by place.

mod adjacency;
mod columns;
mod ids;

use std::sync::OnceLock;

use jrdb_types::detection::PERSON;
use jrdb_types::entity::Between;
use jrdb_types::{
    Direction, DistanceWord, EdgeRelation, EntityId, Node, SceneGraph, SpatialRelation,
};

use adjacency::{Ends, Rows, Runs};
use ids::{Ids, NOWHERE};

pub use adjacency::Row;
pub use columns::Columns;

/// Class of people's ids in JRDB.
const PEDESTRIAN: &str = "pedestrian";

/// A [`SceneGraph`] with its nodes numbered and everything findable by number.
///
/// Nodes have the numbers 0, 1, 2 ... in the order of their ids. Ends of edges that are no nodes (the benchmark has edges to
/// people it does not describe) follow, in the order of their ids: nothing but their id is known of them. An edge from a thing
/// to itself says nothing and is left out.
///
/// Building takes time in proportion to nodes and edges. A graph sorted as [`SceneGraph`] says is taken as it is; another is sorted.
#[derive(Debug)]
pub struct GraphIndex<'a> {
    scene: &'a SceneGraph,
    /// Where the numbered nodes are in the scene's list.
    nodes: Vec<u32>,
    ids: Ids<'a>,
    outside: Vec<&'a EntityId>,
    columns: Columns,
    /// Edges in the order of their ends.
    ends: Vec<Ends>,
    /// Made when they are first asked for: selections do without them.
    outgoing: OnceLock<Rows>,
    incoming: OnceLock<Rows>,
    runs: Runs,
    between: Vec<(u32, [u32; 2], &'a Between)>,
}

impl<'a> GraphIndex<'a> {
    /// Indexes a graph.
    #[must_use]
    pub fn new(scene: &'a SceneGraph) -> Self {
        let mut nodes: Vec<u32> = (0..scene.nodes.len() as u32).collect();
        if !scene.nodes.is_sorted_by(|a, b| a.id <= b.id) {
            nodes.sort_by_key(|&place| &scene.nodes[place as usize].id);
        }
        let in_order = || nodes.iter().map(|&place| &scene.nodes[place as usize]);
        let ids = Ids::new(in_order());
        let (ends, outside) = ends(scene, &ids);
        let size = nodes.len() + outside.len();
        let mut columns = Columns::new(in_order(), size);
        let class = in_order().find(|node| node.category == PERSON).map(|node| &node.id.class);
        let class = class.map_or(PEDESTRIAN, String::as_str);
        for (id, number) in outside.iter().zip(nodes.len()..) {
            if id.class == class {
                columns.people_mut().insert(number);
            }
        }
        let ends = adjacency::in_order(ends, size);
        let runs = adjacency::runs(&ends, size);
        let (outgoing, incoming, between) = Default::default();
        let mut index =
            Self { scene, nodes, ids, outside, columns, ends, outgoing, incoming, runs, between };
        index.between = index.numbered_between();
        index
    }

    fn numbered_between(&self) -> Vec<(u32, [u32; 2], &'a Between)> {
        let mut between: Vec<_> = self
            .scene
            .between
            .iter()
            .filter_map(|entry| {
                let [first, second] = &entry.ends;
                let ends = [self.number(first)? as u32, self.number(second)? as u32];
                Some((self.number(&entry.middle)? as u32, ends, entry))
            })
            .collect();
        between.sort_by_key(|&(middle, ends, _)| (middle, ends));
        between
    }

    /// The graph itself.
    #[must_use]
    pub fn scene(&self) -> &'a SceneGraph {
        self.scene
    }

    /// How many nodes there are: they have the numbers below.
    #[must_use]
    pub fn node_count(&self) -> usize {
        self.nodes.len()
    }

    /// How many numbers there are: nodes and ends that are no nodes.
    #[must_use]
    #[inline]
    pub fn size(&self) -> usize {
        self.nodes.len() + self.outside.len()
    }

    /// The node of a number; none for an end that is no node.
    #[must_use]
    pub fn node(&self, number: usize) -> Option<&'a Node> {
        self.nodes.get(number).map(|&place| &self.scene.nodes[place as usize])
    }

    /// The nodes with their numbers, in the order of their ids.
    pub fn nodes(&self) -> impl Iterator<Item = (usize, &'a Node)> + '_ {
        self.nodes.iter().map(|&place| &self.scene.nodes[place as usize]).enumerate()
    }

    /// The id of a number below [`Self::size`].
    #[must_use]
    pub fn id(&self, number: usize) -> Option<&'a EntityId> {
        let outside = || self.outside.get(number - self.nodes.len()).copied();
        self.node(number).map_or_else(outside, |node| Some(&node.id))
    }

    /// The number of an id.
    #[must_use]
    pub fn number(&self, id: &EntityId) -> Option<usize> {
        match self.ids.find(id, &mut 0) {
            NOWHERE => {
                let place = self.outside.binary_search(&id).ok()?;
                Some(self.nodes.len() + place)
            }
            number => Some(number as usize),
        }
    }

    /// Who has which value.
    #[must_use]
    #[inline]
    pub fn columns(&self) -> &Columns {
        &self.columns
    }

    /// Edges from a thing.
    #[must_use]
    pub fn outgoing(&self, number: usize) -> Row<'_> {
        let rows = || adjacency::outgoing(&self.ends, self.size());
        self.outgoing.get_or_init(rows).row(number)
    }

    /// Edges to a thing.
    #[must_use]
    pub fn incoming(&self, number: usize) -> Row<'_> {
        let rows = || adjacency::incoming(&self.ends, self.size());
        self.incoming.get_or_init(rows).row(number)
    }

    /// What an edge of a [`Row`] says.
    #[must_use]
    pub fn relation(&self, edge: u32) -> &'a EdgeRelation {
        &self.scene.edges[edge as usize].relation
    }

    /// Where the other ends of a row's spatial edges are, in the row's order.
    pub fn spatial<'s>(&'s self, row: Row<'s>) -> impl Iterator<Item = &'a SpatialRelation> + 's {
        row.edges.iter().filter_map(|&edge| match self.relation(edge) {
            EdgeRelation::Spatial(relation) => Some(relation),
            _ => None,
        })
    }

    /// What a thing sees in a direction, at a distance or at any: numbers, by distance, then number.
    #[must_use]
    #[inline]
    pub fn seen(
        &self,
        number: usize,
        direction: Direction,
        distance: Option<DistanceWord>,
    ) -> &[u32] {
        self.runs.run(number, direction, distance)
    }

    /// Between which two a thing is, as numbers, with the entry that says so.
    pub fn between(&self, middle: usize) -> impl Iterator<Item = ([usize; 2], &'a Between)> + '_ {
        let low = self.between.partition_point(|entry| (entry.0 as usize) < middle);
        let of_middle = self.between[low..].iter().take_while(move |e| e.0 as usize == middle);
        of_middle.map(|&(_, [first, second], entry)| ([first as usize, second as usize], entry))
    }
}

/// The ends of the scene's edges as numbers, and the ids of those that are no nodes, sorted.
fn ends<'a>(scene: &'a SceneGraph, ids: &Ids<'a>) -> (Vec<Ends>, Vec<&'a EntityId>) {
    let (mut from_class, mut to_class) = (0, 0);
    let mut outside = Vec::new();
    let mut ends = Vec::with_capacity(scene.edges.len());
    for (edge, place) in scene.edges.iter().zip(0..) {
        let from = ids.find(&edge.from, &mut from_class);
        let to = ids.find(&edge.to, &mut to_class);
        if from == NOWHERE {
            outside.push(&edge.from);
        }
        if to == NOWHERE {
            outside.push(&edge.to);
        }
        let code = adjacency::place_code(&edge.relation);
        ends.push(Ends { from, to, edge: place, code });
    }
    outside.sort();
    outside.dedup();
    if !outside.is_empty() {
        number_outside(scene, &mut ends, &outside);
    }
    ends.retain(|ends| ends.from != ends.to);
    (ends, outside)
}

fn number_outside(scene: &SceneGraph, ends: &mut [Ends], outside: &[&EntityId]) {
    let first = scene.nodes.len() as u32;
    let number = |id: &EntityId| {
        let place = outside.binary_search(&id);
        place.map_or(NOWHERE, |place| first + place as u32)
    };
    for ends in ends {
        let edge = &scene.edges[ends.edge as usize];
        if ends.from == NOWHERE {
            ends.from = number(&edge.from);
        }
        if ends.to == NOWHERE {
            ends.to = number(&edge.to);
        }
    }
}

#[cfg(test)]
mod tests;
