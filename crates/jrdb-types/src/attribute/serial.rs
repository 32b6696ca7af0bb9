//! The JSON form of attributes: `{"age": "young"}` for a value, `{"age": {"young": 0.8}}` for beliefs.

use std::fmt;

use serde::de::{
    DeserializeSeed, EnumAccess, Error as _, IgnoredAny, MapAccess, VariantAccess, Visitor,
};
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::belief::{AttributeBelief, Attributes, Belief};
use super::table::for_each_attribute;
use super::value::{Attribute, AttributeValue};
use crate::vocab::Facing;

/// Key of the facing in JSON, which follows this attribute: files have had it there from the start.
const FACING: &str = "facing";
const FACING_FOLLOWS: Attribute = Attribute::Action;

/// What has to know the type of an attribute's values; implemented by the table.
trait Typed: Sized {
    /// Reads a value, `"young"`.
    fn read_value<'de, D: Deserializer<'de>>(self, from: D) -> Result<AttributeValue, D::Error>;

    /// Reads a belief, `{"young": 0.8}`.
    fn read_belief<'de, D: Deserializer<'de>>(
        self,
        from: D,
    ) -> Result<Vec<(AttributeValue, f64)>, D::Error>;

    /// Writes a value, `"young"`.
    fn write_value<S: Serializer>(value: AttributeValue, to: S) -> Result<S::Ok, S::Error>;
}

macro_rules! typed {
    ($(
        $(#[doc = $doc:literal])+
        $variant:ident($value:ty) {
            get: $get:ident, set: $set:ident, with: $with:ident, $($row:tt)*
        }
    )+) => {
        impl Typed for Attribute {
            fn read_value<'de, D: Deserializer<'de>>(self, from: D) -> Result<AttributeValue, D::Error> {
                match self {
                    $(Self::$variant => <$value>::deserialize(from).map(AttributeValue::$get),)+
                }
            }

            fn read_belief<'de, D: Deserializer<'de>>(
                self,
                from: D,
            ) -> Result<Vec<(AttributeValue, f64)>, D::Error> {
                match self {
                    $(Self::$variant => {
                        let belief = Belief::<$value>::deserialize(from)?;
                        Ok(belief.0.into_iter().map(|(value, p)| (AttributeValue::$get(value), p)).collect())
                    })+
                }
            }

            fn write_value<S: Serializer>(value: AttributeValue, to: S) -> Result<S::Ok, S::Error> {
                match value.attribute() {
                    $(Self::$variant => <$value>::ALL[value.index()].serialize(to),)+
                }
            }
        }

        #[cfg(feature = "schema")]
        impl schema::Described for Attribute {
            fn description(self) -> &'static str {
                match self { $(Self::$variant => concat!($($doc),+).trim(),)+ }
            }

            fn value_schema(self, generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
                match self { $(Self::$variant => generator.subschema_for::<$value>(),)+ }
            }

            fn belief_schema(self, generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
                match self { $(Self::$variant => generator.subschema_for::<Belief<$value>>(),)+ }
            }
        }
    };
}

for_each_attribute!(typed);

impl Serialize for Attribute {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl<'de> Deserialize<'de> for Attribute {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        Self::from_name(&name).ok_or_else(|| unknown(&name, &[]))
    }
}

/// No attribute, and none of the other variants, has this name.
pub(crate) fn unknown<E: serde::de::Error>(name: &str, others: &[&str]) -> E {
    let names = Attribute::ALL.iter().map(|attribute| attribute.name());
    let names: Vec<String> =
        names.chain(others.iter().copied()).map(|name| format!("`{name}`")).collect();
    E::custom(format_args!("unknown variant `{name}`, expected one of {}", names.join(", ")))
}

/// A value without its attribute.
struct Bare(AttributeValue);

impl Serialize for Bare {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Attribute::write_value(self.0, serializer)
    }
}

impl Serialize for AttributeValue {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let (attribute, index) = (self.attribute(), self.attribute() as u32);
        serializer.serialize_newtype_variant(
            "AttributeValue",
            index,
            attribute.name(),
            &Bare(*self),
        )
    }
}

/// Reads a value of an attribute that is known already.
pub(crate) struct ValueOf(pub(crate) Attribute);

impl<'de> DeserializeSeed<'de> for ValueOf {
    type Value = AttributeValue;

    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<AttributeValue, D::Error> {
        self.0.read_value(from)
    }
}

impl<'de> Deserialize<'de> for AttributeValue {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_enum("AttributeValue", &[], ValueVisitor)
    }
}

struct ValueVisitor;

impl<'de> Visitor<'de> for ValueVisitor {
    type Value = AttributeValue;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an attribute with its value")
    }

    fn visit_enum<A: EnumAccess<'de>>(self, data: A) -> Result<AttributeValue, A::Error> {
        let (attribute, content) = data.variant::<Attribute>()?;
        content.newtype_variant_seed(ValueOf(attribute))
    }
}

impl Serialize for AttributeBelief<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.entries().iter().map(|&(value, p)| (Bare(value), p)))
    }
}

impl Serialize for Attributes {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        for &attribute in Attribute::ALL {
            let known = self.belief(attribute);
            if !known.is_unknown() {
                map.serialize_entry(attribute.name(), &known)?;
            }
            if attribute == FACING_FOLLOWS && !self.facing.is_unknown() {
                map.serialize_entry(FACING, &self.facing)?;
            }
        }
        map.end()
    }
}

impl<'de> Deserialize<'de> for Attributes {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(AttributesVisitor)
    }
}

struct BeliefOf(Attribute);

