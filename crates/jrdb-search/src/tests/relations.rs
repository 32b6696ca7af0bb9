//! What each kind of condition means, on scenes made for it.

use jrdb_types::entity::Between;
use jrdb_types::query::{Category, Compared, Interval, Measure, Order, Pick, Place, Viewpoint};
use jrdb_types::vocab::{MatchPolicy, PairWord, Sector};
use jrdb_types::*;

use super::graphs::{at, connected, deed, edge, graph, id, nobody, pair, person, seen};
use super::{ask, selected, strictly, under};
use crate::{SearchConfig, search};

/// A young White man who looks along x, a young Black woman 1 m to his left, an elderly White woman 3 m ahead of him.
fn three() -> SceneGraph {
    connected(vec![
        at(person(1, Age::Young, Gender::Male, Race::White), [2.0, 0.0, 0.0], Some(0.0)),
        at(person(2, Age::Young, Gender::Female, Race::Black), [2.0, 1.0, 0.0], None),
        at(person(3, Age::Elderly, Gender::Female, Race::White), [5.0, 0.0, 0.0], Some(3.1)),
    ])
}

fn young_white_female() -> Vec<Condition> {
    vec![Condition::has(Age::Young), Condition::has(Gender::Female), Condition::has(Race::White)]
}

fn placed(sector: Sector, viewpoint: Viewpoint) -> RelationKind {
    RelationKind::Placed { place: Place::Direction(Direction::level(sector)), viewpoint }
}

fn to(kind: RelationKind, partner: Pattern) -> Condition {
    Condition::Related(Related { kinds: vec![kind], partner, quantity: Quantity::SOME })
}

fn anyone() -> Pattern {
    Pattern::default()
}

fn robot() -> Pattern {
    Pattern::of(Category::Robot)
}

fn who(conditions: Vec<Condition>) -> Pattern {
    Pattern { conditions, ..Pattern::default() }
}

fn not(condition: Condition) -> Condition {
    Condition::Not(Box::new(condition))
}

#[test]
fn strict_wants_all_majority_wants_more_than_half() {
    let query = ask(young_white_female());
    assert_eq!(selected(&three(), &query, MatchPolicy::Strict), [0_u32; 0]);
    assert_eq!(selected(&three(), &query, MatchPolicy::Majority), [1, 2, 3]);
    let two = ask(young_white_female()[..2].to_vec());
    assert_eq!(selected(&three(), &two, MatchPolicy::Majority), [2]);
}

#[test]
fn ranked_takes_the_best_tier_where_nothing_is_possible_and_counts_only_what_is() {
    let query = ask(young_white_female());
    assert_eq!(selected(&three(), &query, MatchPolicy::Ranked), [1, 2, 3]);
    let count = Query { task: Task::Count, ..query };
    assert_eq!(search(&three(), &count, &SearchConfig::default()).number(), Some(0));
}

#[test]
fn an_unknown_attribute_matches_nothing_but_rules_nothing_out() {
    let mut scene = three();
    scene.nodes[0].attributes.set_age(Belief::default());
    let query = ask(vec![Condition::has(Age::Young)]);
    let answer = search(&scene, &query, &SearchConfig::default());
    assert_eq!(answer.selection, [id(2)]);
    let ranking: Vec<_> = answer.ranking.iter().map(|r| (r.id.number, r.probability)).collect();
    let (first, rest) = ranking.split_first().unwrap();
    assert_eq!((first, rest[0]), (&(2, 1.0), (1, 0.2)));
    assert_eq!(strictly(&scene, vec![not(Condition::has(Age::Young))]), [3]);
}

#[test]
fn left_of_whom_depends_on_the_viewpoint() {
    let left = |viewpoint| vec![to(placed(Sector::Left, viewpoint), anyone())];
    assert_eq!(strictly(&three(), left(Viewpoint::Subject)), [1]);
    assert_eq!(strictly(&three(), left(Viewpoint::Partner)), [2]);
    // Looked at from the robot, 2 is to the left of 1 and, nearly straight, nobody else is of another.
    assert_eq!(strictly(&three(), left(Viewpoint::Robot)), [2]);
}

