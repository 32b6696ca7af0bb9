//! Colour words are races only directly before a person and behind "is" with a person as subject.
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]

use jrdb_parser::parse;

const COLORS: [&str; 2] = ["black", "white"];

/// Sentences with a colour word, `{}`, that speaks of clothes, bodies and things.
const OTHERS: [&str; 75] = [
    "the man in {}",
    "the woman in all {}",
    "a person in a {} top",
    "{} shirt guy",
    "his {} hair",
    "the {} van",
    "a {} dog",
    "the man with the {} bag",
    "who wears {}?",
    "the woman in the {} coat",
    "is the shirt of the man {}?",
    "is the boy's jacket {}?",
    "what is next to the {} car?",
    "the kid with the {} shoes",
    "a {} umbrella",
    "the person holding a {} balloon",
    "somebody dressed in {}",
    "the lady with {} gloves",
    "the man with a {} beard",
    "people wearing {} hats",
    "the {} haired woman",
    "the man on the {} chair",
    "a {} leather jacket",
    "how many people wear {} shoes?",
    "is there a {} cat?",
    "the guy with {} sunglasses",
    "the woman carrying a {} suitcase",
    "the {} table near the door",
    "is anyone wearing {}?",
    "the boy with the {} cap",
    "the girl in {} and red",
    "the {} and red dress",
    "the person whose trousers are {}",
    "is her dress {}?",
    "are his shoes {}?",
    "the man in the {} suit",
    "a woman with a {} scarf",
    "find the {} bag",
    "follow the man in the {} jacket",
    "bring this to the lady in {}",
    "the {} jacket man",
    "the man next to the {} wall",
    "who is behind the {} door?",
    "the {} box on the table",
    "the woman with {} boots",
    "the lady in a {} dress with a bag",
    "who has a {} tee on?",
    "somebody with a {} mask",
    "the {} t-shirt person",
    "the man wearing something {}",
    "the kid in {} jeans",
    "two women in {} blouses",
    "a {} truck",
    "the dog with the {} collar",
    "the {} shoes",
    "a man, {} trousers, sitting",
    "is the car {}?",
    "the person with the {} headphones",
    "the teenager in a {} hoodie",
    "the {} skirt girl",
    "the man in the {} hat",
    "a {} horse",
    "the guy holding the {} phone",
    "the {} board on the wall",
    "the tall man in {} shorts",
    "the woman in a {} raincoat",
    "an old man with {} eyebrows",
    "the {} bench",
    "the child with the {} backpack",
    "people in {} uniforms",
    "the runner in {}",
    "the cyclist with a {} helmet",
    "the {} scooter",
    "the man with the {} tie",
    "his {} eyes",
];

/// Sentences in which the colour word is a race.
const RACES: [&str; 25] = [
    "the {} man",
    "a {} woman",
    "{} people",
    "two {} men",
    "the young {} girl",
    "the {} one in red",
    "is the man {}?",
    "is she {}?",
    "who is {}?",
    "the person who is {}",
    "an elderly {} lady",
    "{} men in suits",
    "how many {} women are there?",
    "is the tall man {}?",
    "the {} guy in the red shirt",
    "the man next to the {} woman",
    "is the person closest to me {}?",
    "are there any {} children?",
    "the {} boy",
    "is the cyclist {}?",
    "find a {} person",
    "the {} teenager",
    "{} and female persons",
    "the old {} man",
    "is anyone {}?",
];

/// Whether a query asks for a race.
fn has_race(text: &str) -> bool {
    let query = parse(text);
    let json = serde_json::to_string(&query.target).unwrap();
    let task = serde_json::to_string(&query.task).unwrap();
    [json, task].iter().any(|text| text.contains("\"race\""))
}

fn each(sentences: &[&str]) -> Vec<String> {
    let with = |sentence: &&str| {
        COLORS.map(|color| {
            let said = sentence.replace("{}", color);
            [said.clone(), format!("please tell me, {said}")]
        })
    };
    sentences.iter().flat_map(with).flatten().collect()
}

#[test]
fn no_colour_of_clothes_bodies_or_things_is_a_race() {
    let all = each(&OTHERS);
    assert_eq!(all.len(), 300);
    let wrong: Vec<&String> = all.iter().filter(|text| has_race(text)).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn a_colour_before_a_person_and_behind_is_is_a_race() {
    let wrong: Vec<String> = each(&RACES).into_iter().filter(|text| !has_race(text)).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}
