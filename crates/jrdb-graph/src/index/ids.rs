//! From an id to a node's number, fast.

use jrdb_types::{EntityId, Node};

/// A class whose numbers spread over at most so many times their count has a table; others are searched.
const TABLE_SPREAD: usize = 4;

/// Number that no node has.
pub(super) const NOWHERE: u32 = u32::MAX;

/// The nodes of one class: numbers of ids on one side, of nodes on the other.
#[derive(Debug)]
struct Class {
    name: String,
    /// Number of the class's first node.
    first: u32,
    /// The ids' numbers, ascending.
    numbers: Vec<u32>,
    /// Node of each id number from the first on, [`NOWHERE`] for gaps; empty where gaps are too many.
    table: Vec<u32>,
}

/// Finds nodes by id.
#[derive(Debug)]
pub(super) struct Ids {
    classes: Vec<Class>,
}

impl Ids {
    /// Nodes in the order of their ids; of equal ids the first is found.
    pub(super) fn new<'a>(nodes: impl Iterator<Item = &'a Node>) -> Self {
        let mut classes: Vec<Class> = Vec::new();
        for (node, number) in nodes.zip(0..) {
            let name = node.id.class.as_str();
            if classes.last().is_none_or(|class| class.name != name) {
                let (name, numbers, table) = (name.to_owned(), Vec::new(), Vec::new());
                classes.push(Class { name, first: number, numbers, table });
            }
            if let Some(class) = classes.last_mut() {
                class.numbers.push(node.id.number);
            }
        }
        classes.iter_mut().for_each(Class::make_table);
        Self { classes }
    }

    /// The node's number, or [`NOWHERE`]; `hint` is the class last found and is kept up to date.
    #[inline]
    pub(super) fn find(&self, id: &EntityId, hint: &mut usize) -> u32 {
        if self.classes.get(*hint).is_none_or(|class| class.name != id.class) {
            let Ok(place) = self.classes.binary_search_by(|c| c.name.as_str().cmp(&id.class))
            else {
                return NOWHERE;
            };
            *hint = place;
        }
        self.classes[*hint].find(id.number)
    }
}

impl Class {
    fn make_table(&mut self) {
        let (Some(&low), Some(&high)) = (self.numbers.first(), self.numbers.last()) else { return };
        let spread = (high - low) as usize;
        if spread / TABLE_SPREAD <= self.numbers.len() {
            self.table = vec![NOWHERE; spread + 1];
            for (&number, place) in self.numbers.iter().zip(self.first..) {
                let entry = &mut self.table[(number - low) as usize];
                *entry = place.min(*entry);
            }
        }
    }

    #[inline]
    fn find(&self, number: u32) -> u32 {
        if self.table.is_empty() {
            let place = self.numbers.partition_point(|&n| n < number);
            let is_here = self.numbers.get(place) == Some(&number);
            return if is_here { self.first + place as u32 } else { NOWHERE };
        }
        let above = self.numbers.first().and_then(|&low| number.checked_sub(low));
        above.and_then(|above| self.table.get(above as usize)).copied().unwrap_or(NOWHERE)
    }
}
