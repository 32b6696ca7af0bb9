//! What a word or phrase of the lexicon means.

use jrdb_types::query::{Category, Order, Property, RelationKind};
use jrdb_types::vocab::{Color, Elevation, Sector};
use jrdb_types::{Condition, DistanceWord};

use super::role::Roles;

/// What a word or phrase means: in one or several of these respects.
#[derive(Debug, Default)]
pub(crate) struct Entry {
    pub(crate) roles: Roles,
    /// What kind of thing it names.
    pub(crate) category: Option<Category>,
    /// What it says of the thing it names or stands with.
    pub(crate) implies: Vec<Condition>,
    /// What holds between the subject and the thing behind it.
    pub(crate) relation: Option<RelationKind>,
    /// What holds besides, with the same thing.
    pub(crate) relation_too: Option<RelationKind>,
    /// Label when it is done with people.
    pub(crate) people: Option<String>,
    /// Label when it is done with an object.
    pub(crate) object: Option<String>,
    pub(crate) distance: Option<DistanceWord>,
    pub(crate) sector: Option<Sector>,
    pub(crate) elevation: Option<Elevation>,
    pub(crate) number: Option<f64>,
    pub(crate) limit: Option<Limit>,
    /// Metres of the unit.
    pub(crate) unit: Option<f64>,
    pub(crate) order: Option<(Measured, Order)>,
    pub(crate) asks: Option<Property>,
    pub(crate) unsupported: Option<String>,
    pub(crate) color: Option<Color>,
    pub(crate) garment: Option<Garment>,
}

impl Entry {
    /// All that holds between the subject and the thing behind it.
    pub(crate) fn kinds(&self) -> Vec<RelationKind> {
        self.relation.iter().chain(&self.relation_too).cloned().collect()
    }
}

/// What a superlative or comparative is about; a distance is to the robot unless a thing is named.
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
