//! Attributes and their values.

use super::table::for_each_attribute;
use crate::vocab::{Action, Age, Gender, Race};

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

/// Declares the enum with its rows, and a constructor for the values of each.
macro_rules! declare {
    ($(
        $(#[doc = $doc:literal])+
        $variant:ident($value:ty) {
            get: $get:ident, set: $set:ident, with: $with:ident, $($row:tt)*
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
                    words: <$value>::WORDS,
                    $($row)*
                } },)+ }
            }
        }

        impl AttributeValue {
            $($(#[doc = $doc])+ #[must_use]
            pub const fn $get(value: $value) -> Self {
                Self { attribute: Attribute::$variant, index: value as u8 }
            })+
        }
    };
}

use AttributeNotation::{Key, Word};
use AttributeSource::{Labels, LanguageModel, Light};
use AttributeWording::{Adjective, Followed};

for_each_attribute!(declare);

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
