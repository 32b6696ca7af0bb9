//! What the parser hands on: a question as an algebra of conditions on things and on their relations.

mod command;
mod interval;
mod measured;
mod phrase;
mod quantity;
mod serial;

pub use command::Command;
pub use interval::Interval;
pub use measured::{Measures, Nearer};
pub use phrase::Phrase;
pub use quantity::{Quantity, Share};

use serde::{Deserialize, Serialize};

use crate::artefact::Payload;
use crate::attribute::{Attribute, AttributeValue};
use crate::issue::Issue;
use crate::vocab::{Direction, DistanceWord, PairWord};

/// What is asked of the things that match.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Task {
    /// Which are they: boxes.
    #[default]
    Find,
    /// How many are there: a number.
    Count,
    /// Are there as many as this: yes or no.
    Exists(Quantity),
    /// Are there more, or fewer, of them than of others: yes or no.
    CompareCounts {
        /// More or fewer.
        order: Order,
        /// The others.
        than: Box<Pattern>,
    },
    /// What is known of them: values of properties.
    Which {
        /// Which properties, in the order asked.
        properties: Vec<Property>,
        /// Whether the values are asked in the order of time.
        #[serde(default)]
        in_order: bool,
    },
    /// Where are they: a place in words and metres.
    Where,
    /// Does what is asked hold of all of them, of none, of most: yes or no.
    Each {
        /// Of how many.
        share: Share,
        /// What is asked of each.
        asked: Vec<Condition>,
    },
    /// Which of these alternatives holds of them.
    Choice {
        /// The alternatives.
        options: Vec<Condition>,
    },
    /// Where are they from another thing: how far, or in which direction.
    From {
        /// The distance or the direction.
        property: Property,
        /// The other thing.
        partner: Box<Pattern>,
    },
    /// How many groups do they form: a number. A person alone forms none.
    Groups,
}

fn is_some_quantity(quantity: &Quantity) -> bool {
    *quantity == Quantity::SOME
}

/// Something that can be told of a thing. As JSON its name: `"age"`, `"people_around"`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename_all = "snake_case"))]
pub enum Property {
    /// How far from the robot, in words and metres.
    Distance,
    /// In which direction, seen from the robot.
    Direction,
    /// What is done with other people (the benchmark's "social interaction").
    SocialInteraction,
    /// Where other people are, seen from the person (the benchmark's "geometry between people").
    PeopleAround,
    /// What is done with objects (the benchmark's "interaction between person and object").
    ObjectInteraction,
    /// Where objects are, seen from the person (the benchmark's "geometry between person and object").
    ObjectsAround,
    /// What kind of thing it is.
    Category,
    /// How tall it is, metres.
    Height,
    /// How fast it moves over the ground, metres per second.
    Speed,
    /// Which way it faces, in words from where the robot is.
    Facing,
    /// The value of an attribute.
    #[cfg_attr(feature = "schema", schemars(untagged))]
    Attribute(Attribute),
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
    /// A person or an object.
    Anything,
    /// Objects of one class; [`crate::object::may_be`] says which of the graph's classes are meant.
    Class(String),
    /// The robot itself: at the origin of the base frame, facing along x. Only partners are robots.
    Robot,
}

/// One thing that can be said of a place. Several make several conditions.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Place {
    /// How far, in words.
    Distance(DistanceWord),
    /// In which direction, in words.
    Direction(Direction),
    /// How far, metres between the centres.
    Metres(Interval),
    /// In which direction, degrees counter-clockwise (to the physical left) from the front, in (-180, 180]:
    /// within `half_width` of `center`. "At 2 o'clock" is -60 within 15.
    Degrees {
        /// Middle of the directions meant.
        center: f64,
        /// How far it may be off to either side.
        half_width: f64,
    },
}

/// From whose place a direction between two things is told.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Viewpoint {
    /// Where the partner is, in the subject's own frame: "who has a woman to his right".
    Subject,
    /// Where the subject is, in the partner's own frame: "who is to the right of a woman", her right.
    Partner,
    /// Where the subject is beside the partner, as the robot sees both: in front is nearer to the robot, left is
    /// what the robot has on its left.
    Robot,
}

/// What must hold between subject and partner.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RelationKind {
    /// A place.
    Placed {
        /// Where.
        place: Place,
        /// Seen from whom; of no matter for distances.
        viewpoint: Viewpoint,
    },
    /// Next to, facing, in front of as the robot sees it ...: a word of the pair (subject, partner).
    Pair(PairWord),
    /// Something the subject does with the partner: JRDB-Social's label, of people (`conversation`,
    /// `walking together`) or of a person and an object (`holding`).
    Interaction(String),
    /// Anything the subject does with the partner, or has it next to it: "the girl with the bag".
    With,
    /// The subject is between the partner and one of these.
    Between(Box<Pattern>),
}

/// Relations to some other things.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Related {
    /// What must hold, all of it with the same partner.
    pub kinds: Vec<RelationKind>,
    /// Which things may be the partner.
    pub partner: Pattern,
    /// How many such partners there must be.
    #[serde(default, skip_serializing_if = "is_some_quantity")]
    pub quantity: Quantity,
}

