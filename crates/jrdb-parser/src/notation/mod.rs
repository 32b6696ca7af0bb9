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
mod told;
mod words;
mod write;

pub use error::NotationError;
pub use read::read;
pub use write::write;

use jrdb_types::query::Property;

/// Keyword of a property that can be asked.
fn keyword(property: Property) -> String {
    property.name().replace('_', "-")
}

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
