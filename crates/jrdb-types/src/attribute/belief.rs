//! How probable each value of an attribute is.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::table::for_each_attribute;
use super::value::{Attribute, AttributeValue};
use crate::vocab::Facing;

/// Probabilities of the values of one attribute; a value that is absent has probability 0, and an
/// empty belief means "unknown".
///
/// As JSON: `{"young": 0.8, "adolescent": 0.2}`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "BeliefOf{T}"))]
#[serde(transparent)]
pub struct Belief<T: Ord>(pub BTreeMap<T, f64>);

impl<T: Ord> Default for Belief<T> {
    /// Nothing is known.
    fn default() -> Self {
        Self(BTreeMap::new())
    }
}

impl<T: Ord + Copy> Belief<T> {
    /// One value for sure, as a label file states it.
    #[must_use]
    pub fn certain(value: T) -> Self {
        Self(BTreeMap::from([(value, 1.0)]))
    }

    /// Certain of `Some`, ignorant of `None`.
    #[must_use]
    pub fn from_label(value: Option<T>) -> Self {
        value.map(Self::certain).unwrap_or_default()
    }

    /// Whether nothing is known.
    #[must_use]
    pub fn is_unknown(&self) -> bool {
        self.0.is_empty()
    }

    /// Probability of a value, in `[0, 1]`.
    #[must_use]
    pub fn probability(&self, value: T) -> f64 {
        self.0.get(&value).copied().unwrap_or(0.0)
    }

    /// The most probable value; the first in vocabulary order on a tie.
    #[must_use]
    pub fn best(&self) -> Option<T> {
        most_probable(self.0.iter().map(|(&value, &p)| (value, p)))
    }
}

/// The first of the most probable values.
fn most_probable<T: Copy>(mut entries: impl Iterator<Item = (T, f64)>) -> Option<T> {
    let mut best = entries.next()?;
    for next in entries {
        if next.1 > best.1 {
            best = next;
        }
    }
    Some(best.0)
}

/// What is believed of a person: a belief for each attribute of the table, and which way it faces.
///
/// Values and their probabilities are in one list, sorted by value. An attribute without a value in it is unknown.
///
/// ```
/// use jrdb_types::{Action, Attribute, Attributes, Belief, Gender};
/// let mut known = Attributes::certain([Gender::Female.into()]);
/// known.set_action(Belief([(Action::Sitting, 0.7), (Action::Standing, 0.3)].into()));
/// assert_eq!(known.action().best(), Some(Action::Sitting));
/// assert_eq!(known.belief(Attribute::Action).best(), Some(Action::Sitting.into()));
/// assert!(known.belief(Attribute::Age).is_unknown());
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Attributes {
    /// Sorted by value; each value at most once.
    entries: Vec<(AttributeValue, f64)>,
    /// Which way its front points in the picture: evidence of its heading, which no condition asks for.
    pub facing: Belief<Facing>,
}

impl Attributes {
    /// Values that are known for sure, at most one of each attribute.
    #[must_use]
    pub fn certain(values: impl IntoIterator<Item = AttributeValue>) -> Self {
        let mut entries: Vec<(AttributeValue, f64)> =
            values.into_iter().map(|value| (value, 1.0)).collect();
        entries.sort_by_key(|&(value, _)| value);
        entries.dedup_by_key(|&mut (value, _)| value.attribute());
        Self { entries, facing: Belief::default() }
    }

    /// What is believed of one attribute.
    #[inline]
    #[must_use]
    pub fn belief(&self, attribute: Attribute) -> AttributeBelief<'_> {
        let is_before = |&(value, _): &(AttributeValue, f64)| value.attribute() < attribute;
        let start = self.entries.iter().take_while(|&entry| is_before(entry)).count();
        let rest = &self.entries[start..];
        let count = rest.iter().take_while(|(value, _)| value.attribute() == attribute).count();
        AttributeBelief { entries: &rest[..count] }
    }

    /// The beliefs of the attributes that are known, in the order of the table.
    pub fn beliefs(&self) -> impl Iterator<Item = AttributeBelief<'_>> {
        let same = |a: &(AttributeValue, f64), b: &(AttributeValue, f64)| {
            a.0.attribute() == b.0.attribute()
        };
        self.entries.chunk_by(same).map(|entries| AttributeBelief { entries })
    }

    /// Replaces what is believed of one attribute. Values of other attributes are left out; of two equal values the last counts.
    pub fn set(
        &mut self,
        attribute: Attribute,
        entries: impl IntoIterator<Item = (AttributeValue, f64)>,
    ) {
        self.entries.retain(|(value, _)| value.attribute() != attribute);
        for (value, p) in entries {
            if value.attribute() == attribute {
                self.set_probability(value, p);
            }
        }
    }

    /// Sets the probability of one value, in `[0, 1]`; the other values keep theirs.
    pub fn set_probability(&mut self, value: AttributeValue, probability: f64) {
        match self.entries.binary_search_by_key(&value, |&(value, _)| value) {
            Ok(place) => self.entries[place].1 = probability,
            Err(place) => self.entries.insert(place, (value, probability)),
        }
    }
}

