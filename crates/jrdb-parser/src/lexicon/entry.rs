//! What a word or phrase of the lexicon means.

use jrdb_types::query::{Category, Order, Property, RelationKind};
use jrdb_types::vocab::{Color, Elevation, Sector};
use jrdb_types::{Condition, DistanceWord};

use super::role::Roles;

/// The meanings of a word or phrase. It may have several.
#[derive(Debug, Default)]
pub(crate) struct Entry {
    pub(crate) roles: Roles,
    /// The category that it names.
    pub(crate) category: Option<Category>,
    /// The conditions that it implies for the entity that it names or describes.
    pub(crate) implies: Vec<Condition>,
    /// The relation between the subject and the noun behind it.
    pub(crate) relation: Option<RelationKind>,
    /// A second relation to the same noun.
    pub(crate) relation_too: Option<RelationKind>,
    /// Label of the interaction with people.
    pub(crate) people: Option<String>,
    /// Label of the interaction with an object.
    pub(crate) object: Option<String>,
    pub(crate) distance: Option<DistanceWord>,
    pub(crate) sector: Option<Sector>,
    pub(crate) elevation: Option<Elevation>,
    pub(crate) number: Option<f64>,
    pub(crate) limit: Option<Limit>,
    /// The unit in metres.
    pub(crate) unit: Option<f64>,
    pub(crate) order: Option<(Measured, Order)>,
    pub(crate) asks: Option<Property>,
    pub(crate) unsupported: Option<String>,
    pub(crate) color: Option<Color>,
    pub(crate) garment: Option<Garment>,
    /// What is true of the person who wears it.
    pub(crate) worn: Option<Box<Condition>>,
}

impl Entry {
    /// All relations between the subject and the noun behind it.
    pub(crate) fn kinds(&self) -> Vec<RelationKind> {
        self.relation.iter().chain(&self.relation_too).cloned().collect()
    }
}

/// The measure of a superlative or comparative. A distance is to the robot unless another reference
/// is named.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Measured {
    Distance,
    FromLeft,
    Height,
    Age,
    Speed,
}

/// How a number limits what it counts or measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Limit {
    AtMost,
    LessThan,
    AtLeast,
    MoreThan,
    Exactly,
    About,
}

/// Where a piece of clothing is worn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Garment {
    /// Above the waist.
    Upper,
    /// Below the waist.
    Lower,
    /// Above, below or both.
    Any,
    /// On the head, the feet or elsewhere.
    Other,
}