/// A number that things are ordered by.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    /// Distance between centres to the nearest of these, metres.
    DistanceTo(Box<Pattern>),
    /// Place in the row from left to right as the robot sees it, all round: from straight behind over its left, its
    /// front and its right to straight behind again.
    FromLeft,
    /// Height of the box in space, metres.
    Height,
    /// Age group, youngest first.
    Age,
    /// Speed over the ground, metres per second.
    Speed,
}

/// Small or large values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Order {
    /// The least first; less than.
    Least,
    /// The most first; more than.
    Most,
}

/// Some of the things that match, by their place in an order: "the second person from the left".
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Pick {
    /// What they are ordered by. Things of which it is not known are not picked.
    pub measure: Measure,
    /// From which end.
    pub order: Order,
    /// From which place on, 1 for the first.
    pub rank: u32,
    /// How many from there.
    pub count: u32,
}

/// More or less of something than others have: "taller than the man".
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Compared {
    /// Of what.
    pub measure: Measure,
    /// Less or more.
    pub order: Order,
    /// Than each of these; at least one must be known.
    pub than: Box<Pattern>,
}

/// One thing asked of a candidate.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Condition {
    /// Where it is, seen from the robot.
    FromRobot(Place),
    /// How many people its group has, itself included; 1 is alone.
    GroupSize(Quantity),
    /// Relations to other things.
    Related(Related),
    /// More or less of something than others.
    Compared(Compared),
    /// It is nearer to one thing than to another.
    Nearer(Nearer),
    /// A measure of it within bounds.
    Measures(Measures),
    /// How it looks, or what it wears, holds or does, in words that no table holds. Perception that
    /// can be asked decides; to any other it is unknown.
    Looks(Phrase),
    /// It has this number: "#4".
    Id(u32),
    /// What these words say of it. They were not understood, so it is unknown whether it holds.
    Phrase(Phrase),
    /// It is one of these.
    Is(Box<Pattern>),
    /// It does not hold.
    Not(Box<Condition>),
    /// At least one holds.
    Any(Vec<Condition>),
    /// All hold.
    All(Vec<Condition>),
    /// It has a value of an attribute. As JSON `{"age": "young"}`.
    #[serde(untagged)]
    Attribute(AttributeValue),
}

impl Condition {
    /// That it has a value of an attribute.
    ///
    /// ```
    /// use jrdb_types::{AttributeValue, Condition, Gender, vocab::Color};
    /// let female = Condition::has(Gender::Female);
    /// assert_eq!(serde_json::to_string(&female).unwrap(), r#"{"gender":"female"}"#);
    /// let red = Condition::has(AttributeValue::upper_color(Color::Red));
    /// assert_eq!(serde_json::to_string(&red).unwrap(), r#"{"upper_color":"red"}"#);
    /// ```
    #[must_use]
    pub fn has(value: impl Into<AttributeValue>) -> Self {
        Self::Attribute(value.into())
    }

    /// Whether it looks at other things than the candidate: the paper checks these in its second phase.
    #[inline]
    #[must_use]
    pub fn is_relation(&self) -> bool {
        match self {
            Self::Related(_) | Self::Compared(_) | Self::Nearer(_) | Self::Is(_) => true,
            Self::Not(_) | Self::Any(_) | Self::All(_) => self.has_relations(),
            _ => false,
        }
    }

    /// Whether it asks how something looks, itself or in a part, but not of other things.
    #[must_use]
    pub fn asks_looks(&self) -> bool {
        match self {
            Self::Looks(_) => true,
            Self::Not(inner) => inner.asks_looks(),
            Self::Any(parts) | Self::All(parts) => parts.iter().any(Self::asks_looks),
            _ => false,
        }
    }

    /// The same of a condition that is made of others: apart, so that the common case needs no call.
    fn has_relations(&self) -> bool {
        match self {
            Self::Not(inner) => inner.is_relation(),
            Self::Any(parts) | Self::All(parts) => parts.iter().any(Self::is_relation),
            _ => false,
        }
    }
}

/// Which things are meant: a kind, conditions that hold together, and which of those that are left.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Pattern {
    /// What kind of thing.
    pub category: Category,
    /// What must hold, in the order of the question's words.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub conditions: Vec<Condition>,
    /// Which of those that match; all when absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pick: Option<Pick>,
}

impl Pattern {
    /// Things of a kind with nothing asked of them.
    #[must_use]
    pub fn of(category: Category) -> Self {
        Self { category, ..Self::default() }
    }
}

/// A stretch of a recording.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Slot {
    /// First and last moment, seconds from the recording's first frame; any time when absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub during_s: Option<[f64; 2]>,
    /// What must hold then, besides the target's own conditions.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub conditions: Vec<Condition>,
}

/// A question.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Query {
    /// The words it was made from.
    pub text: String,
    /// What is asked.
    pub task: Task,
    /// Of which things.
    pub target: Pattern,
    /// What is to be done with the things found; absent where nothing is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub command: Option<Command>,
    /// What the target does when, one after the other; empty where no time is spoken of.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub slots: Vec<Slot>,
    /// Which words were not understood, and which were read in one of several ways.
    #[serde(default)]
    pub issues: Vec<Issue>,
}

impl Payload for Query {
    const SCHEMA: &'static str = "jrdb.query";
    const VERSION: u32 = 4;
}
