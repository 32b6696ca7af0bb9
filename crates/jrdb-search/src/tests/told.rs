//! What is said of an answer: replies, reasons, and what would change it.

use jrdb_types::answer::{Effect, Reply, Unit};
use jrdb_types::query::{Order, Place, Property, Viewpoint};
use jrdb_types::vocab::{MatchPolicy, Sector};
use jrdb_types::*;

use super::graphs::{Beliefs, Random, at, connected, deed, id, nobody, person, random};
use super::{ask, asked, under};
use crate::{SearchConfig, describe, explain, search, sensitivity, why_not};

/// A man at 1.4 m who sees a woman 1.2 m to his left, another woman at 4 m, and a table.
fn scene() -> SceneGraph {
    let mut scene = connected(vec![
        at(person(1, Age::Young, Gender::Male, Race::White), [1.4, 0.0, 0.0], Some(0.0)),
        at(person(2, Age::Young, Gender::Female, Race::White), [1.4, 1.2, 0.0], None),
        at(person(3, Age::Elderly, Gender::Female, Race::Asian), [4.0, 0.0, 0.0], None),
        at(nobody(EntityId::new("table", 1), "table"), [4.5, 0.5, 0.0], None),
    ]);
    scene.edges.push(deed(1, 2, "conversation"));
    scene
}

fn has_left(partner: Vec<Condition>) -> Condition {
    let place = Place::Direction(Direction::level(Sector::Left));
    let kinds = vec![RelationKind::Placed { place, viewpoint: Viewpoint::Subject }];
    let partner = Pattern { conditions: partner, ..Pattern::default() };
    Condition::Related(Related { kinds, partner, quantity: Quantity::SOME })
}

fn close() -> Condition {
    Condition::FromRobot(Place::Distance(DistanceWord::Close))
}

fn told(task: Task, conditions: Vec<Condition>) -> Vec<Vec<String>> {
    let query = Query { task, ..ask(conditions) };
    let Reply::Told(told) = search(&scene(), &query, &SearchConfig::default()).reply else {
        panic!("expected values");
    };
    told.into_iter().map(|told| told.words).collect()
}

#[test]
fn the_trace_names_the_witness_its_numbers_and_its_conditions() {
    let query = ask(vec![has_left(vec![Condition::Age(Age::Elderly)])]);
    let answer = search(&scene(), &query, &under(MatchPolicy::Strict));
    let check = &answer.trace[0].checks[0];
    assert_eq!((check.holds, check.witnesses[0].number), (false, 2));
    assert_eq!(check.asked, "has an elderly person to its left");
    assert_eq!(check.found.as_deref(), Some("left, +90°"));
    let [relation, age] = check.parts.as_slice() else { panic!("two parts") };
    let measured = relation.measured.unwrap();
    assert_eq!((measured.unit, measured.margin.round()), (Unit::Degrees, 45.0));
    assert_eq!((age.asked.as_str(), age.holds), ("age elderly", false));
    assert!(answer.trace[1].checks[0].witnesses.is_empty() || !answer.trace[1].checks[0].holds);
}

#[test]
fn properties_are_told_with_their_units() {
    let properties = vec![Property::Distance, Property::Direction, Property::SocialInteraction];
    let task = Task::Which { properties, in_order: false };
    let man = vec![Condition::Gender(Gender::Male)];
    let wanted = ["1.4 m, close", "front, straight ahead", "conversation: pedestrian:2"];
    assert_eq!(told(task, man.clone()), wanted.map(|words| vec![words.to_owned()]));
    let around = Task::Which { properties: vec![Property::PeopleAround], in_order: false };
    assert_eq!(told(around, man), [["pedestrian:2: left, 90 deg to the left, 1.2 m, close"]]);
    let elderly = vec![Condition::Age(Age::Elderly)];
    let place = "4.0 m, moderate; front, straight ahead, next to table table:1 (0.7 m)";
    assert_eq!(told(Task::Where, elderly), [[place]]);
}

#[test]
fn yes_and_no_are_about_numbers() {
    let women = vec![Condition::Gender(Gender::Female)];
    let reply = |task| {
        search(&scene(), &Query { task, ..ask(women.clone()) }, &SearchConfig::default()).reply
    };
    assert_eq!(reply(Task::Exists(Quantity::at_least(2))), Reply::YesNo(true));
    assert_eq!(reply(Task::Exists(Quantity::exactly(1))), Reply::YesNo(false));
    let men = Pattern { conditions: vec![Condition::Gender(Gender::Male)], ..Pattern::default() };
    let than = |order| Task::CompareCounts { order, than: Box::new(men.clone()) };
    assert_eq!(reply(than(Order::Most)), Reply::YesNo(true));
    assert_eq!(reply(than(Order::Least)), Reply::YesNo(false));
    assert_eq!(reply(Task::Count), Reply::Number(2));
}

#[test]
fn a_query_reads_as_words() {
    let query = Query {
        task: Task::Count,
        ..ask(vec![close(), has_left(vec![Condition::Gender(Gender::Female)])])
    };
    let lines =
        "count a person with\n  close distance from the robot\n  has a female person to its left";
    assert_eq!(describe(&query), lines);
}

