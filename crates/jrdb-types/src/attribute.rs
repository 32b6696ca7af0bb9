//! What can be believed and asked of a person: one table with a row per attribute, and what follows from it.

mod belief;
mod serial;
mod table;
mod value;

pub use belief::{AttributeBelief, Attributes, Belief};
pub(crate) use serial::{ValueOf, unknown};
pub use value::{
    Attribute, AttributeNotation, AttributeRow, AttributeSource, AttributeValue, AttributeWording,
};