impl<'de> DeserializeSeed<'de> for BeliefOf {
    type Value = Vec<(AttributeValue, f64)>;

    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<Self::Value, D::Error> {
        self.0.read_belief(from)
    }
}

struct AttributesVisitor;

impl<'de> Visitor<'de> for AttributesVisitor {
    type Value = Attributes;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("struct Attributes")
    }

    /// Other keys are left out: a later version may have more attributes.
    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Attributes, A::Error> {
        let mut known = Attributes::default();
        let mut facing = None;
        let mut read = Vec::new();
        while let Some(name) = map.next_key::<String>()? {
            if let Some(attribute) = Attribute::from_name(&name) {
                if read.contains(&attribute) {
                    return Err(A::Error::duplicate_field(attribute.name()));
                }
                read.push(attribute);
                known.set(attribute, map.next_value_seed(BeliefOf(attribute))?);
            } else if name == FACING {
                let belief: Belief<Facing> = map.next_value()?;
                if facing.replace(belief).is_some() {
                    return Err(A::Error::duplicate_field(FACING));
                }
            } else {
                map.next_value::<IgnoredAny>()?;
            }
        }
        known.facing = facing.unwrap_or_default();
        Ok(known)
    }
}

#[cfg(feature = "schema")]
mod schema {
    use std::borrow::Cow;

    use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};

    use super::{Attribute, AttributeValue, Attributes, Belief, FACING, Facing};

    /// What the schema has to know of an attribute; implemented by the table.
    pub(super) trait Described {
        /// What the attribute is.
        fn description(self) -> &'static str;

        /// Schema of a value.
        fn value_schema(self, generator: &mut SchemaGenerator) -> Schema;

        /// Schema of a belief.
        fn belief_schema(self, generator: &mut SchemaGenerator) -> Schema;
    }

    fn described(mut schema: Schema, description: &str) -> Schema {
        schema.insert("description".into(), description.into());
        schema
    }

    impl JsonSchema for Attribute {
        fn schema_name() -> Cow<'static, str> {
            "Attribute".into()
        }

        fn json_schema(_: &mut SchemaGenerator) -> Schema {
            let one_of: Vec<Schema> = Attribute::ALL
                .iter()
                .map(|attribute| {
                    let schema = json_schema!({ "type": "string", "const": attribute.name() });
                    described(schema, attribute.description())
                })
                .collect();
            json_schema!({ "description": "Something that can be believed and asked of a person.", "oneOf": one_of })
        }
    }

    impl JsonSchema for AttributeValue {
        fn schema_name() -> Cow<'static, str> {
            "AttributeValue".into()
        }

        fn json_schema(generator: &mut SchemaGenerator) -> Schema {
            let one_of: Vec<Schema> = Attribute::ALL
                .iter()
                .map(|attribute| {
                    let value = attribute.value_schema(generator);
                    let schema = json_schema!({
                        "type": "object",
                        "properties": { attribute.name(): value },
                        "additionalProperties": false,
                        "required": [attribute.name()],
                    });
                    described(schema, attribute.description())
                })
                .collect();
            json_schema!({ "description": "One value of one attribute.", "oneOf": one_of })
        }
    }

    impl JsonSchema for Attributes {
        fn schema_name() -> Cow<'static, str> {
            "Attributes".into()
        }

        fn json_schema(generator: &mut SchemaGenerator) -> Schema {
            let mut properties = serde_json::Map::new();
            for attribute in Attribute::ALL {
                let belief = described(attribute.belief_schema(generator), attribute.description());
                properties.insert(attribute.name().into(), belief.into());
            }
            let facing = generator.subschema_for::<Belief<Facing>>();
            let facing = described(facing, "Which way its front points in the picture.");
            properties.insert(FACING.into(), facing.into());
            json_schema!({
                "description": "What is believed of a person.",
                "type": "object",
                "properties": properties,
            })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vocab::{Age, Color};

    #[test]
    fn the_json_form_is_the_one_that_files_have() {
        let text = r#"{"age":{"adolescent":0.3,"young":0.6},"action":{"going_up":1.0},"facing":{"away":1.0},"upper_color":{"red":0.5}}"#;
        let known: Attributes = serde_json::from_str(text).unwrap();
        assert_eq!(known.upper_color(), Belief([(Color::Red, 0.5)].into()));
        assert_eq!(serde_json::to_string(&known).unwrap(), text);
    }

    #[test]
    fn a_value_is_read_as_it_is_written() {
        for value in Attribute::ALL.iter().flat_map(|attribute| attribute.values()) {
            let text = serde_json::to_string(&value).unwrap();
            assert_eq!(serde_json::from_str::<AttributeValue>(&text).unwrap(), value, "{text}");
        }
        let middle_aged = AttributeValue::from(Age::MiddleAged);
        assert_eq!(serde_json::to_string(&middle_aged).unwrap(), r#"{"age":"middle_aged"}"#);
    }

    #[test]
    fn wrong_words_are_refused_and_unknown_attributes_tolerated() {
        let error = |text| serde_json::from_str::<Attributes>(text).unwrap_err().to_string();
        assert!(
            error(r#"{"age":{"old":1.0}}"#)
                .starts_with("unknown variant `old`, expected one of `child`")
        );
        assert!(error(r#"{"age":{},"age":{}}"#).starts_with("duplicate field `age`"));
        let later: Attributes = serde_json::from_str(r#"{"shoes":{"red":1.0}}"#).unwrap();
        assert_eq!(later, Attributes::default());
        let error = serde_json::from_str::<AttributeValue>(r#"{"shoes":"red"}"#).unwrap_err();
        assert!(error.to_string().starts_with("unknown variant `shoes`, expected one of `age`"));
    }
}
