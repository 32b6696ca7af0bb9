//! What is said of an answer: replies, reasons, and what would change it.

use jrdb_types::answer::{Count, Effect, Reply, Unit};
use jrdb_types::query::{Category, Compared, Measure, Order, Place, Property, Viewpoint};
use jrdb_types::vocab::{MatchPolicy, Sector};
use jrdb_types::*;

use jrdb_render::{explain, why_not, with_words};

use super::graphs::{Beliefs, Random, at, connected, deed, id, nobody, person, random};
use super::{ask, asked, under};
use crate::{SearchConfig, search, sensitivity};

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
    let answer = with_words(search(&scene(), &query, &SearchConfig::default()));
    let Reply::Properties(all) = answer.reply else { panic!("expected values") };
    all.into_iter().map(|of| of.words).collect()
}

#[test]
fn the_trace_names_the_witness_its_numbers_and_its_conditions() {
    let query = ask(vec![has_left(vec![Condition::has(Age::Elderly)])]);
    let answer = with_words(search(&scene(), &query, &under(MatchPolicy::Strict)));
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
    let man = vec![Condition::has(Gender::Male)];
    let wanted = ["1.4 m, close", "front, straight ahead", "conversation: #2"];
    assert_eq!(told(task, man.clone()), wanted.map(|words| vec![words.to_owned()]));
    let around = Task::Which { properties: vec![Property::PeopleAround], in_order: false };
    assert_eq!(told(around, man), [["#2: left, 90° to the left, 1.2 m, close"]]);
    let elderly = vec![Condition::has(Age::Elderly)];
    let place = "4.0 m, moderate; front, straight ahead, next to table:1 (0.7 m)";
    assert_eq!(told(Task::Where, elderly), [[place]]);
}

#[test]
fn yes_and_no_are_about_numbers() {
    let women = vec![Condition::has(Gender::Female)];
    let reply = |task| {
        search(&scene(), &Query { task, ..ask(women.clone()) }, &SearchConfig::default()).reply
    };
    assert_eq!(reply(Task::Exists(Quantity::at_least(2))), Reply::YesNo(Some(true)));
    assert_eq!(reply(Task::Exists(Quantity::exactly(1))), Reply::YesNo(Some(false)));
    let men = Pattern { conditions: vec![Condition::has(Gender::Male)], ..Pattern::default() };
    let than = |order| Task::CompareCounts { order, than: Box::new(men.clone()) };
    assert_eq!(reply(than(Order::Most)), Reply::YesNo(Some(true)));
    assert_eq!(reply(than(Order::Least)), Reply::YesNo(Some(false)));
    assert_eq!(reply(Task::Count), Reply::Number(Count::Exact(2)));
}

#[test]
fn a_query_reads_as_words() {
    let query = Query {
        task: Task::Count,
        ..ask(vec![close(), has_left(vec![Condition::has(Gender::Female)])])
    };
    let lines =
        "count a person with\n  close distance from the robot\n  has a female person to its left";
    assert_eq!(jrdb_render::query(&query), lines);
}

#[test]
fn an_answer_reads_as_a_table() {
    let query = ask(vec![close(), has_left(vec![Condition::has(Gender::Female)])]);
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
    let query = ask(vec![close(), Condition::has(Gender::Female)]);
    let answer = search(&scene(), &query, &under(MatchPolicy::Strict));
    let reason = |number| why_not(&answer, &id(number));
    assert_eq!(reason(1), "gender female: male");
    assert_eq!(reason(9), "there is no such candidate");
    let close_ones = search(&scene(), &ask(vec![close()]), &under(MatchPolicy::Strict));
    assert_eq!(why_not(&close_ones, &id(1)), "it is in the answer");
}

#[test]
fn the_smallest_change_is_the_one_nearest_to_its_bound() {
    let query = ask(vec![close(), Condition::has(Gender::Male)]);
    let changes = sensitivity(&scene(), &query, &under(MatchPolicy::Strict));
    let first = &changes[0];
    assert_eq!((first.id.number, first.effect, first.to), (1, Effect::Leaves, 1.5));
    assert!((first.measured.margin - 0.1).abs() < 1e-9);
    assert!((first.deviations.unwrap() - 0.1 / 0.14).abs() < 1e-9);
    assert!(changes.iter().all(|change| change.id == id(1)), "the others fail twice");
}

