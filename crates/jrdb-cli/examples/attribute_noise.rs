//! What the three ways of matching are worth when perception is not perfect.
//!
//! Scenes as `jrdb synth` makes them, with their true boxes in space; then every attribute of every person is flipped
//! to another value with a fixed probability, and believed as far as that probability says. Questions in the
//! benchmark's categories are asked of the noisy graph, and scored against the strict answer on the true one.
//!
//! `cargo run --release --example attribute_noise -- [SCENES]`

#![allow(clippy::print_stdout, reason = "a table is what it makes")]

use std::collections::BTreeMap;

use jrdb_graph::GraphConfig;
use jrdb_metrics::{MetricsConfig, Outcome};
use jrdb_projection::{ProjectionConfig, Scan};
use jrdb_search::{SearchConfig, search};
use jrdb_synth::{SynthConfig, calibration, generate};
use jrdb_types::query::{Category, Pattern, Place, Related, RelationKind, Viewpoint};
use jrdb_types::score::QuestionScore;
use jrdb_types::vocab::MatchPolicy;
use jrdb_types::*;

/// Seeds of the scenes are 0, 1, 2 ...
const SCENES: u64 = 200;
const PEOPLE: usize = 24;
/// Questions of one category about one scene.
const PER_SCENE: usize = 4;

/// How often an attribute is flipped.
const GENDER_FLIP: f64 = 0.1;
const RACE_FLIP: f64 = 0.2;
const AGE_FLIP: f64 = 0.4;
const ACTION_FLIP: f64 = 0.3;

const POLICIES: [MatchPolicy; 3] =
    [MatchPolicy::Strict, MatchPolicy::Majority, MatchPolicy::Ranked];

/// Categories: name, and what is asked of the person besides what the category before asks.
const CATEGORIES: [(&str, &[Asked]); 8] = [
    ("age", &[Asked::Age]),
    ("gender-age", &[Asked::Gender, Asked::Age]),
    ("gender-age-race", &[Asked::Gender, Asked::Age, Asked::Race]),
    ("gender-age-race-action", &[Asked::Gender, Asked::Age, Asked::Race, Asked::Action]),
    ("gender-age-race-distance", &[Asked::Gender, Asked::Age, Asked::Race, Asked::Distance]),
    (
        "gender-age-race-distance-SR/robot",
        &[Asked::Gender, Asked::Age, Asked::Race, Asked::Distance, Asked::Direction],
    ),
    ("gender-age-race-HHG", &[Asked::Gender, Asked::Age, Asked::Race, Asked::Neighbor]),
    (
        "gender-age-race-action-HHG",
        &[Asked::Gender, Asked::Age, Asked::Race, Asked::Action, Asked::Neighbor],
    ),
];

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Asked {
    Age,
    Gender,
    Race,
    Action,
    Distance,
    Direction,
    /// Somebody else close by, with age, gender and race.
    Neighbor,
}

