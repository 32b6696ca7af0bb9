//! The JSON form of what speaks of attributes: `{"age": "young"}` among the conditions, `"age"` among the properties.

use std::fmt;

use serde::de::{EnumAccess, VariantAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{Condition, Property};
use crate::attribute::{Attribute, ValueOf, unknown};

/// Names of the conditions that are no attributes.
const CONDITIONS: [&str; 13] = [
    "from_robot",
    "group_size",
    "related",
    "compared",
    "nearer",
    "measures",
    "looks",
    "id",
    "phrase",
    "is",
    "not",
    "any",
    "all",
];

impl<'de> Deserialize<'de> for Condition {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_enum("Condition", &CONDITIONS, ConditionVisitor)
    }
}

struct ConditionVisitor;

impl<'de> Visitor<'de> for ConditionVisitor {
    type Value = Condition;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("enum Condition")
    }

    fn visit_enum<A: EnumAccess<'de>>(self, data: A) -> Result<Condition, A::Error> {
        let (name, content) = data.variant::<String>()?;
        if let Some(attribute) = Attribute::from_name(&name) {
            return content.newtype_variant_seed(ValueOf(attribute)).map(Condition::Attribute);
        }
        match name.as_str() {
            "from_robot" => content.newtype_variant().map(Condition::FromRobot),
            "group_size" => content.newtype_variant().map(Condition::GroupSize),
            "related" => content.newtype_variant().map(Condition::Related),
            "compared" => content.newtype_variant().map(Condition::Compared),
            "nearer" => content.newtype_variant().map(Condition::Nearer),
            "measures" => content.newtype_variant().map(Condition::Measures),
            "looks" => content.newtype_variant().map(Condition::Looks),
            "id" => content.newtype_variant().map(Condition::Id),
            "phrase" => content.newtype_variant().map(Condition::Phrase),
            "is" => content.newtype_variant().map(Condition::Is),
            "not" => content.newtype_variant().map(Condition::Not),
            "any" => content.newtype_variant().map(Condition::Any),
            "all" => content.newtype_variant().map(Condition::All),
            other => Err(unknown(other, &CONDITIONS)),
        }
    }
}

/// The properties that are no attributes, with their names.
const PROPERTIES: [(Property, &str); 10] = [
    (Property::Distance, "distance"),
    (Property::Direction, "direction"),
    (Property::SocialInteraction, "social_interaction"),
    (Property::PeopleAround, "people_around"),
    (Property::ObjectInteraction, "object_interaction"),
    (Property::ObjectsAround, "objects_around"),
    (Property::Category, "category"),
    (Property::Height, "height"),
    (Property::Speed, "speed"),
    (Property::Facing, "facing"),
];

impl Property {
    /// Its name in JSON: `age`, `social_interaction`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Attribute(attribute) => attribute.name(),
            other => PROPERTIES.iter().find(|(own, _)| *own == other).map_or("", |(_, name)| name),
        }
    }

    /// Every property, attributes first.
    pub fn all() -> impl Iterator<Item = Self> {
        let attributes = Attribute::ALL.iter().map(|&attribute| Self::Attribute(attribute));
        attributes.chain(PROPERTIES.iter().map(|&(property, _)| property))
    }
}

impl Serialize for Property {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl<'de> Deserialize<'de> for Property {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        Self::all()
            .find(|property| property.name() == name)
            .ok_or_else(|| unknown(&name, &PROPERTIES.map(|(_, name)| name)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::query::{Place, Quantity};
    use crate::vocab::{DistanceWord, Gender};

    #[test]
    fn conditions_are_read_as_they_are_written() {
        let parts = vec![
            Condition::has(Gender::Female),
            Condition::Not(Box::new(Condition::GroupSize(Quantity::SOME))),
            Condition::FromRobot(Place::Distance(DistanceWord::Close)),
        ];
        let all = Condition::Any(vec![Condition::All(parts), Condition::Is(Box::default())]);
        let text = serde_json::to_string(&all).unwrap();
        let start = r#"{"any":[{"all":[{"gender":"female"},{"not":{"group_size":{"at_least":1}}},"#;
        assert!(text.starts_with(start), "{text}");
        assert_eq!(serde_json::from_str::<Condition>(&text).unwrap(), all);
    }

    #[test]
    fn an_unknown_condition_is_refused_with_those_that_there_are() {
        let error = serde_json::from_str::<Condition>(r#"{"mood":"sad"}"#).unwrap_err().to_string();
        assert!(
            error.starts_with("unknown variant `mood`, expected one of `age`, `gender`"),
            "{error}"
        );
        let error = serde_json::from_str::<Condition>(r#"{"age":"old"}"#).unwrap_err().to_string();
        assert!(error.starts_with("unknown variant `old`, expected one of `child`"), "{error}");
    }

    #[test]
    fn properties_are_read_as_they_are_written() {
        for property in Property::all() {
            let text = serde_json::to_string(&property).unwrap();
            assert_eq!(serde_json::from_str::<Property>(&text).unwrap(), property);
        }
    }
}
