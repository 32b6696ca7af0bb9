//! Sentences that may be asked about a scene: the benchmark's wording and the paper's.

use jrdb_types::detection::PERSON;
use jrdb_types::vocab::Sector;
use jrdb_types::{
    Action, Age, DistanceWord, EdgeRelation, Gender, Node, Race, SceneGraph, SpatialRelation,
};

/// The category of the paper's own sentences.
pub(super) const PAPER: &str = "paper";

/// Something to ask, in the singular.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Sentence {
    /// The benchmark's category.
    pub(super) category: &'static str,
    /// Which of a category's patterns it follows, or which of its words it must not leave out.
    pub(super) pattern: &'static str,
    pub(super) text: String,
    /// Whether the anchor of its relation may be many people.
    pub(super) is_vague: bool,
}

/// Someone as the questions see them.
struct Seen<'a> {
    node: &'a Node,
    age: Age,
    gender: Gender,
    race: Race,
    action: Action,
    distance: DistanceWord,
    sector: Sector,
}

impl<'a> Seen<'a> {
    fn new(node: &'a Node) -> Option<Self> {
        let attributes = &node.attributes;
        let robot = node.from_robot?;
        Some(Self {
            node,
            age: attributes.age().best()?,
            gender: attributes.gender().best()?,
            race: attributes.race().best()?,
            action: attributes.action().best()?,
            distance: robot.distance?,
            sector: robot.direction?.sector,
        })
    }

    fn his(&self) -> &'static str {
        if self.gender == Gender::Male { "his" } else { "her" }
    }

    /// `young, White and male`, as the benchmark lists who is asked for.
    fn who(&self) -> String {
        format!("{}, {} and {}", self.age, self.race, self.gender)
    }

    /// `young, male and White`, as the benchmark lists a partner.
    fn partner(&self) -> String {
        format!("{}, {} and {}", self.age, self.gender, self.race)
    }
}

/// Every sentence that fits somebody; whether it makes a good question shows later.
pub(super) fn sentences(graph: &SceneGraph) -> Vec<Sentence> {
    let people: Vec<Seen<'_>> =
        graph.nodes.iter().filter(|node| node.category == PERSON).filter_map(Seen::new).collect();
    let mut sentences = vec![of("human", "Find all persons".into())];
    for person in &people {
        sentences.extend(about_one(person));
        sentences.extend(paper_about_one(person));
        for (other, relation) in partners(graph, &people, person) {
            sentences.extend(about_two(person, other, relation));
        }
    }
    sentences.extend(about_objects(graph));
    sentences
}

/// The plural of a sentence of the benchmark's: it says "persons" where several are meant.
pub(super) fn plural(text: &str) -> String {
    let Some((before, after)) = text.split_once(" person") else { return text.into() };
    let is_benchmark = text.starts_with("Find ") || text.starts_with("Count ");
    if !is_benchmark || before.starts_with("Find a ") || after.starts_with('s') {
        return text.into();
    }
    format!("{before} persons{}", after.replacen(" who is ", " who are ", 1))
}

fn of(category: &'static str, text: String) -> Sentence {
    Sentence { category, pattern: category, text, is_vague: false }
}

fn paper(pattern: &'static str, text: String) -> Sentence {
    Sentence { category: PAPER, pattern, text, is_vague: pattern.starts_with("who") }
}

fn about_one(person: &Seen<'_>) -> Vec<Sentence> {
    let Seen { age, gender, action, distance, sector, .. } = person;
    let who = person.who();
    vec![
        of("age", format!("Find {age} person")),
        of("gender-age", format!("Find {age} and {gender} person")),
        of("gender-age-race", format!("Find {who} person")),
        Sentence {
            pattern: distance.word(),
            ..of(
                "gender-age-race-distance",
                format!("Find {who} person who is located to {distance} distance"),
            )
        },
        Sentence {
            pattern: distance.word(),
            ..of(
                "gender-age-race-distance-SR/robot",
                format!(
                    "Find {who} person who is located to {distance} distance and {sector} relative to me(robot)"
                ),
            )
        },
        of("action", format!("Find person who is {action}")),
        of("gender-action", format!("Find {gender} person who is {action}")),
        of("count", format!("Count {gender} person")),
        of("count", format!("Count {age} person")),
        of("count", format!("Count person who is {action}")),
    ]
}

fn paper_about_one(person: &Seen<'_>) -> Vec<Sentence> {
    let Seen { age, gender, race, action, distance, .. } = person;
    let people = match age {
        Age::Child => "children".into(),
        Age::Adolescent => "adolescents".into(),
        _ => format!("{age} people"),
    };
    vec![
        paper("age", format!("Find the {people}")),
        paper("gender", format!("Find the {gender}s")),
        paper(
            distance.word(),
            format!(
                "Find the {age} {race} {gender} positioned at a {distance} distance relative to me (the robot)."
            ),
        ),
        paper("bare", format!("{age} {gender} {action}")),
    ]
}