#[test]
fn an_answer_reads_as_a_table() {
    let query = ask(vec![close(), has_left(vec![Condition::Gender(Gender::Female)])]);
    let answer = search(&scene(), &query, &SearchConfig::default());
    let wanted = "\
#1.

#1  p = 0.76
  ✓ close distance from the robot    close, 1.40 m  0.10 m inside, bound 1.50 m, p = 0.76
  ✓ has a female person to its left  left, +90°     45° inside, bound +45°                 → #2
  ✓   gender female                  female

Nearest misses
  #2  p = 0.00
    close distance from the robot: moderate, 1.84 m (0.34 m outside, bound 1.50 m)
    has a female person to its left: unknown
";
    let text = explain(&answer, 1);
    assert!(text.starts_with(wanted), "{text}");
    assert!(text.contains("  #3  p = 0.00"), "{text}");
}

#[test]
fn the_reason_is_the_condition_that_fails() {
    let query = ask(vec![close(), Condition::Gender(Gender::Female)]);
    let answer = search(&scene(), &query, &under(MatchPolicy::Strict));
    let reason = |number| why_not(&answer, &id(number)).to_string();
    assert_eq!(reason(1), "gender female: male");
    assert_eq!(reason(9), "there is no such candidate");
    let close_ones = search(&scene(), &ask(vec![close()]), &under(MatchPolicy::Strict));
    assert_eq!(why_not(&close_ones, &id(1)).to_string(), "it is in the answer");
}

#[test]
fn the_smallest_change_is_the_one_nearest_to_its_bound() {
    let query = ask(vec![close(), Condition::Gender(Gender::Male)]);
    let changes = sensitivity(&scene(), &query, &under(MatchPolicy::Strict));
    let first = &changes[0];
    assert_eq!((first.id.number, first.effect, first.to), (1, Effect::Leaves, 1.5));
    assert!((first.measured.margin - 0.1).abs() < 1e-9);
    assert!((first.deviations.unwrap() - 0.1 / 0.14).abs() < 1e-9);
    assert!(changes.iter().all(|change| change.id == id(1)), "the others fail twice");
}

#[test]
fn a_witness_that_turns_or_changes_is_told_of() {
    let query = ask(vec![has_left(vec![Condition::Gender(Gender::Female)])]);
    let changes = sensitivity(&scene(), &query, &under(MatchPolicy::Strict));
    let of_man: Vec<_> = changes.iter().filter(|change| change.id == id(1)).collect();
    let [turns, changes] = of_man.as_slice() else { panic!("{of_man:?}") };
    assert_eq!((turns.measured.unit, turns.effect), (Unit::Degrees, Effect::Leaves));
    assert_eq!((changes.measured.unit, changes.to), (Unit::Probability, 0.5));
    assert_eq!([&turns.witness, &changes.witness], [&Some(id(2)); 2]);
}

/// The graph with the number of a change moved to a value: beliefs and distances to the robot.
fn altered(scene: &SceneGraph, change: &answer::Change, value: f64) -> Option<SceneGraph> {
    let mut scene = scene.clone();
    let owner = change.witness.as_ref().unwrap_or(&change.id);
    let node = scene.nodes.iter_mut().find(|node| node.id == *owner)?;
    if change.measured.unit == Unit::Metres && change.condition.ends_with("from the robot") {
        let place = node.from_robot.as_mut()?;
        place.distance_m = Some(value);
        place.distance = crate::geometry::distance_word(value);
        return Some(scene);
    }
    let gender = change.condition.strip_prefix("gender ").and_then(Gender::from_word)?;
    let [other] = Gender::ALL.iter().filter(|g| **g != gender).copied().collect::<Vec<_>>()[..]
    else {
        return None;
    };
    node.attributes.gender.0.insert(gender, value);
    node.attributes.gender.0.insert(other, 1.0 - value);
    Some(scene)
}

#[test]
fn every_change_is_real() {
    let mut tried = 0;
    for seed in 0..300 {
        let mut numbers = Random(seed);
        let scene = random(&mut numbers, Beliefs::Mixed);
        let query = asked::plain(&mut numbers);
        let mut conditions = query.target.conditions.clone();
        conditions.insert(0, Condition::Gender(Gender::Female));
        if seed % 2 == 0 {
            conditions.truncate(1);
            conditions.push(Condition::FromRobot(Place::Distance(DistanceWord::Moderate)));
        }
        let query = ask(conditions);
        for policy in [MatchPolicy::Strict, MatchPolicy::Majority, MatchPolicy::Ranked] {
            for change in sensitivity(&scene, &query, &under(policy)) {
                let beyond = 2e-6 * (change.to - change.measured.value).signum();
                let Some(moved) = altered(&scene, &change, change.to + beyond) else { continue };
                let is_in = |scene: &SceneGraph| {
                    search(scene, &query, &under(policy)).selection.contains(&change.id)
                };
                assert_eq!(is_in(&scene), change.effect == Effect::Leaves, "{change:?}");
                assert_eq!(
                    is_in(&moved),
                    change.effect == Effect::Enters,
                    "{policy} {seed} {change:?}"
                );
                tried += 1;
            }
        }
    }
    assert!(tried > 300, "{tried}");
}
