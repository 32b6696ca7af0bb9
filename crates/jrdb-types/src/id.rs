//! Names of frames and of the things seen in them.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// One frame of a recorded sequence.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FrameId {
    /// Name of the sequence, for example `bytes-cafe-2019-02-07_0`.
    pub sequence: String,
    /// Number of the frame in it, the integer stem of its files.
    pub frame: u32,
}

impl fmt::Display for FrameId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{:06}", self.sequence, self.frame)
    }
}

/// Identity of a person or object within a sequence: a class and a number, `pedestrian:12`.
///
/// Ids order by class, then number. As JSON: the text.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(try_from = "String", into = "String")]
#[cfg_attr(feature = "schema", schemars(with = "String"))]
pub struct EntityId {
    /// Class of the thing, in JRDB `pedestrian` for people.
    pub class: String,
    /// Number among the things of that class.
    pub number: u32,
}

impl EntityId {
    /// The id `class:number`.
    #[must_use]
    pub fn new(class: &str, number: u32) -> Self {
        Self { class: class.into(), number }
    }
}

impl EntityId {
    /// The id as people read it: `#12`, or `table:1` for what is not a person.
    #[must_use]
    pub fn short(&self) -> String {
        match self.class.as_str() {
            "pedestrian" | "person" => format!("#{}", self.number),
            _ => self.to_string(),
        }
    }
}

impl fmt::Display for EntityId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.class, self.number)
    }
}

/// A text that is not `class:number`.
#[derive(Debug, thiserror::Error)]
#[error("expected an id like \"pedestrian:12\", found {0:?}")]
pub struct IdError(pub String);

impl FromStr for EntityId {
    type Err = IdError;

    fn from_str(text: &str) -> Result<Self, IdError> {
        text.rsplit_once(':')
            .and_then(|(class, number)| Some(Self::new(class, number.parse().ok()?)))
            .ok_or_else(|| IdError(text.into()))
    }
}

impl TryFrom<String> for EntityId {
    type Error = IdError;

    fn try_from(text: String) -> Result<Self, IdError> {
        text.parse()
    }
}

impl From<EntityId> for String {
    fn from(id: EntityId) -> Self {
        id.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_survive_the_round_trip_and_order_by_number() {
        let id: EntityId = "pedestrian:12".parse().unwrap();
        assert_eq!(id.to_string(), "pedestrian:12");
        assert!("pedestrian:9".parse::<EntityId>().unwrap() < id);
        assert_eq!(
            "twelve".parse::<EntityId>().unwrap_err().to_string(),
            r#"expected an id like "pedestrian:12", found "twelve""#
        );
    }
}
