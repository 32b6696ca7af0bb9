//! Changes that would change an answer, in words.

use jrdb_types::answer::{Change, Criterion, Effect, Unit};

use crate::check::criterion;

/// `would leave: #2, close distance from the robot, at 1.50 m instead of 1.32 m (1.3 standard deviations)`.
#[must_use]
pub fn change(change: &Change) -> String {
    let effect = match change.effect {
        Effect::Enters => "would enter",
        Effect::Leaves => "would leave",
    };
    let unit = match change.measured.unit {
        Unit::Metres => " m",
        Unit::Degrees => "°",
        Unit::MetresPerSecond => " m/s",
        Unit::Probability | Unit::Count | Unit::AgeGroup => "",
    };
    let of = change.witness.as_ref().map(|id| format!(" of {}", id.short())).unwrap_or_default();
    let deviations =
        change.deviations.map(|n| format!(" ({n:.1} standard deviations)")).unwrap_or_default();
    format!(
        "{effect}: {}, {}{of}, at {:.2}{unit} instead of {:.2}{unit}{deviations}",
        change.id.short(),
        condition(change),
        change.to,
        change.measured.value
    )
}

/// The condition that a change is about, in words.
pub(crate) fn condition(change: &Change) -> String {
    match &change.criterion {
        Criterion::Unstated => change.words.clone(),
        stated => criterion(stated),
    }
}