#[test]
fn in_front_for_the_robot_is_nearer() {
    let front =
        |sector| vec![to(placed(sector, Viewpoint::Robot), who(vec![Condition::has(Race::White)]))];
    assert_eq!(strictly(&three(), front(Sector::Front)), [1, 2]);
    assert_eq!(strictly(&three(), front(Sector::Back)), [3]);
}

#[test]
fn several_relations_hold_with_one_partner_unless_they_are_independent() {
    let mut scene = three();
    scene.edges.push(deed(1, 3, "conversation"));
    let kinds = vec![
        placed(Sector::Left, Viewpoint::Subject),
        RelationKind::Interaction("conversation".into()),
    ];
    let related = Related { kinds, partner: anyone(), quantity: Quantity::SOME };
    let query = ask(vec![Condition::Related(related)]);
    assert_eq!(selected(&scene, &query, MatchPolicy::Strict), [0_u32; 0]);
    let engine = search(&scene, &query, &SearchConfig::benchmark());
    assert_eq!(engine.selection, [id(1)]);
}

#[test]
fn direction_and_distance_are_of_one_edge() {
    let words = |sector, distance| SpatialRelation {
        direction: Some(Direction::level(sector)),
        distance: Some(distance),
        ..SpatialRelation::default()
    };
    let people = [1, 2].map(|n| nobody(id(n), "person")).into();
    let edges = vec![
        edge(1, 2, words(Sector::Left, DistanceWord::Far)),
        edge(1, 2, words(Sector::Right, DistanceWord::Close)),
    ];
    let scene = graph(people, edges);
    let asked = |sector, distance| {
        let kinds = vec![
            placed(sector, Viewpoint::Subject),
            RelationKind::Placed {
                place: Place::Distance(distance),
                viewpoint: Viewpoint::Subject,
            },
        ];
        let partner = anyone();
        vec![Condition::Related(Related { kinds, partner, quantity: Quantity::SOME })]
    };
    assert_eq!(strictly(&scene, asked(Sector::Left, DistanceWord::Far)), [1]);
    assert_eq!(strictly(&scene, asked(Sector::Left, DistanceWord::Close)), [0_u32; 0]);
}

#[test]
fn partners_are_counted_once_each_and_none_is_a_number_too() {
    let near = |quantity| {
        let place = Place::Metres(Interval { min: None, max: Some(4.0) });
        let kinds = vec![RelationKind::Placed { place, viewpoint: Viewpoint::Subject }];
        vec![Condition::Related(Related {
            kinds,
            partner: who(vec![Condition::has(Gender::Female)]),
            quantity,
        })]
    };
    assert_eq!(strictly(&three(), near(Quantity::exactly(2))), [1]);
    assert_eq!(strictly(&three(), near(Quantity::exactly(1))), [2, 3]);
    assert_eq!(strictly(&three(), near(Quantity::NONE)), [0_u32; 0]);
    let mut scene = three();
    scene.nodes.push(nobody(id(4), "person"));
    assert_eq!(strictly(&scene, near(Quantity::NONE)), [0_u32; 0], "nobody knows where 4 is");
    scene.nodes[3] = at(scene.nodes[3].clone(), [-9.0, 0.0, 0.0], None);
    assert_eq!(strictly(&scene, near(Quantity::NONE)), [4]);
}

#[test]
fn a_partner_that_the_graph_does_not_describe_matches_an_unconditional_pattern_only() {
    let mut scene = three();
    scene.nodes.retain(|node| node.id != id(2));
    let left = |partner| vec![to(placed(Sector::Left, Viewpoint::Subject), partner)];
    assert_eq!(strictly(&scene, left(anyone())), [1]);
    assert_eq!(strictly(&scene, left(who(vec![Condition::has(Age::Young)]))), [0_u32; 0]);
    assert_eq!(strictly(&scene, left(Pattern::of(Category::Object))), [0_u32; 0]);
}

#[test]
fn words_of_pairs_hold_turned_round_where_they_say_the_same() {
    let mut scene = three();
    scene.edges.push(pair(1, 2, PairWord::Hides));
    scene.edges.push(pair(1, 2, PairWord::Facing));
    scene.edges.push(pair(2, 3, PairWord::Adjacent));
    let word = |word| vec![to(RelationKind::Pair(word), anyone())];
    assert_eq!(strictly(&scene, word(PairWord::HiddenBy)), [2]);
    assert_eq!(strictly(&scene, word(PairWord::Facing)), [1]);
    assert_eq!(strictly(&scene, word(PairWord::Adjacent)), [2, 3]);
    assert_eq!(strictly(&scene, vec![to(RelationKind::With, anyone())]), [2, 3]);
}

