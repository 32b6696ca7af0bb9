//! What can be believed and asked of a person, in one table: a row per attribute.

mod belief;
mod serial;

pub use belief::{AttributeBelief, Attributes, Belief};
pub(crate) use serial::{ValueOf, unknown};

use crate::vocab::{Action, Age, Color, Gender, Race};

/// What the table says of one attribute.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AttributeRow {
    /// The attribute.
    pub attribute: Attribute,
    /// Its key in JSON.
    pub name: &'static str,
    /// The words for its values, in the order of its vocabulary.
    pub words: &'static [&'static str],
    /// Whether neighbouring values resemble each other, as age groups do. A neighbour then counts in the ranking.
    pub ordered: bool,
    /// Whether "a or b" of two of its values is taken as two alternatives that exclude each other.
    pub exclusive: bool,
    /// How English names a value.
    pub wording: AttributeWording,
    /// How the notation of the parser writes a value.
    pub notation: AttributeNotation,
    /// What a graph lacks that holds none of it: "ages".
    pub plural: &'static str,
    /// Which perception provides it.
    pub sources: &'static [AttributeSource],
}

/// How English names the value of an attribute.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AttributeWording {
    /// The value is an adjective: "a young person"; alone it follows the attribute's name: "age young".
    Adjective,
    /// The value is followed by these words: "red" and "above the waist".
    Followed(&'static str),
}

/// How the notation of the parser writes the value of an attribute.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AttributeNotation {
    /// As the bare word, which no other attribute without a key may have: `young`.
    Word,
    /// With a key, which need not be the attribute's name: `upper=red`.
    Key {
        /// The key.
        key: &'static str,
        /// What a value is, for the message when another word stands there: "a colour".
        value: &'static str,
    },
}

/// A kind of perception that provides attributes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AttributeSource {
    /// The labels of the dataset.
    Labels,
    /// The perception `light`, which runs small models and measures colours.
    Light,
    /// A language model that sees.
    LanguageModel,
}