fn partners<'a>(
    graph: &'a SceneGraph,
    people: &'a [Seen<'a>],
    person: &'a Seen<'a>,
) -> impl Iterator<Item = (&'a Seen<'a>, &'a EdgeRelation)> {
    graph.edges.iter().filter(|edge| edge.from == person.node.id).filter_map(|edge| {
        let other = people.iter().find(|other| other.node.id == edge.to)?;
        Some((other, &edge.relation))
    })
}

fn about_two(person: &Seen<'_>, other: &Seen<'_>, relation: &EdgeRelation) -> Vec<Sentence> {
    match relation {
        EdgeRelation::Interaction { label } => vec![of(
            "gender-age-race-HHI",
            format!(
                "Find {} person who is {} with a {} person",
                person.who(),
                doing(label),
                other.partner()
            ),
        )],
        EdgeRelation::Spatial(place) => beside(person, other, place),
        EdgeRelation::Pair { .. } => Vec::new(),
    }
}

/// The benchmark's words for what people do together.
fn doing(label: &str) -> &str {
    match label {
        "conversation" => "chatting",
        label => label.strip_suffix(" together").unwrap_or(label),
    }
}

/// Where `other` is, seen from `person`; only at arm's length, as in the benchmark.
fn beside(person: &Seen<'_>, other: &Seen<'_>, place: &SpatialRelation) -> Vec<Sentence> {
    let close = [DistanceWord::VeryClose, DistanceWord::Close];
    let (Some(distance), Some(direction)) = (place.distance, place.direction) else {
        return vec![];
    };
    if !close.contains(&distance) {
        return vec![];
    }
    let (race, gender, his) = (person.race, person.gender, person.his());
    let (their_gender, seat) = (other.gender, seated(other.action));
    let anchor = match person.age {
        Age::Child => "a child".into(),
        age @ (Age::Adolescent | Age::Elderly) => format!("an {age} person"),
        age => format!("a {age} person"),
    };
    let sector = direction.sector;
    let mut sentences = vec![
        of(
            "gender-age-race-HHG",
            format!(
                "Find {} person who is a {} person located to his\\her {sector} and {distance} distance",
                person.who(),
                other.partner()
            ),
        ),
        paper(
            "has beside",
            format!(
                "Find a {race} {gender} who has a {their_gender} positioned to {his} {sector} at a {distance} distance."
            ),
        ),
        paper("who is at", format!("Who is positioned at the {sector} of {anchor}?")),
    ];
    if [Sector::Left, Sector::Right].contains(&sector) {
        let anchor = seated(person.action);
        let text = format!("Who is {seat} to the {sector} of the {anchor} person?");
        sentences.push(paper("who does what at", text));
    }
    sentences
}

fn seated(action: Action) -> &'static str {
    match action {
        Action::Sitting => "seated",
        action => action.word(),
    }
}

fn about_objects(graph: &SceneGraph) -> Vec<Sentence> {
    let objects = graph.nodes.iter().filter(|node| node.category != PERSON);
    let sectors = objects.filter_map(|node| Some(node.from_robot?.direction?.sector));
    let place = |sector: Sector| match sector {
        Sector::Front => "in front of the robot".into(),
        Sector::Back => "behind the robot".into(),
        sector => format!("to the {sector} of the robot"),
    };
    let ask = |sector| format!("Which objects are located {}?", place(sector));
    let pattern = |sector| if sector == Sector::Front { "objects ahead" } else { "objects" };
    sectors.map(|sector| paper(pattern(sector), ask(sector))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_plural_is_the_benchmark_s() {
        let cases = [
            ("Find young and male person", "Find young and male persons"),
            ("Find person who is sitting", "Find persons who are sitting"),
            (
                "Find child, White and male person who is a young, male and Asian person located to his\\her left and close distance",
                "Find child, White and male persons who are a young, male and Asian person located to his\\her left and close distance",
            ),
            ("Count person who is walking", "Count persons who are walking"),
            ("Find all persons", "Find all persons"),
            ("Find the young people", "Find the young people"),
            (
                "Who is positioned at the left of a young person?",
                "Who is positioned at the left of a young person?",
            ),
        ];
        for (singular, wanted) in cases {
            assert_eq!(plural(singular), wanted);
            assert_eq!(jrdb_parser::parse(singular).target, jrdb_parser::parse(wanted).target);
        }
    }
}
