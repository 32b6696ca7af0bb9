//! The closed vocabularies: what can be said of a person, and what the words of distance and
//! direction mean.

use std::fmt;

use serde::{Deserialize, Serialize};

/// A closed list of words. The JSON form is the variant in `snake_case`; [`fmt::Display`] gives the
/// word as the JRDB-Reasoning benchmark spells it.
macro_rules! vocabulary {
    ($(#[$doc:meta])* $name:ident { $($(#[$variant_doc:meta])* $variant:ident = $word:literal,)+ }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
        #[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
        #[serde(rename_all = "snake_case")]
        pub enum $name { $($(#[$variant_doc])* $variant,)+ }

        impl $name {
            /// Every word, in order.
            pub const ALL: &[Self] = &[$(Self::$variant),+];

            /// The spelling of every word, in order.
            pub const WORDS: &[&'static str] = &[$($word),+];

            /// The word as the benchmark spells it.
            #[must_use]
            pub const fn word(self) -> &'static str {
                match self { $(Self::$variant => $word,)+ }
            }

            /// The entry with this spelling.
            #[must_use]
            pub fn from_word(word: &str) -> Option<Self> {
                Self::ALL.iter().copied().find(|entry| entry.word() == word)
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(self.word())
            }
        }
    };
}

mod color;
mod heading;
mod headwear;

pub use color::Color;
pub use heading::{Facing, HeadingSource};
pub use headwear::Headwear;

vocabulary! {
    /// Age group as an annotator or model sees it.
    Age {
        /// JRDB-Social `Childhood`.
        Child = "child",
        /// JRDB-Social `Adolescence`.
        Adolescent = "adolescent",
        /// JRDB-Social `Young_Adulthood`.
        Young = "young",
        /// JRDB-Social `Middle_Adulthood`.
        MiddleAged = "middle-aged",
        /// JRDB-Social `Late_Adulthood`.
        Elderly = "elderly",
    }
}

vocabulary! {
    /// Gender as an annotator or model sees it.
    Gender {
        /// JRDB-Social `Male`.
        Male = "male",
        /// JRDB-Social `Female`.
        Female = "female",
    }
}

vocabulary! {
    /// The benchmark's race words, as an annotator or model sees them.
    Race {
        /// JRDB-Social `Caucasian/White`.
        White = "White",
        /// JRDB-Social `Negroid/Black`.
        Black = "Black",
        /// JRDB-Social `Mongoloid/Asian`.
        Asian = "Asian",
    }
}

vocabulary! {
    /// What the body does: the pose actions of JRDB-Act.
    Action {
        /// On the way on foot.
        Walking = "walking",
        /// Upright and still.
        Standing = "standing",
        /// Seated.
        Sitting = "sitting",
        /// Bent over.
        Bending = "bending",
        /// On the way, fast.
        Running = "running",
        /// On a bicycle.
        Cycling = "cycling",
        /// Upstairs.
        GoingUp = "going up",
        /// Downstairs.
        GoingDown = "going down",
        /// On a skateboard or skates.
        Skating = "skating",
        /// On a scooter.
        Scootering = "scootering",
    }
}

vocabulary! {
    /// Distance in words: five right-closed bins of the distance between centres
    /// (JRDB-Reasoning `discretize_distances2`).
    DistanceWord {
        /// At most 0.5 m.
        VeryClose = "very close",
        /// Over 0.5 m, at most 1.5 m.
        Close = "close",
        /// Over 1.5 m, at most 5 m.
        Moderate = "moderate",
        /// Over 5 m, at most 10 m.
        Far = "far",
        /// Over 10 m.
        VeryFar = "very far",
    }
}

impl DistanceWord {
    /// The word for a distance in metres; none when it is not a number.
    #[must_use]
    pub fn of_metres(distance_m: f64) -> Option<Self> {
        Self::ALL.iter().copied().find(|word| distance_m <= word.bounds_m().1)
    }

    /// Lower bound (exclusive) and upper bound (inclusive), metres.
    #[must_use]
    pub const fn bounds_m(self) -> (f64, f64) {
        match self {
            Self::VeryClose => (0.0, 0.5),
            Self::Close => (0.5, 1.5),
            Self::Moderate => (1.5, 5.0),
            Self::Far => (5.0, 10.0),
            Self::VeryFar => (10.0, f64::INFINITY),
        }
    }
}

vocabulary! {
    /// Eight horizontal sectors of unequal width around a robot or person.
    Sector {
        /// 60° wide.
        Front = "front",
        /// 15° wide.
        FrontLeft = "front left",
        /// 90° wide.
        Left = "left",
        /// 10° wide.
        BackLeft = "back left",
        /// 70° wide.
        Back = "back",
        /// 10° wide.
        BackRight = "back right",
        /// 90° wide.
        Right = "right",
        /// 15° wide.
        FrontRight = "front right",
    }
}

impl Sector {
    /// The sector of an angle, degrees counter-clockwise from the front, under the physical convention (JRDB-Reasoning
    /// `Position_relative_to_Ref` as it was before left and right were exchanged): `[-30, 30]` front, `(30, 45]` front left,
    /// `(45, 135]` left, `(135, 145]` back left, `(-45, -30)` front right, `(-135, -45]` right, `(-145, -135]` back right, else back.
    #[must_use]
    pub fn of_degrees(angle: f64) -> Self {
        // Angles of the usual half turns keep their last bit, on which the bounds depend.
        let is_usual = angle.abs() <= 180.0;
        match if is_usual { angle } else { (angle + 180.0).rem_euclid(360.0) - 180.0 } {
            a if (-30.0..=30.0).contains(&a) => Self::Front,
            a if a > 30.0 && a <= 45.0 => Self::FrontLeft,
            a if a > 45.0 && a <= 135.0 => Self::Left,
            a if a > 135.0 && a <= 145.0 => Self::BackLeft,
            a if a > -45.0 && a < -30.0 => Self::FrontRight,
            a if a > -135.0 && a <= -45.0 => Self::Right,
            a if a > -145.0 && a <= -135.0 => Self::BackRight,
            _ => Self::Back,
        }
    }

    /// The name of this sector under a convention.
    #[must_use]
    pub const fn named(self, lateral: LateralConvention) -> Self {
        match lateral {
            LateralConvention::Physical => self,
            LateralConvention::BenchmarkMirrored => self.mirrored(),
        }
    }

    /// The same sector with left and right exchanged.
    #[must_use]
    pub const fn mirrored(self) -> Self {
        match self {
            Self::Front => Self::Front,
            Self::FrontLeft => Self::FrontRight,
            Self::Left => Self::Right,
            Self::BackLeft => Self::BackRight,
            Self::Back => Self::Back,
            Self::BackRight => Self::BackLeft,
            Self::Right => Self::Left,
            Self::FrontRight => Self::FrontLeft,
        }
    }

    /// From and to, degrees counter-clockwise (towards the physical left), under the physical
    /// convention; `Back` goes from 145 to 215. Which bound belongs to which sector says
    /// [`Sector::of_degrees`].
    #[must_use]
    pub const fn bounds_deg(self) -> (f64, f64) {
        match self {
            Self::Front => (-30.0, 30.0),
            Self::FrontLeft => (30.0, 45.0),
            Self::Left => (45.0, 135.0),
            Self::BackLeft => (135.0, 145.0),
            Self::Back => (145.0, 215.0),
            Self::BackRight => (-145.0, -135.0),
            Self::Right => (-135.0, -45.0),
            Self::FrontRight => (-45.0, -30.0),
        }
    }
}

vocabulary! {
    /// Whether something is over or under by more than 1.5 m.
    Elevation {
        /// Within 1.5 m of the same height.
        Level = "level",
        /// More than 1.5 m higher.
        Up = "up",
        /// More than 1.5 m lower.
        Down = "down",
    }
}

/// Something farther up or down than this is not level any more, metres (JRDB-Reasoning `Position_relative_to_Ref`).
pub const LEVEL_RISE_MAX_M: f64 = 1.5;

impl Elevation {
    /// The word for a height difference, metres: up or down beyond [`LEVEL_RISE_MAX_M`].
    #[must_use]
    pub fn of_rise(rise_m: f64) -> Self {
        match rise_m {
            rise if rise > LEVEL_RISE_MAX_M => Self::Up,
            rise if rise < -LEVEL_RISE_MAX_M => Self::Down,
            _ => Self::Level,
        }
    }
}

/// Where something is, in words: a horizontal sector and an elevation.
///
/// Displayed as `front left`, or `up front left` when it is not level.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Direction {
    /// Horizontal sector.
    pub sector: Sector,
    /// Level, up or down.
    pub elevation: Elevation,
}

impl Direction {
    /// A direction at the same height.
    #[must_use]
    pub const fn level(sector: Sector) -> Self {
        Self { sector, elevation: Elevation::Level }
    }
}

impl fmt::Display for Direction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.elevation {
            Elevation::Level => write!(f, "{}", self.sector),
            elevation => write!(f, "{elevation} {}", self.sector),
        }
    }
}

vocabulary! {
    /// Which side the word "left" names.
    LateralConvention {
        /// Left is left: counter-clockwise seen from above.
        Physical = "physical",
        /// As the JRDB-Reasoning engine has named it since 2026-02: left and right exchanged, and for
        /// people up and down exchanged too.
        #[serde(rename = "engine_head")]
        BenchmarkMirrored = "engine-head",
    }
}

impl Default for LateralConvention {
    /// Left is left; the benchmark's mirrored names are asked for by name.
    fn default() -> Self {
        Self::Physical
    }
}

vocabulary! {
    /// How much of a person others hide, as JRDB's annotators saw it.
    Occlusion {
        /// `Fully_visible`.
        FullyVisible = "fully visible",
        /// `Mostly_visible`.
        MostlyVisible = "mostly visible",
        /// `Severely_occluded`.
        SeverelyOccluded = "severely occluded",
        /// `Fully_occluded`.
        FullyOccluded = "fully occluded",
    }
}

vocabulary! {
    /// How far a position from points can be trusted.
    PlacementQuality {
        /// Enough points, little in front: on one real frame right to 0.06 m in the median of 12 people.
        Good = "good",
        /// Few points, or half hidden. Doubtful and poor together: 0.9 m in the median of 8 people of that frame.
        Doubtful = "doubtful",
        /// Hardly any point of its own, or a size that no person has: may be somebody else's place.
        Poor = "poor",
    }
}

vocabulary! {
    /// What holds between two things; the exact definitions are with the code, in
    /// `jrdb_projection::relation`.
    PairWord {
        /// Their boxes are within arm's reach.
        Adjacent = "next to",
        /// Their boxes overlap.
        Overlapping = "overlapping",
        /// The first hides a part of the second from the robot.
        Hides = "in front of",
        /// The second hides a part of the first from the robot.
        HiddenBy = "behind",
        /// The first looks at the second.
        Facing = "facing",
        /// Each looks at the other.
        FacingEachOther = "facing each other",
        /// They move the same way.
        SameDirection = "moving with",
    }
}

vocabulary! {
    /// How many of the asked attributes a candidate must have.
    MatchPolicy {
        /// All of them: the benchmark's ground truth.
        Strict = "strict",
        /// More than half of them: the paper's phase 1.
        Majority = "majority",
        /// The paper's two phases, then the best-satisfied tier by probability.
        Ranked = "ranked",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_json_differ_and_both_are_stable() {
        assert_eq!(Age::MiddleAged.to_string(), "middle-aged");
        assert_eq!(serde_json::to_string(&Age::MiddleAged).unwrap(), r#""middle_aged""#);
        assert_eq!(DistanceWord::from_word("very close"), Some(DistanceWord::VeryClose));
        assert_eq!(Sector::from_word("frontleft"), None);
    }

    #[test]
    fn sectors_tile_the_circle_and_mirror_onto_each_other() {
        let width: f64 = Sector::ALL.iter().map(|s| s.bounds_deg().1 - s.bounds_deg().0).sum();
        assert_eq!(width, 360.0);
        for sector in Sector::ALL {
            assert_eq!(sector.mirrored().mirrored(), *sector);
        }
    }

    #[test]
    fn shared_bounds_belong_to_the_benchmark_s_sector() {
        let exact = |degrees: f64| Sector::of_degrees(degrees).word();
        assert_eq!(
            [exact(30.0), exact(45.0), exact(135.0), exact(145.0)],
            ["front", "front left", "left", "back left"]
        );
        assert_eq!(
            [exact(-30.0), exact(-45.0), exact(-135.0), exact(-145.0)],
            ["front", "right", "back right", "back"]
        );
        assert_eq!([exact(180.0), exact(190.0), exact(315.0)], ["back", "back", "right"]);
    }

    #[test]
    fn distance_bins_tile_the_ray() {
        for pair in DistanceWord::ALL.windows(2) {
            assert_eq!(pair[0].bounds_m().1, pair[1].bounds_m().0);
        }
    }

    #[test]
    fn a_level_direction_is_just_its_sector() {
        assert_eq!(Direction::level(Sector::FrontLeft).to_string(), "front left");
        let up = Direction { sector: Sector::Back, elevation: Elevation::Up };
        assert_eq!(up.to_string(), "up back");
    }
}