#[test]
fn the_robot_can_be_faced_stood_beside_and_stood_in_front_of() {
    let facing = vec![to(RelationKind::Pair(PairWord::Facing), robot())];
    assert_eq!(strictly(&three(), facing), [3]);
    let behind = vec![to(placed(Sector::Back, Viewpoint::Subject), robot())];
    assert_eq!(strictly(&three(), behind), [1]);
    let ahead = vec![to(placed(Sector::Front, Viewpoint::Partner), robot())];
    assert_eq!(strictly(&three(), ahead), [1, 2, 3]);
    let mut scene = three();
    scene.nodes[1] = at(scene.nodes[1].clone(), [1.0, 0.5, 0.0], None);
    assert_eq!(strictly(&scene, vec![to(RelationKind::Pair(PairWord::Adjacent), robot())]), [2]);
}

#[test]
fn between_is_told_by_the_graph_and_for_the_robot_by_places() {
    let mut scene = three();
    let ends = [id(1), id(3)];
    scene.between.push(Between { middle: id(2), ends, offset_m: 0.1, fraction: 0.5 });
    let female = || who(vec![Condition::has(Gender::Female)]);
    let between =
        |partner, other: Pattern| vec![to(RelationKind::Between(Box::new(other)), partner)];
    assert_eq!(strictly(&scene, between(anyone(), female())), [2]);
    assert_eq!(strictly(&scene, between(female(), female())), [0_u32; 0]);
    // 1 is on the line from the robot to 3.
    assert_eq!(strictly(&scene, between(robot(), anyone())), [1]);
    assert_eq!(strictly(&scene, between(anyone(), robot())), [1]);
    let answer = search(&scene, &ask(between(anyone(), female())), &under(MatchPolicy::Strict));
    assert_eq!(answer.trace[1].checks[0].witnesses, [id(1), id(3)]);
}

#[test]
fn groups_are_those_told_else_those_close_or_busy_together() {
    let alone = |number| vec![Condition::GroupSize(Quantity::exactly(number))];
    assert_eq!(strictly(&three(), alone(2)), [1, 2]);
    assert_eq!(strictly(&three(), alone(1)), [3]);
    let mut scene = three();
    scene.edges.push(deed(3, 2, "conversation"));
    assert_eq!(strictly(&scene, alone(3)), [1, 2, 3]);
    scene.nodes[0].group = Some(1);
    assert_eq!(strictly(&scene, alone(1)), [1]);
    scene.nodes.push(nobody(id(4), "person"));
    assert_eq!(strictly(&scene, vec![not(Condition::GroupSize(Quantity::exactly(2)))]), [1]);
}

#[test]
fn picks_go_by_measure_and_leave_out_what_has_none() {
    let mut scene = three();
    let picked = |scene: &SceneGraph, measure, order, rank, count| {
        let mut query = ask(Vec::new());
        query.target.pick = Some(Pick { measure, order, rank, count });
        selected(scene, &query, MatchPolicy::Ranked)
    };
    assert_eq!(picked(&scene, Measure::Height, Order::Most, 1, 1), [0_u32; 0]);
    scene.nodes[0].height_m = Some(1.8);
    scene.nodes[2].height_m = Some(1.6);
    assert_eq!(picked(&scene, Measure::Height, Order::Least, 1, 1), [3]);
    assert_eq!(picked(&scene, Measure::Height, Order::Most, 2, 5), [3]);
    assert_eq!(picked(&scene, Measure::FromLeft, Order::Least, 1, 1), [2]);
    assert_eq!(picked(&scene, Measure::Age, Order::Least, 1, 1), [1]);
    let near = Measure::DistanceTo(Box::new(who(vec![Condition::has(Gender::Male)])));
    assert_eq!(picked(&scene, near, Order::Least, 1, 1), [2]);
}

