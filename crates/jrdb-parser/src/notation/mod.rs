//! The text form of the query algebra: the output of `jrdb parse`, which is also accepted instead
//! of English.
//!
//! ```text
//! find person[female, sitting, at direction=left: person[child], distance=close]
//! find person[male]{least distance to robot}
//! exists person[child, between person[(young or elderly)]: person[(young or elderly)]]
//! ```
//!
//! `docs/formats.md` has the grammar. [`write()`] and [`read()`] are inverse to each other.

mod cursor;
mod error;
mod read;
mod token;
mod write;

pub use error::NotationError;
pub use read::read;
pub use write::write;

use jrdb_types::query::Property;

/// Keywords of the properties that a question can ask for.
const PROPERTIES: [(Property, &str); 11] = [
    (Property::Age, "age"),
    (Property::Gender, "gender"),
    (Property::Race, "race"),
    (Property::Action, "action"),
    (Property::Distance, "distance"),
    (Property::Direction, "direction"),
    (Property::SocialInteraction, "social-interaction"),
    (Property::PeopleAround, "people-around"),
    (Property::ObjectInteraction, "object-interaction"),
    (Property::ObjectsAround, "objects-around"),
    (Property::Category, "category"),
];

/// Whether a text is notation and not English: only notation has these brackets.
///
/// ```
/// use jrdb_parser::notation::is_notation;
/// assert!(is_notation("find person[female]"));
/// assert!(!is_notation("find the woman next to me (the robot)"));
/// ```
#[must_use]
pub fn is_notation(text: &str) -> bool {
    text.contains(['[', '{'])
}

#[cfg(test)]
mod tests;
