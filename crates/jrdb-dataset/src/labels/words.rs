//! JRDB's label words and ours, both ways.

use jrdb_types::vocab::Occlusion;
use jrdb_types::{Action, Age, Gender, Race};

/// What annotators write when they cannot tell.
pub(crate) const IMPOSSIBLE: &str = "impossible";

/// A word of ours with JRDB's word for it.
pub(crate) trait JrdbWord: Copy + 'static {
    /// Every pair.
    const PAIRS: &'static [(Self, &'static str)];

    /// The word that labels use.
    fn jrdb_word(self) -> &'static str
    where
        Self: PartialEq,
    {
        Self::PAIRS.iter().find(|(word, _)| *word == self).map_or(IMPOSSIBLE, |(_, label)| label)
    }

    /// The word of ours for a label, in whatever case and with blanks or underscores between its parts.
    fn from_jrdb_word(label: &str) -> Option<Self> {
        let label = plain(label);
        Self::PAIRS.iter().find(|(_, known)| plain(known) == label).map(|(word, _)| *word)
    }
}

/// A label in small letters with blanks.
fn plain(label: &str) -> String {
    label.trim().to_ascii_lowercase().replace('_', " ")
}

impl JrdbWord for Age {
    const PAIRS: &'static [(Self, &'static str)] = &[
        (Self::Child, "Childhood"),
        (Self::Adolescent, "Adolescence"),
        (Self::Young, "Young_Adulthood"),
        (Self::MiddleAged, "Middle_Adulthood"),
        (Self::Elderly, "Late_Adulthood"),
    ];
}

impl JrdbWord for Gender {
    const PAIRS: &'static [(Self, &'static str)] =
        &[(Self::Male, "Male"), (Self::Female, "Female")];
}

impl JrdbWord for Race {
    const PAIRS: &'static [(Self, &'static str)] = &[
        (Self::White, "Caucasian/White"),
        (Self::Black, "Negroid/Black"),
        (Self::Asian, "Mongoloid/Asian"),
    ];

    fn from_jrdb_word(label: &str) -> Option<Self> {
        let last = plain(label.rsplit('/').next()?);
        let is_it = |known: &str| known.rsplit('/').next().is_some_and(|word| plain(word) == last);
        Self::PAIRS.iter().find(|(_, known)| is_it(known)).map(|(word, _)| *word)
    }
}

impl JrdbWord for Action {
    const PAIRS: &'static [(Self, &'static str)] = &[
        (Self::Walking, "walking"),
        (Self::Standing, "standing"),
        (Self::Sitting, "sitting"),
        (Self::Bending, "bending"),
        (Self::Running, "running"),
        (Self::Cycling, "cycling"),
        (Self::GoingUp, "going upstairs"),
        (Self::GoingDown, "going downstairs"),
        (Self::Skating, "skating"),
        (Self::Scootering, "scootering"),
    ];
}

impl JrdbWord for Occlusion {
    const PAIRS: &'static [(Self, &'static str)] = &[
        (Self::FullyVisible, "Fully_visible"),
        (Self::MostlyVisible, "Mostly_visible"),
        (Self::SeverelyOccluded, "Severely_occluded"),
        (Self::FullyOccluded, "Fully_occluded"),
    ];
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_known_in_any_case() {
        assert_eq!(Gender::from_jrdb_word("female"), Some(Gender::Female));
        assert_eq!(Age::from_jrdb_word("YOUNG ADULTHOOD"), Some(Age::Young));
        assert_eq!(Race::from_jrdb_word("mongoloid/asian"), Some(Race::Asian));
        assert_eq!(Action::from_jrdb_word("Going_Upstairs"), Some(Action::GoingUp));
        assert_eq!(Occlusion::from_jrdb_word("fully_visible"), Some(Occlusion::FullyVisible));
        assert_eq!(Gender::from_jrdb_word("impossible"), None);
    }
    use std::fmt::Debug;

    fn check_round_trip<T: JrdbWord + PartialEq + Debug>(all: &[T]) {
        for word in all {
            assert_eq!(T::from_jrdb_word(word.jrdb_word()), Some(*word));
        }
        assert_eq!(T::from_jrdb_word(IMPOSSIBLE), None);
    }

    #[test]
    fn every_word_survives_the_round_trip() {
        check_round_trip(Age::ALL);
        check_round_trip(Gender::ALL);
        check_round_trip(Race::ALL);
        check_round_trip(Action::ALL);
        check_round_trip(Occlusion::ALL);
    }

    #[test]
    fn races_are_known_by_the_part_after_the_slash() {
        assert_eq!(Race::from_jrdb_word("Anything/Asian"), Some(Race::Asian));
        assert_eq!(Race::from_jrdb_word("White"), Some(Race::White));
        assert_eq!(Race::from_jrdb_word("Others"), None);
    }
}
