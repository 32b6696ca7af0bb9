//! The JRDB-Reasoning benchmark's questions, answered on the scenes they were made from.
#![allow(clippy::panic, clippy::unwrap_used, reason = "a failing helper should panic")]
#![allow(clippy::print_stdout, reason = "figures and skipped tests are said aloud")]

mod shared;

use std::collections::{BTreeMap, BTreeSet};

use jrdb_graph::{GraphConfig, Hidden, Pairs};
use jrdb_projection::relation::{from_person, from_robot};
use jrdb_search::SearchConfig;
use jrdb_types::answer::{Sighting, SlotAnswer};
use jrdb_types::detection::Interaction;
use jrdb_types::query::{Category, Place, Task};
use jrdb_types::vocab::{Elevation, Occlusion, Sector};
use jrdb_types::*;
use serde_json::Value;
use shared::shared;

const ENGINE: LateralConvention = LateralConvention::BenchmarkMirrored;

/// Categories whose graphs hold one frame and people only.
const SINGLE_FRAME: &str = "single-frame";

fn json(path: &str) -> Option<Value> {
    Some(serde_json::from_slice(&std::fs::read(shared(path)?).unwrap()).unwrap())
}

fn text<'a>(value: &'a Value, key: &str) -> Option<&'a str> {
    value[key].as_str()
}

/// `h_pedestrian:3` or `pedestrian:3`; objects are `o_1_71`.
fn id(key: &str) -> EntityId {
    match key.strip_prefix("o_").and_then(|rest| rest.split_once('_')) {
        Some((track, class)) => EntityId::new(&format!("object_{class}"), track.parse().unwrap()),
        None => key.trim_start_matches("h_").parse().unwrap(),
    }
}

fn belief<T: Ord + Copy>(value: &Value, key: &str, read: impl Fn(&str) -> Option<T>) -> Belief<T> {
    Belief::from_label(
        text(value, key).map(|word| read(word).unwrap_or_else(|| panic!("{key} {word}"))),
    )
}

fn attributes(value: &Value) -> Attributes {
    Attributes::default()
        .with_age(belief(value, "age", Age::from_word))
        .with_gender(belief(value, "gender", Gender::from_word))
        .with_race(belief(value, "race", Race::from_word))
        .with_action(belief(value, "action", Action::from_word))
}

fn pixel_box(value: &Value) -> PixelBox {
    serde_json::from_value(value.clone()).unwrap()
}

/// `up right left` and `front right` as the engine writes them.
fn direction(words: &str) -> Direction {
    let (elevation, sector) = match words.split_once(' ') {
        Some(("up", rest)) => (Elevation::Up, rest),
        Some(("down", rest)) => (Elevation::Down, rest),
        _ => (Elevation::Level, words),
    };
    let sector = if sector == "right left" { "front right" } else { sector };
    Direction { sector: Sector::from_word(sector).unwrap(), elevation }
}

/// A graph as the engine built it: words, no numbers.
fn engine_graph(graph: &Value, frame: &str) -> SceneGraph {
    let nodes = graph["frames"][frame].as_object().unwrap().iter().map(|(key, node)| {
        let is_person = text(node, "type") == Some("human");
        let relation = SpatialRelation {
            distance: text(node, "distance").and_then(DistanceWord::from_word),
            direction: text(node, "SR_Robot_Ref").map(direction),
            ..SpatialRelation::default()
        };
        Node {
            id: id(key),
            category: if is_person {
                "person".into()
            } else {
                text(node, "obj_name").unwrap().into()
            },
            score: 1.0,
            bbox: pixel_box(&node["bbox"]),
            attributes: if is_person { attributes(node) } else { Attributes::default() },
            center: None,
            heading_rad: None,
            height_m: None,
            velocity_mps: None,
            group: None,
            from_robot: is_person.then_some(relation),
        }
    });
    let edges = graph["edges"].as_array().unwrap().iter().map(|edge| {
        let label = text(edge, "relation").unwrap();
        let relation = match text(edge, "edge_type").unwrap() {
            "geometric" => {
                let (side, distance) = label.split_once(" and ").unwrap();
                EdgeRelation::Spatial(SpatialRelation {
                    distance: DistanceWord::from_word(distance),
                    direction: Some(direction(side)),
                    ..SpatialRelation::default()
                })
            }
            _ => EdgeRelation::Interaction { label: label.into() },
        };
        Edge { from: id(text(edge, "from").unwrap()), to: id(text(edge, "to").unwrap()), relation }
    });
    let number = frame.trim_end_matches(".jpg").parse().unwrap();
    sorted(SceneGraph {
        frame: FrameId { sequence: String::new(), frame: number },
        lateral: ENGINE,
        nodes: nodes.collect(),
        edges: edges.collect(),
        between: Vec::new(),
        capabilities: Some(Capabilities::open()),
        issues: Vec::new(),
    })
}