#[test]
fn comparing_is_with_each_of_the_others() {
    let mut scene = three();
    for (node, height) in scene.nodes.iter_mut().zip([1.7, 1.8, 1.6]) {
        node.height_m = Some(height);
    }
    let taller = |than| {
        let (measure, order) = (Measure::Height, Order::Most);
        Condition::Compared(Compared { measure, order, than: Box::new(than) })
    };
    let women = || who(vec![Condition::has(Gender::Female)]);
    assert_eq!(strictly(&scene, vec![taller(women())]), [2]);
    assert_eq!(strictly(&scene, vec![not(taller(women()))]), [1, 3]);
    scene.nodes[1].height_m = None;
    assert_eq!(strictly(&scene, vec![taller(women())]), [0_u32; 0], "2 is of unknown height");
    assert_eq!(strictly(&scene, vec![not(taller(women()))]), [0_u32; 0], "2 is of unknown height");
}

#[test]
fn a_superlative_inside_is_looked_for_in_the_whole_graph() {
    let nearest = Pattern {
        pick: Some(Pick {
            measure: Measure::DistanceTo(Box::new(robot())),
            order: Order::Least,
            rank: 1,
            count: 1,
        }),
        ..Pattern::default()
    };
    let is_nearest = Condition::Is(Box::new(nearest));
    assert_eq!(strictly(&three(), vec![is_nearest.clone()]), [1]);
    let female = Condition::has(Gender::Female);
    assert_eq!(strictly(&three(), vec![is_nearest.clone(), female]), [0_u32; 0]);
    assert_eq!(strictly(&three(), vec![not(is_nearest)]), [2, 3]);
}

#[test]
fn who_may_be_one_of_them_is_not_none_of_them() {
    let mut scene = three();
    scene.nodes[1].attributes.set_gender(Belief::default());
    let women = Condition::Is(Box::new(who(vec![Condition::has(Gender::Female)])));
    let none_of_them = ask(vec![not(women.clone())]);
    for policy in [MatchPolicy::Strict, MatchPolicy::Majority, MatchPolicy::Ranked] {
        let count = Query { task: Task::Count, ..none_of_them.clone() };
        let answer = search(&scene, &count, &under(policy));
        assert_eq!(answer.selection, [id(1)], "{policy}");
        let index = jrdb_graph::GraphIndex::new(&scene);
        let by_sets: Vec<usize> = crate::select(&index, &count, &under(policy)).iter().collect();
        assert_eq!(by_sets, [0], "{policy}");
    }
    assert_eq!(strictly(&scene, vec![women]), [3]);
}

#[test]
fn a_place_near_a_bound_is_less_probable_but_holds_by_its_word() {
    let walker = |number, metres| at(nobody(id(number), "person"), [metres, 0.0, 0.0], None);
    let scene = connected(vec![walker(1, 1.49), walker(2, 1.51), walker(3, 1.0)]);
    let close = ask(vec![Condition::FromRobot(Place::Distance(DistanceWord::Close))]);
    let answer = search(&scene, &close, &SearchConfig::default());
    assert_eq!(answer.selection, [id(1), id(3)]);
    let order: Vec<u32> = answer.ranking.iter().map(|ranked| ranked.id.number).collect();
    assert_eq!(order, [3, 1, 2]);
    assert!(seen([0.0; 3], 0.0, [1.49, 0.0, 0.0]).distance == Some(DistanceWord::Close));
}

#[test]
fn what_the_graph_cannot_give_is_an_issue() {
    let scene = graph(vec![nobody(id(1), "person")], Vec::new());
    let asked = vec![
        Condition::has(Age::Young),
        to(placed(Sector::Left, Viewpoint::Subject), Pattern::of(Category::Object)),
        Condition::FromRobot(Place::Distance(DistanceWord::Close)),
    ];
    let answer = search(&scene, &ask(asked), &SearchConfig::default());
    let messages: Vec<&str> = answer.issues.iter().map(|issue| issue.message.as_str()).collect();
    let wanted = ["ages", "distances from the robot", "headings"];
    assert_eq!(messages, wanted.map(|what| format!("the scene graph holds no {what}")));
    let objects = Query { target: Pattern::of(Category::Object), ..Query::default() };
    let answer = search(&scene, &objects, &SearchConfig::default());
    assert_eq!(answer.issues[0].message, "the scene graph holds no objects");
}
