//! How the parser reads what English leaves open.

use serde::{Deserialize, Serialize};

/// How the parser reads what English leaves open.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ParserConfig {
    /// From where "left of the man" is told.
    pub viewpoint: OfPerson,
}

/// Whose left "left of the man" is. A table has no left of its own: there it is always the robot's.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OfPerson {
    /// The man's own left; an issue says so. The default, for the benchmark tells directions between people in their own
    /// frames.
    #[default]
    Own,
    /// The left of the two as the robot sees them.
    Robot,
}
