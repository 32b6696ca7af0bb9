//! What the robot is told to do with what a question finds.

use serde::{Deserialize, Serialize};

/// An action that a question names. The program finds whom it concerns; the action is up to the robot.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Command {
    /// The verb as spoken, one lower-case word: `follow`.
    pub verb: String,
    /// What is taken, said or given, in the question's words.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub object: Option<String>,
    /// Where to, in the question's words.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub destination: Option<String>,
}
