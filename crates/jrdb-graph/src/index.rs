//! A scene graph that can be searched: nodes by number, sets by value, edges by place.

mod adjacency;
mod columns;
mod ids;

use std::sync::{Arc, OnceLock};

use jrdb_types::detection::PERSON;
use jrdb_types::entity::Between;
use jrdb_types::{
    Capabilities, Direction, DistanceWord, EdgeRelation, EntityId, Node, SceneGraph,
    SpatialRelation,
};

use petgraph::unionfind::UnionFind;

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
    tables: Arc<Tables>,
}

/// All that an index holds besides the graph: places in the graph's lists, and sets of numbers.
#[derive(Debug)]
pub(crate) struct Tables {
    /// Where the numbered nodes are in the scene's list.
    nodes: Vec<u32>,
    ids: Ids,
    outside: Vec<End>,
    columns: Columns,
    /// Edges in the order of their ends.
    ends: Vec<Ends>,
    /// Made when they are first asked for: selections do without them.
    outgoing: OnceLock<Rows>,
    incoming: OnceLock<Rows>,
    runs: Runs,
    /// The one between, the two ends, and the entry's place in the scene's list.
    between: Vec<(u32, [u32; 2], u32)>,
    /// What occurs in the graph; made when it is first asked for.
    occurring: OnceLock<Capabilities>,
}

/// One end of an edge of the scene's list.
#[derive(Debug, Clone, Copy)]
struct End {
    edge: u32,
    is_from: bool,
}

impl End {
    fn id(self, scene: &SceneGraph) -> &EntityId {
        let edge = &scene.edges[self.edge as usize];
        if self.is_from { &edge.from } else { &edge.to }
    }
}

impl<'a> GraphIndex<'a> {
    /// Indexes a graph.
    #[must_use]
    pub fn new(scene: &'a SceneGraph) -> Self {
        tracing::trace!(target: "jrdb::index", frame = %scene.frame);
        Self::over(scene, Arc::new(Tables::new(scene)))
    }

    /// The index of a graph whose tables were made before.
    pub(crate) fn over(scene: &'a SceneGraph, tables: Arc<Tables>) -> Self {
        Self { scene, tables }
    }

    /// What can be kept without the graph, for [`GraphIndex::over`].
    pub(crate) fn into_tables(self) -> Arc<Tables> {
        self.tables
    }

    /// The graph itself.
    #[must_use]
    pub fn scene(&self) -> &'a SceneGraph {
        self.scene
    }

    /// What could have been seen: what the graph states, or what occurs in it.
    #[must_use]
    pub fn capabilities(&self) -> &Capabilities {
        let occurring = || jrdb_types::graph::occurring(self.scene);
        let stated = self.scene.capabilities.as_ref();
        stated.unwrap_or_else(|| self.tables.occurring.get_or_init(occurring))
    }

    /// How many nodes there are: they have the numbers below.
    #[must_use]
    pub fn node_count(&self) -> usize {
        self.tables.nodes.len()
    }

    /// How many numbers there are: nodes and ends that are no nodes.
    #[must_use]
    #[inline]
    pub fn size(&self) -> usize {
        self.tables.nodes.len() + self.tables.outside.len()
    }

    /// The node of a number; none for an end that is no node.
    #[must_use]
    pub fn node(&self, number: usize) -> Option<&'a Node> {
        self.tables.nodes.get(number).map(|&place| &self.scene.nodes[place as usize])
    }

    /// The nodes with their numbers, in the order of their ids.
    pub fn nodes(&self) -> impl Iterator<Item = (usize, &'a Node)> + '_ {
        self.tables.nodes.iter().map(|&place| &self.scene.nodes[place as usize]).enumerate()
    }

    /// The id of a number below [`Self::size`].
    #[must_use]
    pub fn id(&self, number: usize) -> Option<&'a EntityId> {
        let outside = || {
            let end = self.tables.outside.get(number - self.tables.nodes.len());
            end.map(|end| end.id(self.scene))
        };
        self.node(number).map_or_else(outside, |node| Some(&node.id))
    }

    /// The number of an id.
    #[must_use]
    pub fn number(&self, id: &EntityId) -> Option<usize> {
        self.tables.number(id, self.scene)
    }

    /// Who has which value.
    #[must_use]
    #[inline]
    pub fn columns(&self) -> &Columns {
        &self.tables.columns
    }

    /// Edges from a thing.
    #[must_use]
    pub fn outgoing(&self, number: usize) -> Row<'_> {
        let rows = || adjacency::outgoing(&self.tables.ends, self.size());
        self.tables.outgoing.get_or_init(rows).row(number)
    }

    /// Edges to a thing.
    #[must_use]
    pub fn incoming(&self, number: usize) -> Row<'_> {
        let rows = || adjacency::incoming(&self.tables.ends, self.size());
        self.tables.incoming.get_or_init(rows).row(number)
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
        self.tables.runs.run(number, direction, distance)
    }

    /// A number for each connected component: equal numbers for those that some relations join, directly or through
    /// others, in either direction.
    ///
    /// `is_member` decides which things take part; of the others each is alone.
    #[must_use]
    pub fn components(
        &self,
        is_member: impl Fn(usize) -> bool,
        joins: impl Fn(&EdgeRelation) -> bool,
    ) -> Vec<usize> {
        let mut sets = UnionFind::new(self.size());
        for from in (0..self.size()).filter(|&from| is_member(from)) {
            let row = self.outgoing(from);
            for (&to, &edge) in row.others.iter().zip(row.edges) {
                if is_member(to as usize) && joins(self.relation(edge)) {
                    sets.union(from, to as usize);
                }
            }
        }
        sets.into_labeling()
    }

    /// Between which two a thing is, as numbers, with the entry that says so.
    pub fn between(&self, middle: usize) -> impl Iterator<Item = ([usize; 2], &'a Between)> + '_ {
        let between = &self.tables.between;
        let low = between.partition_point(|entry| (entry.0 as usize) < middle);
        let of_middle = between[low..].iter().take_while(move |e| e.0 as usize == middle);
        of_middle.map(|&(_, [first, second], place)| {
            ([first as usize, second as usize], &self.scene.between[place as usize])
        })
    }
}