/// SplitMix64: the same numbers on every machine.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In `[0, 1)`.
    fn uniform(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn below(&mut self, n: usize) -> usize {
        ((self.uniform() * n as f64) as usize).min(n.saturating_sub(1))
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scenes = std::env::args().nth(1).map_or(Ok(SCENES), |text| text.parse())?;
    println!(
        "{scenes} scenes, seeds 0 to {}, {PEOPLE} people each at most",
        scenes.saturating_sub(1)
    );
    println!(
        "flipped: gender {GENDER_FLIP}, race {RACE_FLIP}, age {AGE_FLIP}, action {ACTION_FLIP}; \
         believed: what is seen 1 - that, the others the rest in equal shares\n"
    );
    let mut outcomes: BTreeMap<(usize, usize), Vec<(Question, Answer)>> = BTreeMap::new();
    for seed in 0..scenes {
        let mut random = Random(seed);
        let truth = true_graph(seed)?;
        let seen = noisy(&truth, &mut random);
        for (category, (name, asked)) in CATEGORIES.iter().enumerate() {
            for _ in 0..PER_SCENE {
                let Some(query) = query(&truth, asked, &mut random) else { continue };
                let question = question(&truth, &query, name);
                for (policy, name) in POLICIES.iter().enumerate() {
                    let answer = answer(&seen, &query, *name);
                    let of_policy = outcomes.entry((category, policy)).or_default();
                    of_policy.push((question.clone(), answer));
                }
            }
        }
    }
    table(&outcomes);
    Ok(())
}

/// The scene graph on the labelled boxes in space.
fn true_graph(seed: u64) -> Result<SceneGraph, Box<dyn std::error::Error>> {
    let config = SynthConfig { seed, people: PEOPLE, ..SynthConfig::default() };
    let labels = generate(&config).frame(0).labels.detections;
    let config = ProjectionConfig { localizer: Localizer::Given, ..ProjectionConfig::default() };
    let rig = calibration().rig();
    let entities = jrdb_projection::project(&labels, &Scan::new(&[], &rig), &config)?;
    Ok(jrdb_graph::build(&entities, &GraphConfig::default()))
}

fn noisy(truth: &SceneGraph, random: &mut Random) -> SceneGraph {
    let mut graph = truth.clone();
    for node in graph.nodes.iter_mut().filter(|node| is_person(node)) {
        let attributes = &mut node.attributes;
        attributes.set_gender(flip(attributes.gender(), Gender::ALL, GENDER_FLIP, random));
        attributes.set_race(flip(attributes.race(), Race::ALL, RACE_FLIP, random));
        attributes.set_age(flip(attributes.age(), Age::ALL, AGE_FLIP, random));
        attributes.set_action(flip(attributes.action(), Action::ALL, ACTION_FLIP, random));
    }
    graph
}

fn flip<T: Ord + Copy>(
    belief: Belief<T>,
    all: &[T],
    probability: f64,
    random: &mut Random,
) -> Belief<T> {
    let Some(truth) = belief.best() else { return belief };
    let others: Vec<T> = all.iter().copied().filter(|value| *value != truth).collect();
    let is_flipped = random.uniform() < probability;
    let other = others[random.below(others.len())];
    let seen = if is_flipped { other } else { truth };
    let rest = probability / others.len() as f64;
    let believed = |value: &T| (*value, if *value == seen { 1.0 - probability } else { rest });
    Belief(all.iter().map(believed).collect())
}

fn is_person(node: &Node) -> bool {
    node.category == "person"
}

/// A query that a random person of the true graph satisfies; none when its attributes are not all known.
fn query(graph: &SceneGraph, asked: &[Asked], random: &mut Random) -> Option<Query> {
    let people: Vec<&Node> = graph.nodes.iter().filter(|node| is_person(node)).collect();
    let person = people[random.below(people.len())];
    let conditions: Option<Vec<Condition>> =
        asked.iter().map(|asked| condition(graph, person, *asked, random)).collect();
    let target = Pattern { conditions: conditions?, ..Pattern::default() };
    Some(Query { target, ..Query::default() })
}

fn condition(
    graph: &SceneGraph,
    person: &Node,
    asked: Asked,
    random: &mut Random,
) -> Option<Condition> {
    let attributes = &person.attributes;
    Some(match asked {
        Asked::Age => Condition::has(attributes.age().best()?),
        Asked::Gender => Condition::has(attributes.gender().best()?),
        Asked::Race => Condition::has(attributes.race().best()?),
        Asked::Action => Condition::has(attributes.action().best()?),
        Asked::Distance => Condition::FromRobot(Place::Distance(person.from_robot?.distance?)),
        Asked::Direction => Condition::FromRobot(Place::Direction(person.from_robot?.direction?)),
        Asked::Neighbor => neighbor(graph, person, random)?,
    })
}

/// Somebody within 1.5 m, described; as the benchmark asks.
fn neighbor(graph: &SceneGraph, person: &Node, random: &mut Random) -> Option<Condition> {
    let near: Vec<(&Node, SpatialRelation)> = graph
        .edges
        .iter()
        .filter(|edge| edge.from == person.id)
        .filter_map(|edge| match &edge.relation {
            EdgeRelation::Spatial(relation) if relation.distance? <= DistanceWord::Close => {
                let node = graph.nodes.iter().find(|node| node.id == edge.to)?;
                is_person(node).then_some((node, *relation))
            }
            _ => None,
        })
        .collect();
    if near.is_empty() {
        return None;
    }
    let (partner, relation) = near[random.below(near.len())];
    let conditions = [Asked::Age, Asked::Gender, Asked::Race]
        .iter()
        .map(|asked| condition(graph, partner, *asked, random))
        .collect::<Option<Vec<_>>>()?;
    let placed = |place| RelationKind::Placed { place, viewpoint: Viewpoint::Subject };
    let kinds = vec![
        placed(Place::Direction(relation.direction?)),
        placed(Place::Distance(relation.distance?)),
    ];
    let partner = Pattern { category: Category::Person, conditions, pick: None };
    Some(Condition::Related(Related { kinds, partner, quantity: Quantity::SOME }))
}

fn answer(graph: &SceneGraph, query: &Query, policy: MatchPolicy) -> Answer {
    search(graph, query, &SearchConfig { policy, ..SearchConfig::default() })
}

fn question(truth: &SceneGraph, query: &Query, category: &str) -> Question {
    let ids = answer(truth, query, MatchPolicy::Strict).selection;
    let nodes = truth.nodes.iter().filter(|node| ids.contains(&node.id));
    let boxes = nodes.map(|node| node.bbox).collect();
    Question {
        id: None,
        query: None,
        text: String::new(),
        category: category.into(),
        frame: truth.frame.clone(),
        slots: Vec::new(),
        truth: Some(Truth { ids, boxes, ..Truth::default() }),
    }
}

/// What one way of matching came to in one category.
struct Score {
    questions: usize,
    /// Mean over IoU 0.50, 0.55 … 0.95 of the average precision, all questions pooled.
    map: f64,
    /// Mean over questions of the F1 of the selected set.
    f1: f64,
}

fn table(outcomes: &BTreeMap<(usize, usize), Vec<(Question, Answer)>>) {
    print!("{:<34} {:>9}", "category", "questions");
    POLICIES.iter().for_each(|policy| print!(" {:>8} mAP    F1", policy.word()));
    println!("   ranked over the better: mAP   F1");
    for (category, (name, asked)) in CATEGORIES.iter().enumerate() {
        let results: Vec<Score> = (0..POLICIES.len())
            .map(|policy| result(outcomes.get(&(category, policy)).map_or(&[], Vec::as_slice)))
            .collect();
        print!("{name:<34} {:>9}", results[0].questions);
        results.iter().for_each(|r| print!(" {:>12.3} {:>5.3}", r.map, r.f1));
        let better = |value: fn(&Score) -> f64| {
            value(&results[2]) / value(&results[0]).max(value(&results[1]))
        };
        let note = if asked.len() > 2 { "" } else { "   (two attributes or fewer)" };
        println!("   {:>27.2} {:.2}{note}", better(|r| r.map), better(|r| r.f1));
    }
}

fn result(outcomes: &[(Question, Answer)]) -> Score {
    let outcomes: Vec<Outcome<'_>> =
        outcomes.iter().map(|(question, answer)| Outcome { question, answer }).collect();
    let scores = jrdb_metrics::evaluate(&outcomes, &MetricsConfig::default());
    let f1 = |score: &QuestionScore| {
        let wrong = score.false_positives + score.false_negatives;
        2.0 * score.true_positives as f64 / (2 * score.true_positives + wrong).max(1) as f64
    };
    let questions = scores.questions.len();
    let sum: f64 = scores.questions.iter().map(f1).sum();
    Score { questions, map: scores.overall.map_ranking, f1: sum / questions.max(1) as f64 }
}
