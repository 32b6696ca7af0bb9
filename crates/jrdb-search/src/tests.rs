//! Search over small hand-made and random graphs.

use std::f64::consts::PI;

use jrdb_types::query::{Category, RelationKind, RelationPattern, Viewpoint};
use jrdb_types::vocab::{MatchPolicy, Sector};
use jrdb_types::*;
use proptest::prelude::*;

use crate::{SearchConfig, search};

fn id(number: u32) -> EntityId {
    EntityId::new("pedestrian", number)
}

fn person(number: u32, age: Age, gender: Gender, race: Race) -> Node {
    let attributes = Attributes {
        age: Belief::certain(age),
        gender: Belief::certain(gender),
        race: Belief::certain(race),
        ..Attributes::default()
    };
    Node {
        id: id(number),
        category: "person".into(),
        score: 1.0,
        bbox: PixelBox::from([f64::from(number), 0.0, 1.0, 1.0]),
        attributes,
        center: None,
        heading_rad: None,
        from_robot: None,
    }
}

/// `to` is 1 m to the left of `from`, or behind it.
fn edge(from: u32, to: u32, sector: Sector) -> Edge {
    let bearing_rad = if sector == Sector::Left { PI / 2.0 } else { PI };
    let relation = SpatialRelation {
        distance: Some(DistanceWord::Close),
        direction: Some(Direction::level(sector)),
        distance_m: Some(1.0),
        bearing_rad: Some(bearing_rad),
        rise_m: Some(0.0),
        direction_probability: None,
    };
    Edge { from: id(from), to: id(to), relation: EdgeRelation::Spatial(relation) }
}

fn graph(nodes: Vec<Node>, edges: Vec<Edge>) -> SceneGraph {
    let lateral = LateralConvention::Physical;
    SceneGraph { frame: FrameId::default(), lateral, nodes, edges, issues: Vec::new() }
}

/// A young White man, a young Black woman, an elderly White woman to the man's left.
fn three() -> SceneGraph {
    let nodes = vec![
        person(1, Age::Young, Gender::Male, Race::White),
        person(2, Age::Young, Gender::Female, Race::Black),
        person(3, Age::Elderly, Gender::Female, Race::White),
    ];
    graph(nodes, vec![edge(1, 3, Sector::Left), edge(3, 1, Sector::Back)])
}

fn ask(conditions: Vec<Condition>) -> Query {
    Query { target: Pattern { category: Category::Person, conditions }, ..Query::default() }
}

fn to_the_left_of(viewpoint: Viewpoint, partner: Vec<Condition>) -> Condition {
    let direction = Some(Direction::level(Sector::Left));
    Condition::Relation(RelationPattern {
        kind: RelationKind::Spatial { distance: None, direction, viewpoint },
        partner: Pattern { category: Category::Person, conditions: partner },
    })
}

fn selected(graph: &SceneGraph, query: &Query, policy: MatchPolicy) -> Vec<u32> {
    let config = SearchConfig { policy, ..SearchConfig::default() };
    search(graph, query, &config).selection.iter().map(|id| id.number).collect()
}

