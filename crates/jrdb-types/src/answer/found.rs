//! What is found of a thing: distances, directions and the values of properties.

use serde::{Deserialize, Serialize};

use crate::attribute::AttributeValue;
use crate::entity::SpatialRelation;
use crate::id::EntityId;
use crate::query::{Condition, Property};
use crate::vocab::{Direction, DistanceWord};

/// How far something is, as a word, a number, or both.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DistanceFound {
    /// The word.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub word: Option<DistanceWord>,
    /// Between the centres, metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub metres: Option<f64>,
}

impl DistanceFound {
    /// The distance of a relation; `None` when it is unknown.
    #[must_use]
    pub fn of(relation: &SpatialRelation) -> Option<Self> {
        let found = Self { word: relation.distance, metres: relation.distance_m };
        (found.word.is_some() || found.metres.is_some()).then_some(found)
    }

    fn rounded(self) -> Self {
        Self { metres: self.metres.map(tenths), ..self }
    }
}

/// In which direction something is, as a word, a number, or both.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DirectionFound {
    /// The word, under the answer's lateral convention.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub word: Option<Direction>,
    /// Degrees counter-clockwise from the front, in (-180, 180].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub degrees: Option<f64>,
}

impl DirectionFound {
    /// The direction of a relation; `None` when it is unknown.
    #[must_use]
    pub fn of(relation: &SpatialRelation) -> Option<Self> {
        let degrees = relation.bearing_rad.map(f64::to_degrees);
        let found = Self { word: relation.direction, degrees };
        (found.word.is_some() || found.degrees.is_some()).then_some(found)
    }

    fn rounded(self) -> Self {
        Self { degrees: self.degrees.map(f64::round), ..self }
    }
}

/// Which way something faces.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HeadingFound {
    /// In the base frame, degrees counter-clockwise from the robot's own heading, in (-180, 180].
    pub degrees: f64,
    /// The angle to the robot, degrees in [0, 180]: 0 faces the robot; absent without a place.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub off_robot: Option<f64>,
}

/// The nearest thing to something.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Landmark {
    /// Which.
    pub id: EntityId,
    /// Distance between the centres, metres.
    pub metres: f64,
    /// Whether it is so near that it counts as close.
    pub is_close: bool,
}

/// One value of a property.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum PropertyValue {
    /// A value of an attribute.
    Attribute {
        /// Which value.
        value: AttributeValue,
        /// Its probability in `[0, 1]`.
        probability: f64,
    },
    /// Class name.
    Category(String),
    /// How tall it is, metres.
    Height(f64),
    /// How fast it moves, metres per second.
    Speed(f64),
    /// Which way it faces.
    Heading(HeadingFound),
    /// The alternative that holds of it.
    Option(Condition),
    /// How far it is from the robot.
    Distance(DistanceFound),
    /// In which direction it is, seen from the robot.
    Direction(DirectionFound),
    /// What it does with a partner.
    Interaction {
        /// The dataset's label.
        label: String,
        /// With whom or what.
        partner: EntityId,
    },
    /// Where another thing is, seen from it.
    Around {
        /// Which thing.
        id: EntityId,
        /// In which direction.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        direction: Option<DirectionFound>,
        /// How far.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        distance: Option<DistanceFound>,
    },
    /// Where it is, seen from the robot.
    Place {
        /// How far.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        distance: Option<DistanceFound>,
        /// In which direction.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        direction: Option<DirectionFound>,
        /// What it is nearest to.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        landmark: Option<Landmark>,
    },
}

impl PropertyValue {
    /// The value to the precision that an answer states: tenths of a metre, degrees, hundredths of a probability. A value
    /// has changed over time when its rounded form has.
    #[must_use]
    pub fn rounded(&self) -> Self {
        let distance = |found: &Option<DistanceFound>| found.map(DistanceFound::rounded);
        let direction = |found: &Option<DirectionFound>| found.map(DirectionFound::rounded);
        match self {
            Self::Attribute { value, probability } => Self::Attribute {
                value: *value,
                probability: (probability * 100.0).round() / 100.0,
            },
            Self::Distance(found) => Self::Distance(found.rounded()),
            Self::Direction(found) => Self::Direction(found.rounded()),
            Self::Around { id, direction: to, distance: far } => {
                Self::Around { id: id.clone(), direction: direction(to), distance: distance(far) }
            }
            Self::Place { distance: far, direction: to, landmark } => Self::Place {
                distance: distance(far),
                direction: direction(to),
                landmark: landmark
                    .clone()
                    .map(|near| Landmark { metres: tenths(near.metres), ..near }),
            },
            Self::Height(metres) => Self::Height(tenths(*metres)),
            Self::Speed(speed) => Self::Speed(tenths(*speed)),
            Self::Heading(found) => {
                let off_robot = found.off_robot.map(f64::round);
                Self::Heading(HeadingFound { degrees: found.degrees.round(), off_robot })
            }
            Self::Category(_) | Self::Option(_) | Self::Interaction { .. } => self.clone(),
        }
    }
}

fn tenths(value: f64) -> f64 {
    (value * 10.0).round() / 10.0
}

/// What is known of one property of one thing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PropertyValues {
    /// Of which thing.
    pub id: EntityId,
    /// Which property; absent for a place.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub property: Option<Property>,
    /// Its values, most probable or nearest first; empty when unknown.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub values: Vec<PropertyValue>,
    /// The values in words, one for each; empty until `jrdb-render` fills them.
    #[serde(default)]
    pub words: Vec<String>,
}
