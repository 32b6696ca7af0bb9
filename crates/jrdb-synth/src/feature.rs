//! How people look beyond their attributes: what no vocabulary holds.

use jrdb_types::Action;
use jrdb_types::vocab::Facing;
use serde::{Deserialize, Serialize};

/// Something about the looks of a person that no vocabulary holds. All of them can be drawn on anybody.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Feature {
    /// Stripes around the trunk and the sleeves.
    StripedShirt,
    /// Large dots on the trunk and the sleeves.
    DottedShirt,
    /// Glasses with thick dark rims.
    Glasses,
    /// A full beard.
    Beard,
    /// Hair down to the shoulders.
    LongHair,
    /// A thick scarf with one end hanging down.
    Scarf,
    /// A tie on a white collar.
    Tie,
    /// A closed umbrella, held.
    Umbrella,
    /// A light apron from the chest to above the knees.
    Apron,
    /// Headphones over the head.
    Headphones,
    /// A skirt.
    Skirt,
    /// A rucksack on the back.
    Backpack,
    /// A cane in the hand.
    Cane,
}

impl Feature {
    /// All of them.
    pub const ALL: [Self; 13] = [
        Self::StripedShirt,
        Self::DottedShirt,
        Self::Glasses,
        Self::Beard,
        Self::LongHair,
        Self::Scarf,
        Self::Tie,
        Self::Umbrella,
        Self::Apron,
        Self::Headphones,
        Self::Skirt,
        Self::Backpack,
        Self::Cane,
    ];

    /// The phrase that asks for it.
    #[must_use]
    pub fn phrase(self) -> &'static str {
        match self {
            Self::StripedShirt => "striped shirt",
            Self::DottedShirt => "dotted shirt",
            Self::Glasses => "glasses",
            Self::Beard => "beard",
            Self::LongHair => "long hair",
            Self::Scarf => "scarf",
            Self::Tie => "tie",
            Self::Umbrella => "umbrella",
            Self::Apron => "apron",
            Self::Headphones => "headphones",
            Self::Skirt => "skirt",
            Self::Backpack => "backpack",
            Self::Cane => "cane",
        }
    }

    /// Whether it is above the neck.
    #[must_use]
    pub fn is_on_the_head(self) -> bool {
        matches!(self, Self::Glasses | Self::Beard | Self::LongHair | Self::Headphones)
    }

    /// Whether a picture shows it, or shows that it is absent: somebody seen from behind may wear
    /// glasses or not.
    #[must_use]
    pub fn shows(self, facing: Facing, action: Action) -> bool {
        let (front, back) = (facing == Facing::Towards, facing == Facing::Away);
        let sits = action == Action::Sitting;
        match self {
            Self::StripedShirt
            | Self::DottedShirt
            | Self::LongHair
            | Self::Scarf
            | Self::Umbrella
            | Self::Headphones => true,
            Self::Glasses | Self::Beard | Self::Apron => !back,
            Self::Tie => front,
            Self::Skirt => !(sits && back),
            Self::Backpack => !(sits || front),
            Self::Cane => !sits,
        }
    }
}
