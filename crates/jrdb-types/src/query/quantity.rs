//! How many things there must be, and of how many a statement must hold.

use serde::{Deserialize, Serialize};

/// How many things there must be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Quantity {
    /// At least so many.
    pub at_least: u32,
    /// At most so many; no limit when absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_most: Option<u32>,
}

impl Quantity {
    /// At least one: "a", "some", "any".
    pub const SOME: Self = Self { at_least: 1, at_most: None };
    /// None at all: "no", "nobody".
    pub const NONE: Self = Self { at_least: 0, at_most: Some(0) };

    /// This many, no more and no fewer.
    #[must_use]
    pub const fn exactly(number: u32) -> Self {
        Self { at_least: number, at_most: Some(number) }
    }

    /// This many or more.
    #[must_use]
    pub const fn at_least(number: u32) -> Self {
        Self { at_least: number, at_most: None }
    }

    /// Whether a number is as asked.
    #[must_use]
    pub fn holds(self, number: usize) -> bool {
        let number = u32::try_from(number).unwrap_or(u32::MAX);
        number >= self.at_least && self.at_most.is_none_or(|most| number <= most)
    }
}

impl Default for Quantity {
    fn default() -> Self {
        Self::SOME
    }
}

/// How many of those meant a statement must hold of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Share {
    /// Of all: "all", "every", "both".
    All,
    /// Of none: "none of", "neither".
    None,
    /// Of more than half.
    Most,
    /// Of half or more.
    Half,
}
