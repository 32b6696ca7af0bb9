//! What perception can see: absence is evidence only for what could have been seen.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use crate::attribute::Attribute;
use crate::object::{self, PERSON};
use crate::query::Category;

/// A list of what can be seen, or "open": anything that there is a word for. As JSON a list or `"open"`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(untagged)]
pub enum Vocabulary<T: Ord> {
    /// These and no others.
    Listed(BTreeSet<T>),
    /// Anything.
    Open(Open),
}

/// The word for a vocabulary without limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Open {
    /// Anything can be seen.
    Open,
}

impl<T: Ord> Vocabulary<T> {
    /// Anything.
    pub const OPEN: Self = Self::Open(Open::Open);

    /// Whether anything can be seen.
    #[must_use]
    pub const fn is_open(&self) -> bool {
        matches!(self, Self::Open(_))
    }

    /// Whether one of those that can be seen is as asked; true if anything can be seen.
    pub fn any(&self, is_meant: impl FnMut(&T) -> bool) -> bool {
        match self {
            Self::Open(_) => true,
            Self::Listed(listed) => listed.iter().any(is_meant),
        }
    }

    /// Adds what another vocabulary has.
    pub fn unite(&mut self, other: Self) {
        match (&mut *self, other) {
            (Self::Listed(own), Self::Listed(others)) => own.extend(others),
            _ => *self = Self::OPEN,
        }
    }
}

impl<T: Ord> FromIterator<T> for Vocabulary<T> {
    fn from_iter<I: IntoIterator<Item = T>>(items: I) -> Self {
        Self::Listed(items.into_iter().collect())
    }
}

/// Whether the sensors that locate things covered everything around the robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Coverage {
    /// Every LiDAR of the rig gave a usable sweep.
    #[default]
    Complete,
    /// A sweep is missing or unusable: a thing found at a place is there, but a place where nothing was found may
    /// not be empty.
    Partial,
}

impl Coverage {
    fn is_complete(&self) -> bool {
        *self == Self::Complete
    }
}

/// What perception can see in a frame, and what it cannot.
///
/// ```
/// use jrdb_types::{Capabilities, query::Category};
/// let detector = Capabilities { categories: ["person".into()].into_iter().collect(), ..Capabilities::none() };
/// assert!(detector.sees_category(&Category::Person));
/// assert!(!detector.sees_category(&Category::Class("table".into())), "no table seen is no news");
/// assert_eq!(serde_json::to_value(Capabilities::open()).unwrap()["categories"], "open");
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Capabilities {
    /// Classes of things: `person`, and objects' classes in the detector's words.
    pub categories: Vocabulary<String>,
    /// Attributes of people.
    pub attributes: Vocabulary<Attribute>,
    /// Labels of interactions.
    pub interactions: Vocabulary<String>,
    /// Whether places where nothing was found are known to be empty.
    #[serde(default, skip_serializing_if = "Coverage::is_complete")]
    pub places: Coverage,
}

impl Default for Capabilities {
    /// Everything: a graph that somebody made by hand holds all that there is.
    fn default() -> Self {
        Self::open()
    }
}

impl Capabilities {
    /// Anything can be seen.
    #[must_use]
    pub const fn open() -> Self {
        Self {
            categories: Vocabulary::OPEN,
            attributes: Vocabulary::OPEN,
            interactions: Vocabulary::OPEN,
            places: Coverage::Complete,
        }
    }

    /// Nothing was seen: the image or the file could not be used.
    #[must_use]
    pub const fn none() -> Self {
        Self {
            categories: Vocabulary::Listed(BTreeSet::new()),
            attributes: Vocabulary::Listed(BTreeSet::new()),
            interactions: Vocabulary::Listed(BTreeSet::new()),
            places: Coverage::Complete,
        }
    }

    /// Adds what another source can see.
    pub fn unite(&mut self, other: Self) {
        self.categories.unite(other.categories);
        self.attributes.unite(other.attributes);
        self.interactions.unite(other.interactions);
    }

    /// Whether things of this kind would have been seen. Of "objects" one class is enough.
    #[must_use]
    pub fn sees_category(&self, category: &Category) -> bool {
        match category {
            Category::Robot => true,
            Category::Person => self.categories.any(|class| class == PERSON),
            Category::Object => self.categories.any(|class| class != PERSON),
            Category::Anything => self.categories.any(|_| true),
            Category::Class(asked) => self.categories.any(|class| object::may_be(class, asked)),
        }
    }

    /// Whether the attribute is known of people.
    #[must_use]
    pub fn sees_attribute(&self, attribute: Attribute) -> bool {
        self.attributes.any(|own| *own == attribute)
    }

    /// Whether an interaction of this label would have been seen.
    #[must_use]
    pub fn sees_interaction(&self, label: &str) -> bool {
        self.interactions.any(|own| own == label)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_and_the_open_vocabulary_are_read_as_they_are_written() {
        let text = r#"{"categories":["person"],"attributes":["gender"],"interactions":"open"}"#;
        let read: Capabilities = serde_json::from_str(text).unwrap();
        assert_eq!(read.places, Coverage::Complete);
        assert_eq!(serde_json::to_string(&read).unwrap(), text);
    }
}
