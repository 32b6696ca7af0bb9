//! Values of properties, in words.

use jrdb_types::answer::{DirectionFound, DistanceFound, Landmark, PropertyValue, PropertyValues};

use crate::check::attribute;

/// The values in words, one for each; the words of the file where it has no values.
pub(crate) fn words(of: &PropertyValues) -> Vec<String> {
    if of.values.is_empty() {
        return of.words.clone();
    }
    of.values.iter().map(property_value).collect()
}

/// One value of a property in words: `sitting (0.70)`, `1.2 m, close`, `conversation: #3`.
#[must_use]
pub fn property_value(value: &PropertyValue) -> String {
    match value {
        PropertyValue::Attribute { value, probability } => attribute(*value, *probability),
        PropertyValue::Category(name) => name.clone(),
        PropertyValue::Distance(found) => distance(found),
        PropertyValue::Direction(found) => direction(found),
        PropertyValue::Interaction { label, partner } => format!("{label}: {}", partner.short()),
        PropertyValue::Around { id, direction: to, distance: far } => {
            let place = to.iter().map(direction).chain(far.iter().map(distance));
            format!("{}: {}", id.short(), place.collect::<Vec<_>>().join(", "))
        }
        PropertyValue::Place { distance: far, direction: to, landmark } => {
            let place = far.iter().map(distance).chain(to.iter().map(direction));
            let place = place.collect::<Vec<_>>().join("; ");
            format!("{place}{}", landmark.as_ref().map(beside).unwrap_or_default())
        }
    }
}

fn beside(landmark: &Landmark) -> String {
    let how = if landmark.is_close { "next to" } else { "near" };
    format!(", {how} {} ({:.1} m)", landmark.id.short(), landmark.metres)
}

/// `1.2 m, close`.
fn distance(found: &DistanceFound) -> String {
    let metres = found.metres.map(|metres| format!("{metres:.1} m"));
    let word = found.word.map(|word| word.to_string());
    metres.into_iter().chain(word).collect::<Vec<_>>().join(", ")
}

/// `front left, 34° to the left`.
fn direction(found: &DirectionFound) -> String {
    let word = found.word.map(|word| word.to_string());
    let degrees = found.degrees.map(|degrees| match degrees.round() {
        0.0 => "straight ahead".into(),
        left if left > 0.0 => format!("{left:.0}° to the left"),
        right => format!("{:.0}° to the right", right.abs()),
    });
    word.into_iter().chain(degrees).collect::<Vec<_>>().join(", ")
}
