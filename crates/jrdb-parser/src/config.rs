//! How ambiguous English is read.

use serde::{Deserialize, Serialize};

/// How the parser reads what English leaves open.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ParserConfig {
    /// The viewpoint of "left of the man".
    pub viewpoint: OfPerson,
}

/// Whose left is meant in "left of the man". A table has no left of its own, so "left of the table"
/// is always as the robot sees it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OfPerson {
    /// The man's own left, which an issue reports. This is the default because the benchmark states
    /// directions between people in their own frames.
    #[default]
    Own,
    /// The left as the robot sees both.
    Robot,
}