#[test]
fn a_witness_that_turns_or_changes_is_told_of() {
    let query = ask(vec![has_left(vec![Condition::has(Gender::Female)])]);
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
    let answer::Criterion::Condition(condition) = &change.criterion else { return None };
    if let (Condition::FromRobot(_), Unit::Metres) = (&**condition, change.measured.unit) {
        let place = node.from_robot.as_mut()?;
        place.distance_m = Some(value);
        place.distance = DistanceWord::of_metres(value);
        return Some(scene);
    }
    let Condition::Attribute(asked) = **condition else { return None };
    let gender = *Gender::ALL.iter().find(|gender| asked == (**gender).into())?;
    let [other] = Gender::ALL.iter().filter(|g| **g != gender).copied().collect::<Vec<_>>()[..]
    else {
        return None;
    };
    node.attributes.set_gender(Belief([(gender, value), (other, 1.0 - value)].into()));
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
        conditions.insert(0, Condition::has(Gender::Female));
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

/// The only change of place told under `strict`, if there is one.
fn change_of_place(scene: &SceneGraph, conditions: Vec<Condition>, of: u32) -> answer::Change {
    let changes = sensitivity(scene, &ask(conditions), &under(MatchPolicy::Strict));
    let of_place = |c: &answer::Change| c.id == id(of) && c.measured.unit != Unit::Probability;
    changes.into_iter().find(of_place).expect("a change of place")
}

#[test]
fn somebody_beside_another_leaves_the_answer_by_going_round() {
    let place = Place::Direction(Direction::level(Sector::Left));
    let kinds = vec![RelationKind::Placed { place, viewpoint: Viewpoint::Robot }];
    let partner = Pattern { conditions: vec![Condition::has(Gender::Male)], ..Pattern::default() };
    let left = Condition::Related(Related { kinds, partner, quantity: Quantity::SOME });
    let change = change_of_place(&scene(), vec![left.clone()], 2);
    assert_eq!((change.effect, change.witness), (Effect::Leaves, Some(id(1))));
    assert!((change.measured.value - 90.0).abs() < 1e-9 && (change.to - 90.0).abs() > 44.0);
    for (further, is_in) in [(-1e-3, true), (1e-3, false)] {
        // 90 degrees is straight left of the man; towards the robot, which is at 0, the angle falls.
        let angle = (change.to + further * (change.to - 90.0).signum()).to_radians();
        let mut moved = scene();
        moved.nodes[1].center = Some([1.4 - 1.2 * angle.cos(), 1.2 * angle.sin(), 0.0]);
        let found = search(&moved, &ask(vec![left.clone()]), &under(MatchPolicy::Strict));
        assert_eq!(found.selection.contains(&id(2)), is_in, "{further}");
    }
}

#[test]
fn somebody_nearer_or_farther_left_than_another_changes_places_with_them() {
    let than = Pattern { conditions: vec![Condition::has(Gender::Male)], ..Pattern::default() };
    let compared = |measure| {
        let (order, than) = (Order::Least, Box::new(than.clone()));
        vec![Condition::Compared(Compared { measure, order, than })]
    };
    let robot = Pattern::of(Category::Robot);
    let nearer = change_of_place(&scene(), compared(Measure::DistanceTo(Box::new(robot))), 2);
    assert_eq!((nearer.effect, nearer.to), (Effect::Enters, 1.4));
    let left = change_of_place(&scene(), compared(Measure::FromLeft), 2);
    assert_eq!((left.effect, left.to), (Effect::Leaves, 180.0));
    let mut moved = scene();
    for (bearing_deg, is_in) in [(1e-3_f64, true), (-1e-3, false)] {
        moved.nodes[1].from_robot.as_mut().unwrap().bearing_rad = Some(bearing_deg.to_radians());
        let query = ask(compared(Measure::FromLeft));
        let found = search(&moved, &query, &under(MatchPolicy::Strict));
        assert_eq!(found.selection.contains(&id(2)), is_in);
    }
}

#[test]
fn somebody_between_the_robot_and_another_leaves_the_line() {
    let mut scene = scene();
    scene.nodes[0].center = Some([1.4, 0.2, 0.0]);
    let end = Pattern { conditions: vec![Condition::has(Age::Elderly)], ..Pattern::default() };
    let between = vec![Condition::Related(Related {
        kinds: vec![RelationKind::Between(Box::new(end))],
        partner: Pattern::of(Category::Robot),
        quantity: Quantity::SOME,
    })];
    let change = change_of_place(&scene, between.clone(), 1);
    assert_eq!((change.effect, change.to, change.witness), (Effect::Leaves, 0.5, Some(id(3))));
    assert!((change.measured.value - 0.2).abs() < 1e-9);
    for (left_m, is_in) in [(0.499, true), (0.501, false)] {
        scene.nodes[0].center = Some([1.4, left_m, 0.0]);
        let found = search(&scene, &ask(between.clone()), &under(MatchPolicy::Strict));
        assert_eq!(found.selection.contains(&id(1)), is_in, "{left_m}");
    }
}
