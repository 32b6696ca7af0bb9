//! The words of a reply, to be compared with those of the truth.

use std::collections::BTreeSet;

use jrdb_types::Condition;
use jrdb_types::answer::{DirectionFound, DistanceFound, PropertyValue, PropertyValues, Reply};

/// The words that a reply tells: of an attribute its most probable value; of a place the words of
/// distance and direction; without numbers and partners, in lower case.
pub(crate) fn words(reply: &Reply) -> BTreeSet<String> {
    let Reply::Properties(told) = reply else { return BTreeSet::new() };
    told.iter().flat_map(words_of).map(|word| plain(&word)).collect()
}

/// A word as it is compared.
pub(crate) fn plain(word: &str) -> String {
    word.trim().to_lowercase()
}

fn words_of(of: &PropertyValues) -> Vec<String> {
    let is_attribute = |value: &&PropertyValue| matches!(value, PropertyValue::Attribute { .. });
    let attribute = of.values.iter().find(is_attribute);
    let others = of.values.iter().filter(|value| !is_attribute(value));
    attribute.into_iter().chain(others).flat_map(value_words).collect()
}

fn value_words(value: &PropertyValue) -> Vec<String> {
    match value {
        PropertyValue::Attribute { value, .. } => vec![value.to_string()],
        PropertyValue::Category(name) => vec![name.clone()],
        PropertyValue::Distance(found) => distance(found).into_iter().collect(),
        PropertyValue::Direction(found) => direction(found).into_iter().collect(),
        PropertyValue::Option(Condition::Attribute(value)) => vec![value.to_string()],
        PropertyValue::Height(_)
        | PropertyValue::Speed(_)
        | PropertyValue::Heading(_)
        | PropertyValue::Option(_) => Vec::new(),
        PropertyValue::Interaction { label, .. } => vec![label.clone()],
        PropertyValue::Around { direction: to, distance: far, .. }
        | PropertyValue::Place { direction: to, distance: far, .. } => {
            let to = to.as_ref().and_then(direction);
            to.into_iter().chain(far.as_ref().and_then(distance)).collect()
        }
    }
}

fn distance(found: &DistanceFound) -> Option<String> {
    found.word.map(|word| word.to_string())
}

fn direction(found: &DirectionFound) -> Option<String> {
    found.word.map(|word| word.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use jrdb_types::{Age, DistanceWord, EntityId};

    #[test]
    fn the_most_probable_value_and_the_word_of_a_place_are_told() {
        let value =
            |age: Age, probability| PropertyValue::Attribute { value: age.into(), probability };
        let metres = Some(1.2);
        let close = DistanceFound { word: Some(DistanceWord::Close), metres };
        let values =
            vec![value(Age::Young, 0.6), value(Age::Elderly, 0.4), PropertyValue::Distance(close)];
        let id = EntityId::new("pedestrian", 1);
        let told = PropertyValues { id, property: None, values, words: Vec::new() };
        let told = words(&Reply::Properties(vec![told]));
        assert_eq!(told, ["close", "young"].map(String::from).into());
    }
}