fn sorted(mut graph: SceneGraph) -> SceneGraph {
    graph.nodes.sort_by(|a, b| a.id.cmp(&b.id));
    let kind = |edge: &Edge| match &edge.relation {
        EdgeRelation::Interaction { label } => label.clone(),
        _ => String::new(),
    };
    graph.edges.sort_by(|a, b| (&a.from, &a.to, kind(a)).cmp(&(&b.from, &b.to, kind(b))));
    graph
}

/// The same frame through our own relations and graph stage.
fn our_graph(frame: &Value) -> SceneGraph {
    let people: Vec<&Value> = frame["people"].as_array().unwrap().iter().collect();
    let placed: Vec<(EntityId, [f64; 3], f64)> = people
        .iter()
        .filter(|p| p["box3d"].is_object())
        .map(|p| {
            let number = |key: &str| p["box3d"][key].as_f64().unwrap();
            let heading = std::f64::consts::PI - number("rot_z");
            (id(text(p, "id").unwrap()), [number("cx"), number("cy"), number("cz")], heading)
        })
        .collect();
    let entities = people.iter().map(|p| entity(p, &placed));
    let mut relations = Vec::new();
    for (subject, from, heading) in &placed {
        for (object, to, _) in placed.iter().filter(|(object, ..)| object != subject) {
            let relation = from_person(&(*from).into(), Some(*heading), &(*to).into(), ENGINE);
            relations.push(PairRelation::of(subject.clone(), object.clone(), relation));
        }
    }
    let entities = Entities {
        frame: FrameId::default(),
        lateral: ENGINE,
        entities: entities.collect(),
        relations,
        between: Vec::new(),
        capabilities: Some(Capabilities::open()),
        issues: Vec::new(),
    };
    let config = GraphConfig { pairs: Pairs::Close, hidden: Hidden::LeaveOut };
    sorted(jrdb_graph::build(&entities, &config))
}

fn entity(person: &Value, placed: &[(EntityId, [f64; 3], f64)]) -> Entity {
    let id = id(text(person, "id").unwrap());
    let center = placed.iter().find(|(other, ..)| *other == id).map(|(_, center, _)| *center);
    let interactions = person["hhi"].as_array().unwrap().iter().map(|hhi| Interaction {
        partner: text(hhi, "pair").unwrap().parse().unwrap(),
        label: text(hhi, "label").unwrap().into(),
    });
    let occlusion = text(person, "occlusion").map(|word| match word {
        "Fully_visible" => Occlusion::FullyVisible,
        "Mostly_visible" => Occlusion::MostlyVisible,
        "Severely_occluded" => Occlusion::SeverelyOccluded,
        _ => Occlusion::FullyOccluded,
    });
    // The engine takes the distance from the label's own attribute.
    let distance = person["distance"].as_f64().and_then(jrdb_projection::relation::distance::word);
    let from_robot = center.map(|c| SpatialRelation { distance, ..from_robot(&c.into(), ENGINE) });
    Entity {
        id,
        category: "person".into(),
        score: 1.0,
        bbox: pixel_box(&person["bbox"]),
        attributes: attributes(person),
        interactions: interactions.collect(),
        group: None,
        occlusion,
        position: None,
        box3d: None,
        heading: None,
        velocity_mps: None,
        floor: None,
        from_robot,
    }
}

