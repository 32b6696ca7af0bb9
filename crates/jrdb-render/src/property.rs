//! Values of properties, in words.

use jrdb_types::answer::{
    DirectionFound, DistanceFound, HeadingFound, Landmark, PropertyValue, PropertyValues,
};

use crate::check::attribute;
use crate::wording;

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
        PropertyValue::Height(metres) => format!("{metres:.2} m"),
        PropertyValue::Speed(speed) => format!("{speed:.1} m/s"),
        PropertyValue::Heading(found) => heading(*found),
        PropertyValue::Option(condition) => wording::condition(condition),
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

/// Half of the angle within which a heading is towards the robot, or away from it, degrees.
const TOWARDS_DEG: f64 = 45.0;

/// `towards the robot, forward`, `to the left`: as the robot sees it.
fn heading(found: HeadingFound) -> String {
    let robot = match found.off_robot {
        Some(off) if off <= TOWARDS_DEG => Some("towards the robot"),
        Some(off) if off >= 180.0 - TOWARDS_DEG => Some("away from the robot"),
        _ => None,
    };
    let way = match found.degrees {
        d if d.abs() <= 45.0 => "forward",
        d if d.abs() >= 135.0 => "backward",
        d if d > 0.0 => "to the left",
        _ => "to the right",
    };
    robot.into_iter().chain([way]).collect::<Vec<_>>().join(", ")
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
