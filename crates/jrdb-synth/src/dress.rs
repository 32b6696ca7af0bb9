//! Deals looks to people, and gives them those that are listed.

use std::collections::BTreeSet;

use jrdb_types::{Age, Gender};

use super::cast::Cast;
use super::feature::Feature;
use super::person::{Look, Person};
use super::random::Random;
use super::room::Color;

/// What somebody looks like besides what they have anyway: one shirt, one thing around the neck.
pub(super) fn deal(person: &Person, random: &mut Random) -> BTreeSet<Feature> {
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