fn words(relation: &SpatialRelation) -> (Option<DistanceWord>, Option<Direction>) {
    (relation.distance, relation.direction)
}

/// Ids and words of a graph, without its numbers.
fn shown(graph: &SceneGraph) -> Vec<String> {
    let nodes = graph.nodes.iter().filter(|node| node.category == "person");
    let nodes = nodes
        .map(|n| format!("{} {:?} {:?}", n.id, n.attributes, n.from_robot.as_ref().map(words)));
    let to_people = graph.edges.iter().filter(|e| e.to.class == "pedestrian");
    let edges = to_people.map(|e| match &e.relation {
        EdgeRelation::Spatial(relation) => format!("{} {} {:?}", e.from, e.to, words(relation)),
        EdgeRelation::Pair { word, .. } => format!("{} {} {word}", e.from, e.to),
        EdgeRelation::Interaction { label } => format!("{} {} {label}", e.from, e.to),
    });
    nodes.chain(edges).collect()
}

fn answer(graph: &SceneGraph, question: &str) -> Answer {
    let query = jrdb_parser::parse(question);
    assert_eq!(query.issues, [], "{question}");
    jrdb_search::search(graph, &query, &SearchConfig::benchmark())
}

fn ids(value: &Value) -> BTreeSet<EntityId> {
    value.as_array().unwrap().iter().map(|key| id(key.as_str().unwrap())).collect()
}

fn is_asked_here(question: &Value) -> bool {
    let is_known = |category: &str| !category.contains("HOI") && category != "wh";
    text(question, "graph_scope") == Some(SINGLE_FRAME)
        && text(question, "modality") == Some("image")
        && text(question, "category").is_some_and(is_known)
}

/// The condition of a question that the benchmark's attribute stands for, in one of its slots.
fn condition(query: &Query, slot: usize, attribute: &str) -> Condition {
    let of_slot = query.slots.get(slot).map_or(&[][..], |slot| &slot.conditions);
    let mut conditions = query.target.conditions.iter().chain(of_slot);
    let found = conditions.find_map(|condition| match (attribute, condition) {
        (name, Condition::Attribute(value)) if value.attribute().name() == name => {
            Some(condition.clone())
        }
        ("distance", Condition::FromRobot(Place::Distance(_)))
        | ("SR_Robot_Ref", Condition::FromRobot(Place::Direction(_))) => Some(condition.clone()),
        (_, Condition::Related(related)) => part_of(related, attribute),
        _ => None,
    });
    found.unwrap_or_else(|| panic!("no {attribute} in {}", query.text))
}

/// What a relation says of the benchmark's attribute; one relation may stand for two of them.
fn part_of(related: &Related, attribute: &str) -> Option<Condition> {
    let is_person = related.partner.category == Category::Person;
    let is_part = |kind: &&RelationKind| match kind {
        RelationKind::Interaction(_) => attribute == if is_person { "hhi" } else { "hoi" },
        _ => attribute == "hhg",
    };
    let kinds: Vec<RelationKind> = related.kinds.iter().filter(is_part).cloned().collect();
    (!kinds.is_empty()).then(|| Condition::Related(Related { kinds, ..related.clone() }))
}

type Boxes = BTreeSet<(EntityId, [i64; 4])>;

fn labelled_boxes(label: &Value, [of_ids, of_boxes]: [&str; 2]) -> Boxes {
    let pixels = |bbox: &Value| <[f64; 4]>::from(pixel_box(bbox)).map(|side| side as i64);
    let keys = label[of_ids].as_array().unwrap().iter().map(|key| id(key.as_str().unwrap()));
    keys.zip(label[of_boxes].as_array().unwrap().iter().map(pixels)).collect()
}

fn seen_boxes(slot: &SlotAnswer) -> Boxes {
    let one =
        |seen: &Sighting| (seen.id.clone(), <[f64; 4]>::from(seen.bbox).map(|side| side as i64));
    slot.seen.iter().map(one).collect()
}