impl Tables {
    fn new(scene: &SceneGraph) -> Self {
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
        for (end, number) in outside.iter().zip(nodes.len()..) {
            if end.id(scene).class == class {
                columns.people_mut().insert(number);
            }
        }
        let ends = adjacency::in_order(ends, size);
        let runs = adjacency::runs(&ends, size);
        let (outgoing, incoming, between, occurring) = Default::default();
        let mut tables = Self {
            nodes,
            ids,
            outside,
            columns,
            ends,
            outgoing,
            incoming,
            runs,
            between,
            occurring,
        };
        tables.between = tables.numbered_between(scene);
        tables
    }

    fn numbered_between(&self, scene: &SceneGraph) -> Vec<(u32, [u32; 2], u32)> {
        let entries = scene.between.iter().zip(0..);
        let mut between: Vec<_> = entries
            .filter_map(|(entry, place)| {
                let [first, second] = &entry.ends;
                let ends = [self.number(first, scene)? as u32, self.number(second, scene)? as u32];
                Some((self.number(&entry.middle, scene)? as u32, ends, place))
            })
            .collect();
        between.sort_by_key(|&(middle, ends, _)| (middle, ends));
        between
    }

    fn number(&self, id: &EntityId, scene: &SceneGraph) -> Option<usize> {
        match self.ids.find(id, &mut 0) {
            NOWHERE => {
                let place = self.outside.binary_search_by(|end| end.id(scene).cmp(id)).ok()?;
                Some(self.nodes.len() + place)
            }
            number => Some(number as usize),
        }
    }
}

/// The ends of the scene's edges as numbers, and those that are no nodes, sorted by their ids.
fn ends(scene: &SceneGraph, ids: &Ids) -> (Vec<Ends>, Vec<End>) {
    let (mut from_class, mut to_class) = (0, 0);
    let mut outside = Vec::new();
    let mut ends = Vec::with_capacity(scene.edges.len());
    for (edge, place) in scene.edges.iter().zip(0..) {
        let from = ids.find(&edge.from, &mut from_class);
        let to = ids.find(&edge.to, &mut to_class);
        if from == NOWHERE {
            outside.push(End { edge: place, is_from: true });
        }
        if to == NOWHERE {
            outside.push(End { edge: place, is_from: false });
        }
        let code = adjacency::place_code(&edge.relation);
        ends.push(Ends { from, to, edge: place, code });
    }
    outside.sort_by_key(|end| end.id(scene));
    outside.dedup_by_key(|end| end.id(scene));
    if !outside.is_empty() {
        number_outside(scene, &mut ends, &outside);
    }
    ends.retain(|ends| ends.from != ends.to);
    (ends, outside)
}

fn number_outside(scene: &SceneGraph, ends: &mut [Ends], outside: &[End]) {
    let first = scene.nodes.len() as u32;
    let number = |id: &EntityId| {
        let place = outside.binary_search_by(|end| end.id(scene).cmp(id));
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
