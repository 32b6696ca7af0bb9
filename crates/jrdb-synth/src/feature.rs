//! How people look beyond their attributes: what no vocabulary holds.

use std::collections::BTreeSet;

use jrdb_types::vocab::Facing;
use jrdb_types::{Action, Age, Gender};
use serde::{Deserialize, Serialize};

use super::cast::Cast;
use super::config::SynthConfig;
use super::person::{Look, Person};
use super::random::Random;
use super::room::Color;

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

/// The configuration with looks dealt to everybody. The same configuration gives the same looks.
///
/// ```
/// use jrdb_synth::{SynthConfig, generate, with_looks};
/// let config = with_looks(&SynthConfig::default());
/// assert_eq!(config.looks.len(), config.people);
/// assert_eq!(generate(&config).config().looks, config.looks);
/// ```
#[must_use]
pub fn with_looks(config: &SynthConfig) -> SynthConfig {
    let plain = super::generate(&SynthConfig { looks: Vec::new(), ..config.clone() });
    let mut random = Random::stream(config.seed, 4);
    let people = plain.cast.people.iter();
    let looks = people.map(|person| deal(person, &mut random).into_iter().collect()).collect();
    super::generate(&SynthConfig { looks, ..plain.config }).config
}

/// What somebody looks like besides what they have anyway: one shirt, one thing around the neck.
fn deal(person: &Person, random: &mut Random) -> BTreeSet<Feature> {
    const SHIRTS: [Option<Feature>; 7] = [
        Some(Feature::StripedShirt),
        Some(Feature::StripedShirt),
        Some(Feature::DottedShirt),
        Some(Feature::DottedShirt),
        None,
        None,
        None,
    ];
    const NECKS: [Option<Feature>; 6] = [
        Some(Feature::Scarf),
        Some(Feature::Tie),
        Some(Feature::Tie),
        Some(Feature::Apron),
        None,
        None,
    ];
    let is_man = person.gender == Gender::Male;
    let has_beard = is_man && !matches!(person.age, Age::Child | Age::Adolescent);
    let hair = if is_man { 0.25 } else { 0.4 };
    let mut some = |feature, chance: f64| random.chance(chance).then_some(feature);
    let mut dealt = vec![
        some(Feature::Glasses, 0.35),
        some(Feature::Headphones, 0.25),
        some(Feature::Umbrella, if person.look.cane { 0.0 } else { 0.3 }),
        some(Feature::LongHair, hair),
        some(Feature::Beard, if has_beard { 0.6 } else { 0.0 }),
    ];
    dealt.extend([random.pick(&SHIRTS), random.pick(&NECKS)]);
    dealt.into_iter().flatten().collect()
}

/// Gives people the looks that are listed, in the order of their numbers. Returns what is then true
/// of each; nothing when nothing is listed.
pub(super) fn dress(cast: &mut Cast, listed: &[Vec<Feature>]) -> Vec<Vec<Feature>> {
    for (person, wanted) in cast.people.iter_mut().zip(listed) {
        let has = |feature| wanted.contains(&feature);
        person.look.skirt |= has(Feature::Skirt);
        person.look.cane |= has(Feature::Cane);
        let bag = has(Feature::Backpack).then_some(BACKPACK);
        person.look.bag = person.look.bag.or(bag);
        person.features = wanted.iter().copied().collect();
    }
    for person in &mut cast.people {
        person.features.extend(natural(person));
    }
    let all = |person: &Person| person.features.iter().copied().collect();
    if listed.is_empty() { Vec::new() } else { cast.people.iter().map(all).collect() }
}

const BACKPACK: Color = [60, 64, 72];

/// What somebody has without being asked to.
fn natural(person: &Person) -> impl Iterator<Item = Feature> + use<> {
    let Look { skirt, bag, cane, .. } = person.look;
    let has_long_hair = person.gender == Gender::Female && person.age != Age::Elderly;
    let all = [
        (Feature::Skirt, skirt),
        (Feature::Backpack, bag.is_some()),
        (Feature::Cane, cane),
        (Feature::LongHair, has_long_hair),
    ];
    all.into_iter().filter(|(_, holds)| *holds).map(|(feature, _)| feature)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{World, generate};

    /// How many of the pixels in a person's box differ between two worlds of the same people.
    fn changed(plain: &World, other: &World, person: usize) -> usize {
        let [a, b] = [plain, other].map(|world| world.view(0));
        let seen = &b.people[person];
        let own = |pixel: &usize| b.instances[*pixel] == seen.instance;
        let differs =
            |pixel: &usize| a.image.rgb[3 * pixel..][..3] != b.image.rgb[3 * pixel..][..3];
        (0..b.instances.len()).filter(own).filter(differs).count()
    }

    #[test]
    fn what_shows_is_drawn() {
        let config = SynthConfig { seed: 3, people: 4, ..SynthConfig::default() };
        let plain = generate(&config);
        let plain_view = plain.view(0);
        for feature in Feature::ALL {
            let looks = vec![vec![feature]; 4];
            let dressed = generate(&SynthConfig { looks, ..config.clone() });
            for (person, seen) in plain_view.people.iter().enumerate() {
                let is_new = !seen.features.contains(&feature);
                if is_new && seen.shows(feature) && plain_view.visible(seen) > 0.9 {
                    let pixels = changed(&plain, &dressed, person);
                    assert!(pixels > 40, "{feature:?} of {person}: {pixels}");
                }
            }
        }
    }

    #[test]
    fn dealt_looks_are_stated_and_draw_the_same_again() {
        let config = with_looks(&SynthConfig { seed: 8, people: 12, ..SynthConfig::default() });
        let text = serde_json::to_string(&config).unwrap();
        assert!(text.contains("striped_shirt"), "{text}");
        let (view, read) = (generate(&config).view(0), serde_json::from_str(&text).unwrap());
        assert_eq!(generate(&read).view(0), view);
        for (seen, listed) in view.people.iter().zip(&config.looks) {
            assert_eq!(seen.features, *listed);
        }
        let dealt = |feature| config.looks.iter().any(|all| all.contains(&feature));
        assert!(Feature::ALL.into_iter().filter(|feature| dealt(*feature)).count() >= 10);
    }

    #[test]
    fn without_looks_nothing_is_stated_and_nothing_changes() {
        let config = SynthConfig { seed: 5, people: 3, ..SynthConfig::default() };
        let plain = generate(&config);
        assert!(!serde_json::to_string(plain.config()).unwrap().contains("looks"));
        let none = SynthConfig { looks: vec![Vec::new(); 3], ..config };
        assert_eq!(generate(&none).view(0), plain.view(0));
    }
}