/// Right ones of all.
#[derive(Default, Clone, Copy)]
struct Tally(usize, usize);

impl Tally {
    fn count(&mut self, is_right: bool, wrong: impl Fn() -> String) {
        self.0 += usize::from(is_right);
        self.1 += 1;
        if !is_right {
            println!("wrong: {}", wrong());
        }
    }
}

/// One question as the engine answers it, on all frames of its scene: questions read whole, answers right, and
/// sub-questions right, in this order.
fn ask_as_the_engine(question: &Value, graph: &Value, [read, answers, subs]: [&mut Tally; 3]) {
    let sentence = text(question, "question").unwrap();
    let query = jrdb_parser::parse(sentence);
    let notation = jrdb_parser::notation::write(&query);
    let back = jrdb_parser::notation::read(&notation).unwrap();
    let is_same =
        (&back.task, &back.target, &back.slots) == (&query.task, &query.target, &query.slots);
    read.count(query.issues.is_empty() && is_same, || format!("{sentence}: {:?}", query.issues));
    for sub in question["sub_questions"].as_object().unwrap().values() {
        let sub = sub.as_str().or(sub["question"].as_str()).unwrap();
        let issues = jrdb_parser::parse(sub).issues;
        read.count(issues.is_empty(), || format!("{sub}: {issues:?}"));
    }
    // What the engine says to "What are the ages of ..." has nothing to do with the question's condition.
    if text(question, "task") == Some("VQA-Wh") {
        return;
    }
    let names: Vec<&String> = graph["frames"].as_object().unwrap().keys().collect();
    let recording: Vec<SceneGraph> = names.iter().map(|name| engine_graph(graph, name)).collect();
    let labels: Vec<&Value> = question["labels"].as_object().unwrap().values().collect();
    let place = |name: &Value| names.iter().position(|n| name == n.as_str()).unwrap();
    let covered =
        |label: &&Value| label["image_ids"].as_array().unwrap().iter().map(place).collect();
    let frames: Vec<Vec<usize>> = labels.iter().map(covered).collect();
    let answer =
        jrdb_search::search_frames(&recording, Some(&frames), &query, &SearchConfig::benchmark());
    let number = labels[0]["final_answer"].as_u64().and_then(|n| usize::try_from(n).ok());
    for (slot, label) in labels.iter().enumerate() {
        let of_everybody = text(question, "category") == Some("human");
        let wanted = if of_everybody {
            labelled_boxes(&label["human"], ["target_ID", "target_bbox"])
        } else {
            labelled_boxes(label, ["final_ID", "final_bbox"])
        };
        let found = answer.slots.get(slot).map(seen_boxes);
        let is_right =
            found.as_ref() == Some(&wanted) && (number.is_none() || answer.number() == number);
        answers.count(is_right, || format!("{sentence}\n  wanted {wanted:?}\n  found {found:?}"));
        let shown: Vec<&SceneGraph> = frames[slot].iter().map(|&frame| &recording[frame]).collect();
        let targets = label.as_object().unwrap().iter().filter(|(_, v)| v["target_ID"].is_array());
        for (key, target) in targets.filter(|_| !of_everybody) {
            let attributes = key.split(", ").filter(|attribute| *attribute != "human");
            let conditions: Vec<Condition> =
                attributes.map(|attribute| condition(&query, slot, attribute)).collect();
            let found =
                jrdb_search::benchmark_sub_answer(&shown, &conditions, &SearchConfig::benchmark());
            let found: BTreeSet<EntityId> = found.into_iter().collect();
            let wanted = ids(&target["target_ID"]);
            subs.count(found == wanted, || {
                format!("{sentence}, {key}: {wanted:?}, found {found:?}")
            });
        }
    }
}