/// Declares the attributes: the enum, its table, and what has to know the type of each attribute's values.
macro_rules! attributes {
    ($(
        $(#[doc = $doc:literal])+
        $variant:ident($value:ty) {
            get: $get:ident, set: $set:ident, with: $with:ident, name: $name:literal, ordered: $ordered:literal,
            exclusive: $exclusive:literal, wording: $wording:expr, notation: $notation:expr,
            plural: $plural:literal, sources: $sources:expr,
        }
    )+) => {
        /// Something that can be believed and asked of a person; its row in the table says the rest.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[non_exhaustive]
        pub enum Attribute { $($(#[doc = $doc])+ $variant,)+ }

        impl Attribute {
            /// Every attribute, in the order of the table.
            pub const ALL: &[Self] = &[$(Self::$variant),+];

            /// The attribute's row of the table.
            #[must_use]
            pub const fn row(self) -> &'static AttributeRow {
                match self { $(Self::$variant => const { &AttributeRow {
                    attribute: Self::$variant,
                    name: $name,
                    words: <$value>::WORDS,
                    ordered: $ordered,
                    exclusive: $exclusive,
                    wording: $wording,
                    notation: $notation,
                    plural: $plural,
                    sources: $sources,
                } },)+ }
            }
        }

        impl AttributeValue {
            $($(#[doc = $doc])+ #[must_use]
            pub const fn $get(value: $value) -> Self {
                Self { attribute: Attribute::$variant, index: value as u8 }
            })+
        }

        impl Attributes {
            $($(#[doc = $doc])+ #[must_use]
            pub fn $get(&self) -> Belief<$value> {
                let known = self.belief(Attribute::$variant).entries().iter();
                Belief(known.map(|&(value, p)| (<$value>::ALL[value.index()], p)).collect())
            }

            #[doc = concat!("Replaces what is believed of the attribute `", $name, "`.")]
            pub fn $set(&mut self, belief: Belief<$value>) {
                let entries = belief.0.into_iter().map(|(value, p)| (AttributeValue::$get(value), p));
                self.set(Attribute::$variant, entries);
            }

            #[doc = concat!("The same with another belief of the attribute `", $name, "`.")]
            #[must_use]
            pub fn $with(mut self, belief: Belief<$value>) -> Self {
                self.$set(belief);
                self
            })+
        }

        impl serial::Typed for Attribute {
            fn read_value<'de, D: serde::Deserializer<'de>>(self, from: D) -> Result<AttributeValue, D::Error> {
                match self {
                    $(Self::$variant => <$value as serde::Deserialize>::deserialize(from).map(AttributeValue::$get),)+
                }
            }

            fn read_belief<'de, D: serde::Deserializer<'de>>(
                self,
                from: D,
            ) -> Result<Vec<(AttributeValue, f64)>, D::Error> {
                match self {
                    $(Self::$variant => {
                        let belief = <Belief<$value> as serde::Deserialize>::deserialize(from)?;
                        Ok(belief.0.into_iter().map(|(value, p)| (AttributeValue::$get(value), p)).collect())
                    })+
                }
            }

            fn write_value<S: serde::Serializer>(value: AttributeValue, to: S) -> Result<S::Ok, S::Error> {
                match value.attribute {
                    $(Self::$variant => serde::Serialize::serialize(&<$value>::ALL[value.index()], to),)+
                }
            }
        }

        #[cfg(feature = "schema")]
        impl serial::Described for Attribute {
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

use AttributeSource::{Labels, LanguageModel, Light};
use AttributeWording::{Adjective, Followed};

attributes! {
    /// Age group.
    Age(Age) {
        get: age, set: set_age, with: with_age, name: "age", ordered: true,
        exclusive: true, wording: Adjective, notation: AttributeNotation::Word,
        plural: "ages", sources: &[Labels, Light, LanguageModel],
    }
    /// Gender.
    Gender(Gender) {
        get: gender, set: set_gender, with: with_gender, name: "gender", ordered: false,
        exclusive: true, wording: Adjective, notation: AttributeNotation::Word,
        plural: "genders", sources: &[Labels, Light, LanguageModel],
    }
    /// The benchmark's race words.
    Race(Race) {
        get: race, set: set_race, with: with_race, name: "race", ordered: false,
        exclusive: true, wording: Adjective, notation: AttributeNotation::Word,
        plural: "races", sources: &[Labels, LanguageModel],
    }
    /// What the body does.
    Action(Action) {
        get: action, set: set_action, with: with_action, name: "action", ordered: false,
        exclusive: true, wording: Adjective, notation: AttributeNotation::Word,
        plural: "actions", sources: &[Labels, Light, LanguageModel],
    }
    /// Colour of what it wears above the waist.
    UpperColor(Color) {
        get: upper_color, set: set_upper_color, with: with_upper_color, name: "upper_color", ordered: false,
        exclusive: false, wording: Followed("above the waist"),
        notation: AttributeNotation::Key { key: "upper", value: "a colour" },
        plural: "colours of clothes", sources: &[Light],
    }
    /// Colour of what it wears below the waist.
    LowerColor(Color) {
        get: lower_color, set: set_lower_color, with: with_lower_color, name: "lower_color", ordered: false,
        exclusive: false, wording: Followed("below the waist"),
        notation: AttributeNotation::Key { key: "lower", value: "a colour" },
        plural: "colours of clothes", sources: &[Light],
    }
}

/// Values whose vocabulary belongs to one attribute only.
macro_rules! values_of_one_attribute {
    ($($value:ty => $get:ident,)+) => {$(
        impl From<$value> for AttributeValue {
            fn from(value: $value) -> Self {
                Self::$get(value)
            }
        }
    )+};
}

values_of_one_attribute! {
    Age => age,
    Gender => gender,
    Race => race,
    Action => action,
}

impl Attribute {
    /// Its key in JSON.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.row().name
    }

    /// The attribute with this key in JSON.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|attribute| attribute.name() == name)
    }

    /// Its values, in the order of its vocabulary.
    pub fn values(self) -> impl Iterator<Item = AttributeValue> {
        (0..self.row().words.len() as u8)
            .map(move |index| AttributeValue { attribute: self, index })
    }

    /// The value with this word.
    #[must_use]
    pub fn value(self, word: &str) -> Option<AttributeValue> {
        self.values().find(|value| value.word() == word)
    }
}

/// One value of one attribute: what a condition asks for, and what a belief gives a probability.
///
/// Values are in the order of the table, then of the vocabulary.
///
/// ```
/// use jrdb_types::{Age, Attribute, AttributeValue, vocab::Color};
/// assert_eq!(AttributeValue::from(Age::Young).attribute(), Attribute::Age);
/// assert_eq!(AttributeValue::upper_color(Color::Red).word(), "red");
/// assert_eq!(Attribute::Age.value("young"), Some(Age::Young.into()));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct AttributeValue {
    attribute: Attribute,
    index: u8,
}

impl AttributeValue {
    /// How many values all attributes have together.
    pub const COUNT: usize = places_before(Attribute::ALL.len());

    /// The attribute.
    #[inline]
    #[must_use]
    pub const fn attribute(self) -> Attribute {
        self.attribute
    }

    /// Its place in its attribute's vocabulary, from 0.
    #[inline]
    #[must_use]
    pub const fn index(self) -> usize {
        self.index as usize
    }

    /// Its place among the values of all attributes, below [`Self::COUNT`].
    #[inline]
    #[must_use]
    pub const fn place(self) -> usize {
        PLACES_BEFORE[self.attribute as usize] + self.index as usize
    }

    /// The word for it, as the benchmark spells it.
    #[must_use]
    pub const fn word(self) -> &'static str {
        self.attribute.row().words[self.index as usize]
    }
}

impl std::fmt::Display for AttributeValue {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.word())
    }
}

/// How many values the attributes before each have.
const PLACES_BEFORE: [usize; Attribute::ALL.len()] = {
    let mut places = [0; Attribute::ALL.len()];
    let mut attribute = 0;
    while attribute < places.len() {
        places[attribute] = places_before(attribute);
        attribute += 1;
    }
    places
};

/// How many values the first attributes of the table have.
const fn places_before(attributes: usize) -> usize {
    let (mut places, mut attribute) = (0, 0);
    while attribute < attributes {
        places += Attribute::ALL[attribute].row().words.len();
        attribute += 1;
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_has_its_own_place() {
        let places: Vec<usize> =
            Attribute::ALL.iter().flat_map(|a| a.values()).map(AttributeValue::place).collect();
        assert_eq!(places, (0..AttributeValue::COUNT).collect::<Vec<_>>());
    }

    #[test]
    fn the_notation_can_tell_attributes_apart() {
        let mut keys: Vec<&str> = Attribute::ALL
            .iter()
            .flat_map(|attribute| match attribute.row().notation {
                AttributeNotation::Word => attribute.row().words.to_vec(),
                AttributeNotation::Key { key, .. } => vec![key],
            })
            .collect();
        let count = keys.len();
        keys.sort_unstable();
        keys.dedup();
        assert_eq!(keys.len(), count);
    }

    #[test]
    fn every_attribute_has_its_row() {
        for &attribute in Attribute::ALL {
            assert_eq!(attribute.row().attribute, attribute);
            assert_eq!(Attribute::from_name(attribute.name()), Some(attribute));
        }
    }
}