fn young_white_female() -> Vec<Condition> {
    vec![
        Condition::Age(Age::Young),
        Condition::Gender(Gender::Female),
        Condition::Race(Race::White),
    ]
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
fn ranked_selects_the_strict_matches_where_there_are_any() {
    let exact = vec![
        Condition::Age(Age::Young),
        Condition::Gender(Gender::Male),
        Condition::Race(Race::White),
    ];
    assert_eq!(selected(&three(), &ask(exact), MatchPolicy::Ranked), [1]);
    assert_eq!(selected(&three(), &ask(young_white_female()), MatchPolicy::Ranked), [1, 2, 3]);
}

#[test]
fn left_of_whom_depends_on_the_viewpoint() {
    let has_someone_left = ask(vec![to_the_left_of(Viewpoint::Subject, Vec::new())]);
    let is_left_of_someone = ask(vec![to_the_left_of(Viewpoint::Partner, Vec::new())]);
    assert_eq!(selected(&three(), &has_someone_left, MatchPolicy::Strict), [1]);
    assert_eq!(selected(&three(), &is_left_of_someone, MatchPolicy::Strict), [3]);
}

#[test]
fn the_trace_names_the_witness_and_its_conditions() {
    let elderly = vec![Condition::Age(Age::Elderly)];
    let query = ask(vec![to_the_left_of(Viewpoint::Subject, elderly)]);
    let answer = search(&three(), &query, &SearchConfig::default());
    let check = &answer.trace[0].checks[0];
    assert_eq!(check.witness, Some(id(3)));
    assert_eq!(check.found.as_deref(), Some("close, 1.00 m; left, +90°"));
    assert_eq!(check.witness_checks[0].asked, "age elderly");
    assert!(check.holds && !answer.trace[1].checks[0].holds);
    assert_eq!(answer.trace[1].checks[0].witness, None);
}

#[test]
fn an_unknown_attribute_matches_nothing_but_rules_nothing_out() {
    let mut scene = three();
    scene.nodes[0].attributes.age = Belief::default();
    let query = ask(vec![Condition::Age(Age::Young)]);
    let answer = search(&scene, &query, &SearchConfig::default());
    assert_eq!(answer.selection, [id(2)]);
    let ranking: Vec<_> = answer.ranking.iter().map(|r| (r.id.number, r.probability)).collect();
    assert_eq!(ranking, [(2, 1.0), (1, 0.2)]);
}

#[test]
fn a_partner_that_the_graph_does_not_describe_matches_an_unconditional_pattern_only() {
    let mut scene = three();
    scene.nodes.pop();
    let anyone = ask(vec![to_the_left_of(Viewpoint::Subject, Vec::new())]);
    let elderly = ask(vec![to_the_left_of(Viewpoint::Subject, vec![Condition::Age(Age::Elderly)])]);
    assert_eq!(selected(&scene, &anyone, MatchPolicy::Strict), [1]);
    assert_eq!(selected(&scene, &elderly, MatchPolicy::Strict), [0_u32; 0]);
}

#[test]
fn counting_counts_the_selection_and_missing_kinds_are_reported() {
    let count = Query { task: Task::Count, ..ask(vec![Condition::Gender(Gender::Female)]) };
    assert_eq!(search(&three(), &count, &SearchConfig::default()).count, Some(2));
    let mut objects = ask(Vec::new());
    objects.target.category = Category::Object;
    let answer = search(&three(), &objects, &SearchConfig::default());
    assert_eq!(answer.issues[0].message, "the scene graph holds no objects");
}

fn scenes() -> impl Strategy<Value = SceneGraph> {
    let people = proptest::collection::vec((0..5_usize, 0..2_usize, 0..3_usize), 2..9);
    let pairs = proptest::collection::vec((0..9_u32, 0..9_u32, proptest::bool::ANY), 0..20);
    (people, pairs).prop_map(|(people, pairs)| {
        let nodes: Vec<Node> = people
            .iter()
            .zip(0..)
            .map(|(&(a, g, r), n)| person(n, Age::ALL[a], Gender::ALL[g], Race::ALL[r]))
            .collect();
        let sector = |left| if left { Sector::Left } else { Sector::Back };
        let edges =
            pairs.into_iter().map(|(from, to, left)| edge(from, to, sector(left))).collect();
        graph(nodes, edges)
    })
}

fn queries() -> impl Strategy<Value = Query> {
    let attributes = || {
        (
            proptest::option::of(0..5_usize),
            proptest::option::of(0..2_usize),
            proptest::option::of(0..3_usize),
        )
            .prop_map(|(age, gender, race)| {
                let age = age.map(|i| Condition::Age(Age::ALL[i]));
                let gender = gender.map(|i| Condition::Gender(Gender::ALL[i]));
                let race = race.map(|i| Condition::Race(Race::ALL[i]));
                [age, gender, race].into_iter().flatten().collect::<Vec<_>>()
            })
    };
    (attributes(), proptest::option::of(attributes())).prop_map(|(mut conditions, partner)| {
        conditions.extend(partner.map(|partner| to_the_left_of(Viewpoint::Subject, partner)));
        ask(conditions)
    })
}

proptest! {
    #[test]
    fn ranked_equals_strict_whenever_anything_matches_strictly(scene in scenes(), query in queries()) {
        let strict = selected(&scene, &query, MatchPolicy::Strict);
        let ranked = selected(&scene, &query, MatchPolicy::Ranked);
        prop_assert!(strict.is_empty() || strict == ranked, "{strict:?} {ranked:?}");
    }

    #[test]
    fn what_matches_strictly_matches_by_majority(scene in scenes(), query in queries()) {
        let majority = selected(&scene, &query, MatchPolicy::Majority);
        let strict = selected(&scene, &query, MatchPolicy::Strict);
        prop_assert!(strict.iter().all(|id| majority.contains(id)));
    }

    #[test]
    fn the_order_of_edges_changes_no_answer(scene in scenes(), query in queries()) {
        let mut turned = scene.clone();
        turned.edges.reverse();
        for policy in [MatchPolicy::Strict, MatchPolicy::Majority, MatchPolicy::Ranked] {
            prop_assert_eq!(selected(&scene, &query, policy), selected(&turned, &query, policy));
        }
    }

    #[test]
    fn every_selected_one_is_ranked_with_a_probability(scene in scenes(), query in queries()) {
        let answer = search(&scene, &query, &SearchConfig::default());
        for id in &answer.selection {
            prop_assert!(answer.ranking.iter().any(|ranked| ranked.id == *id));
        }
        prop_assert!(answer.ranking.iter().all(|ranked| (0.0..=1.0).contains(&ranked.probability)));
    }
}