#[test]
fn conformance_jrdb_reasoning() {
    let (Some(questions), Some(scenes)) =
        (json("goldens/jrdb_reasoning/questions.json"), json("goldens/jrdb_reasoning/scenes.json"))
    else {
        return;
    };
    let mut tallies: BTreeMap<&str, [Tally; 3]> = BTreeMap::new();
    for question in questions.as_array().unwrap() {
        let tally = tallies.entry(text(question, "category").unwrap()).or_default();
        let graph = &scenes[text(question, "scene_id").unwrap()]["graph"];
        ask_as_the_engine(question, graph, tally.each_mut());
    }
    println!("{:<40}{:>14}{:>14}{:>14}", "category", "texts read", "answers", "sub-questions");
    let mut all = [Tally::default(); 3];
    for (category, tallies) in &tallies {
        let shown = tallies.map(|Tally(right, of)| format!("{:>14}", format!("{right} of {of}")));
        println!("{category:<40}{}", shown.concat());
        for (all, Tally(right, of)) in all.iter_mut().zip(tallies) {
            (all.0, all.1) = (all.0 + right, all.1 + of);
        }
    }
    let shown = all.map(|Tally(right, of)| format!("{:>14}", format!("{right} of {of}")));
    println!("{:<40}{}", "all", shown.concat());
    assert!(all.iter().all(|Tally(right, of)| *of > 0 && right == of));
}

#[test]
fn conformance_jrdb_reasoning_on_our_graphs() {
    let (Some(questions), Some(scenes)) =
        (json("goldens/jrdb_reasoning/questions.json"), json("goldens/jrdb_reasoning/scenes.json"))
    else {
        return;
    };
    let mut tally: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    for question in questions.as_array().unwrap().iter().filter(|q| is_asked_here(q)) {
        let scene = &scenes[text(question, "scene_id").unwrap()];
        let labels = &question["labels"]["slot1"];
        let frame = labels["image_ids"][0].as_str().unwrap();
        let sentence = text(question, "question").unwrap();
        let category = text(question, "category").unwrap();
        let frames = scene["scene"]["frames"].as_array().unwrap();
        let ours = frames.iter().find(|f| text(f, "frame_id") == Some(frame)).unwrap();
        let wanted = ids(if category == "human" {
            &labels["human"]["target_ID"]
        } else {
            &labels["final_ID"]
        });
        let answers =
            [engine_graph(&scene["graph"], frame), our_graph(ours)].map(|g| answer(&g, sentence));
        let is_right = answers.iter().all(|found| {
            let found_ids: BTreeSet<EntityId> = found.selection.iter().cloned().collect();
            let number = found.number().map(|count| count as u64);
            match found.task {
                Task::Count => number == labels["final_answer"].as_u64(),
                _ => found_ids == wanted,
            }
        });
        let (right, all) = tally.entry(category).or_default();
        *right += usize::from(is_right);
        *all += 1;
        if !is_right {
            println!(
                "wrong: {sentence}\n  wanted {wanted:?}\n  found {:?}",
                answers.map(|a| a.selection)
            );
        }
    }
    for (category, (right, all)) in &tally {
        println!("{category:<40} {right} of {all}");
    }
    assert!(!tally.is_empty() && tally.values().all(|(right, all)| right == all));
}

#[test]
fn conformance_jrdb_reasoning_graphs() {
    let Some(scenes) = json("goldens/jrdb_reasoning/scenes.json") else { return };
    let mut compared = 0;
    for (name, scene) in scenes.as_object().unwrap() {
        let frames = scene["scene"]["frames"].as_array().unwrap();
        // With more frames the engine's edges are those of all frames together.
        let [frame] = frames.as_slice() else { continue };
        let theirs = engine_graph(&scene["graph"], text(frame, "frame_id").unwrap());
        for (ours, theirs) in shown(&our_graph(frame)).iter().zip(shown(&theirs)) {
            assert_eq!(*ours, theirs, "{name}");
        }
        assert_eq!(shown(&our_graph(frame)).len(), shown(&theirs).len(), "{name}");
        compared += 1;
    }
    println!("{compared} of {compared} single-frame graphs are equal");
    assert!(compared > 0);
}