/// Getters and setters of each attribute, in the types of its values.
macro_rules! typed_beliefs {
    ($(
        $(#[doc = $doc:literal])+
        $variant:ident($value:ty) {
            get: $get:ident, set: $set:ident, with: $with:ident, $($row:tt)*
        }
    )+) => {
        impl Attributes {
            $($(#[doc = $doc])+ #[must_use]
            pub fn $get(&self) -> Belief<$value> {
                let known = self.belief(Attribute::$variant).entries().iter();
                Belief(known.map(|&(value, p)| (<$value>::ALL[value.index()], p)).collect())
            }

            #[doc = concat!("Replaces the belief of [`Self::", stringify!($get), "`].")]
            pub fn $set(&mut self, belief: Belief<$value>) {
                let entries = belief.0.into_iter().map(|(value, p)| (AttributeValue::$get(value), p));
                self.set(Attribute::$variant, entries);
            }

            #[doc = concat!("The same with another belief of [`Self::", stringify!($get), "`].")]
            #[must_use]
            pub fn $with(mut self, belief: Belief<$value>) -> Self {
                self.$set(belief);
                self
            })+
        }
    };
}

for_each_attribute!(typed_beliefs);

/// What is believed of one attribute of one person: values with their probabilities, in the order of the vocabulary.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AttributeBelief<'a> {
    entries: &'a [(AttributeValue, f64)],
}

impl<'a> AttributeBelief<'a> {
    /// The values with their probabilities in `[0, 1]`; none when nothing is known.
    #[inline]
    #[must_use]
    pub fn entries(self) -> &'a [(AttributeValue, f64)] {
        self.entries
    }

    /// Whether nothing is known.
    #[inline]
    #[must_use]
    pub fn is_unknown(self) -> bool {
        self.entries.is_empty()
    }

    /// Probability of a value, in `[0, 1]`.
    #[must_use]
    pub fn probability(self, value: AttributeValue) -> f64 {
        let entry = self.entries.iter().find(|(other, _)| *other == value);
        entry.map_or(0.0, |&(_, p)| p)
    }

    /// The most probable value; the first in vocabulary order on a tie.
    #[inline]
    #[must_use]
    pub fn best(self) -> Option<AttributeValue> {
        most_probable(self.entries.iter().copied())
    }

    /// The most probable of the values other than this one, with its probability.
    #[must_use]
    pub fn rival(self, of: AttributeValue) -> Option<(AttributeValue, f64)> {
        let others = || self.entries.iter().copied().filter(|(value, _)| *value != of);
        let rival = most_probable(others())?;
        Some((rival, self.probability(rival)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vocab::{Age, Gender};

    #[test]
    fn belief_names_its_best_value() {
        let belief = Belief(BTreeMap::from([(Age::Adolescent, 0.3), (Age::Young, 0.6)]));
        assert_eq!(belief.best(), Some(Age::Young));
        assert_eq!(belief.probability(Age::Elderly), 0.0);
        assert_eq!(Belief::<Age>::default().best(), None);
        assert_eq!(serde_json::to_string(&belief).unwrap(), r#"{"adolescent":0.3,"young":0.6}"#);
    }

    #[test]
    fn what_is_set_is_what_is_believed() {
        let belief = Belief(BTreeMap::from([(Age::Elderly, 0.5), (Age::Child, 0.5)]));
        let mut known = Attributes::certain([Gender::Male.into(), Age::Young.into()]);
        known.set_age(belief.clone());
        assert_eq!((known.age(), known.gender()), (belief, Belief::certain(Gender::Male)));
        // On a tie the first of the vocabulary.
        assert_eq!(known.belief(Attribute::Age).best(), Some(Age::Child.into()));
        assert_eq!(
            known.belief(Attribute::Age).rival(Age::Child.into()),
            Some((Age::Elderly.into(), 0.5))
        );
        assert_eq!(known.beliefs().count(), 2);
        known.set_age(Belief::default());
        assert!(known.belief(Attribute::Age).is_unknown());
    }
}
