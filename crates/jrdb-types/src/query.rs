//! What the parser hands on: a question as conditions on things and on their relations.

use serde::{Deserialize, Serialize};

use crate::artefact::Payload;
use crate::issue::Issue;
use crate::vocab::{Action, Age, Direction, DistanceWord, Gender, Race};

/// What is asked of the things that match.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Task {
    /// Which are they: boxes.
    #[default]
    Find,
    /// How many are there: a number.
    Count,
}

/// What kind of thing is meant.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Category {
    /// A person.
    #[default]
    Person,
    /// Anything that is not a person.
    Object,
    /// Objects of one class, in the graph's words.
    Class(String),
}

/// From whose place a direction between two things is told.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Viewpoint {
    /// Where the partner is, seen from the subject: "who has a woman to his right".
    Subject,
    /// Where the subject is, seen from the partner: "who is to the right of a woman".
    Partner,
}

/// What must hold between subject and partner. Fields that are absent do not matter.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum RelationKind {
    /// A place.
    Spatial {
        /// How far apart.
        #[serde(default)]
        distance: Option<DistanceWord>,
        /// In which direction.
        #[serde(default)]
        direction: Option<Direction>,
        /// Seen from whom.
        viewpoint: Viewpoint,
    },
    /// Something the subject does with the partner.
    Interaction {
        /// JRDB-Social's label.
        label: String,
    },
}

/// A relation to some other thing.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RelationPattern {
    /// What must hold.
    pub kind: RelationKind,
    /// Which things may be the partner.
    pub partner: Pattern,
}

/// One thing asked of a candidate.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Condition {
    /// Age group.
    Age(Age),
    /// Gender.
    Gender(Gender),
    /// The benchmark's race words.
    Race(Race),
    /// What the body does.
    Action(Action),
    /// How far from the robot.
    RobotDistance(DistanceWord),
    /// In which direction, seen from the robot.
    RobotDirection(Direction),
    /// A relation to some other thing.
    Relation(RelationPattern),
}

/// Which things are meant: a kind and conditions that hold together.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Pattern {
    /// What kind of thing.
    pub category: Category,
    /// What must hold, in the order of the question's words.
    #[serde(default)]
    pub conditions: Vec<Condition>,
}

/// A question.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Query {
    /// The words it was made from.
    pub text: String,
    /// What is asked.
    pub task: Task,
    /// Of which things.
    pub target: Pattern,
    /// Which words were not understood, and which were read in one of several ways.
    #[serde(default)]
    pub issues: Vec<Issue>,
}

impl Payload for Query {
    const SCHEMA: &'static str = "jrdb.query";
    const VERSION: u32 = 1;
}
