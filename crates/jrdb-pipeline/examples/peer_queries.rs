//! Checks and times the parser, the index and the selection on the questions and scene graphs that other programs are timed on:
//! `cargo xtask peers` starts it.
//!
//! `peer_queries DATA` takes the folder of the inputs and prints `{"rows": [{"case", "median_ms", ..}]}`: for each graph one query in the
//! mean and the index, and for the texts one question in the mean; medians of seven runs. Everything is checked before it is timed:
//! selections against a plain scan of all nodes and edges, meanings against the fields that the texts were made from. A wrong
//! one ends the program with exit code 1. All on one thread.
//!
//! The queries keep who has more than half of the attributes asked of the main person, and of these who sees, in a direction
//! and perhaps at a distance, somebody with all (at most two) attributes asked of the other: our `majority`.
//!
//! The inputs' words are not all ours: their races are four and their actions six, some of which we do not have. So in the graphs
//! their attributes go one-to-one to columns of ours that are large enough. Age, gender and distance are what they are. The eight
//! directions are our first eight actions. Race and action together are one of our 24 directions from the robot: race r with
//! action a has code 6 r + a, so that a race is one of six directions and an action one of four: `Any` of so many conditions, one
//! condition as before.
#![allow(clippy::print_stdout, reason = "its result is what it prints")]

use std::error::Error;
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use jrdb_graph::GraphIndex;
use jrdb_search::{SearchConfig, select};
use jrdb_types::query::{Place, Viewpoint};
use jrdb_types::vocab::{Elevation, MatchPolicy, Sector};
use jrdb_types::*;
use serde_json::{Value, json};

const RUNS: usize = 7;
const SIZES: [usize; 3] = [50, 200, 2000];

const RACES: [&str; 4] = ["White", "Black", "Asian", "others"];
const ACTIONS: [&str; 6] = ["standing", "walking", "sitting", "cycling", "talking", "holding"];
const DIRECTIONS: [(&str, Sector); 8] = [
    ("front", Sector::Front),
    ("front right", Sector::FrontRight),
    ("right", Sector::Right),
    ("back right", Sector::BackRight),
    ("back", Sector::Back),
    ("back left", Sector::BackLeft),
    ("left", Sector::Left),
    ("front left", Sector::FrontLeft),
];

type Outcome<T> = Result<T, Box<dyn Error>>;

fn main() -> Outcome<()> {
    let folder = std::env::args().nth(1).ok_or("expected the folder of the inputs")?;
    let folder = Path::new(&folder);
    let asked = read(&folder.join("d/queries.json"))?;
    let asked = list(&asked)?;
    let queries: Vec<Query> = asked.iter().map(query).collect::<Outcome<_>>()?;
    let mut rows = Vec::new();
    for n in SIZES {
        let scene = read(&folder.join(format!("d/graph_{n}.json")))?;
        rows.extend(graph_rows(n, &scene, (asked, &queries)).map_err(|e| format!("n={n}: {e}"))?);
    }
    rows.push(parse_row(list(&read(&folder.join("f/texts.json"))?)?)?);
    println!("{}", json!({ "rows": rows }));
    Ok(())
}

fn read(path: &Path) -> Outcome<Value> {
    Ok(serde_json::from_slice(&std::fs::read(path)?)?)
}

fn list(value: &Value) -> Outcome<&Vec<Value>> {
    value.as_array().ok_or_else(|| "expected a list".into())
}

fn graph_rows(
    n: usize,
    scene: &Value,
    (asked, queries): (&[Value], &[Query]),
) -> Outcome<[Value; 2]> {
    let config = SearchConfig { policy: MatchPolicy::Majority, ..SearchConfig::default() };
    let graph = graph(scene)?;
    let index = GraphIndex::new(&graph);
    let scan = Scan::new(scene)?;
    for (number, (asked, query)) in asked.iter().zip(queries).enumerate() {
        let found: Vec<usize> = select(&index, query, &config).iter().collect();
        let wanted = scan.answer(asked);
        if found != wanted {
            return Err(format!("query {number}: expected {wanted:?}, found {found:?}").into());
        }
    }
    let build_s = median(|| drop(black_box(GraphIndex::new(&graph))));
    let all_s = median(|| {
        for query in queries {
            black_box(select(&index, query, &config));
        }
    });
    let row = |case: &str, seconds: f64| json!({ "case": format!("{case} n={n}"), "median_ms": seconds * 1e3, "runs": RUNS });
    Ok([row("query", all_s / queries.len() as f64), row("index", build_s)])
}

/// The inputs as they are, looked through from end to end.
struct Scan<'a> {
    nodes: &'a [Value],
    /// From each node: to which, and the code of direction and distance.
    edges: Vec<Vec<(usize, usize)>>,
    directions: &'a [Value],
    distances: &'a [Value],
}

impl<'a> Scan<'a> {
    fn new(scene: &'a Value) -> Outcome<Self> {
        let nodes = list(&scene["nodes"])?;
        let mut edges = vec![Vec::new(); nodes.len()];
        for edge in list(&scene["edges"])? {
            let number =
                |at: usize| edge[at].as_u64().ok_or("expected a number").map(|n| n as usize);
            edges.get_mut(number(0)?).ok_or("an edge from nowhere")?.push((number(1)?, number(2)?));
        }
        Ok(Self {
            nodes,
            edges,
            directions: list(&scene["dir"])?,
            distances: list(&scene["dist"])?,
        })
    }

    fn answer(&self, asked: &Value) -> Vec<usize> {
        let has = |node: usize, wanted: &Value| {
            let wanted = wanted.as_object().into_iter().flatten();
            let held: Vec<bool> =
                wanted.map(|(key, value)| self.nodes[node][key] == *value).collect();
            (held.iter().filter(|held| **held).count(), held.len())
        };
        let relation = &asked["rel"];
        let sees = |from: usize| {
            self.edges[from].iter().any(|&(to, code)| {
                let (held, of) = has(to, &asked["target"]);
                held == of
                    && self.directions[code / self.distances.len()] == relation["dir"]
                    && (relation["dist"].is_null()
                        || self.distances[code % self.distances.len()] == relation["dist"])
            })
        };
        let main = |node: &usize| {
            let (held, of) = has(*node, &asked["main"]);
            2 * held > of
        };
        (0..self.nodes.len()).filter(main).filter(|n| relation.is_null() || sees(*n)).collect()
    }
}

/// The texts say what their rows do, in our own words; words that we do not have must be reported.
fn parse_row(rows: &[Value]) -> Outcome<Value> {
    let texts: Vec<&str> = rows.iter().filter_map(|row| row["text"].as_str()).collect();
    for (row, text) in rows.iter().zip(&texts) {
        check_meaning(row, &jrdb_parser::parse(text)).map_err(|e| format!("{text}: {e}"))?;
    }
    let all_s = median(|| {
        for text in &texts {
            black_box(jrdb_parser::parse(text));
        }
    });
    let median_ms = all_s * 1e3 / texts.len() as f64;
    Ok(json!({ "case": "parse", "median_ms": median_ms, "runs": RUNS }))
}

fn check_meaning(row: &Value, query: &Query) -> Outcome<()> {
    let strange = |asked: &Value| asked["race"] == "others";
    let is_known = !strange(&row["main"]) && !strange(&row["target"]);
    if is_known != query.issues.is_empty() {
        return Err(format!("issues {:?}", query.issues).into());
    }
    // Not the one that somebody talks to.
    let is_placed =
        |related: &Related| matches!(related.kinds[..], [RelationKind::Placed { .. }, ..]);
    let partner = query.target.conditions.iter().find_map(|condition| match condition {
        Condition::Related(related) if is_placed(related) => Some(related),
        _ => None,
    });
    let said = |asked: &Value, conditions: &[Condition]| {
        let known = asked.as_object().into_iter().flatten().filter_map(|(k, v)| said_as(k, v));
        known.filter(|condition| !conditions.contains(condition)).count()
    };
    let partner = partner.map_or(&[][..], |related| &related.partner.conditions);
    let missing = said(&row["main"], &query.target.conditions) + said(&row["target"], partner);
    if missing == 0 { Ok(()) } else { Err(format!("{missing} conditions are missing").into()) }
}

/// The condition that a field of a text's row should have become; none for words that stand for more than a condition.
fn said_as(key: &str, value: &Value) -> Option<Condition> {
    let word = value.as_str()?;
    let sector = DIRECTIONS.iter().find(|(name, _)| *name == word).map(|(_, sector)| *sector);
    match key {
        "age" => Age::from_word(word).map(Condition::Age),
        "gender" => Gender::from_word(word).map(Condition::Gender),
        "race" => Race::from_word(word).map(Condition::Race),
        "action" => Action::from_word(word).map(Condition::Action),
        "distance" => Some(Condition::FromRobot(Place::Distance(DistanceWord::from_word(word)?))),
        _ => Some(Condition::FromRobot(Place::Direction(Direction::level(sector?)))),
    }
}

/// Median time of some runs, seconds.
fn median(mut work: impl FnMut()) -> f64 {
    let mut times = [0.0; RUNS];
    for time in &mut times {
        let start = Instant::now();
        work();
        *time = start.elapsed().as_secs_f64();
    }
    times.sort_by(f64::total_cmp);
    times[RUNS / 2]
}

fn place_of(words: &[&str], value: &Value) -> Outcome<usize> {
    let found = words.iter().position(|word| Some(*word) == value.as_str());
    found.ok_or_else(|| format!("unknown word {value}").into())
}

/// The direction that stands for a race and an action.
fn both(race: usize, action: usize) -> Direction {
    let code = ACTIONS.len() * race + action;
    let sectors = Sector::ALL.len();
    Direction { sector: Sector::ALL[code % sectors], elevation: Elevation::ALL[code / sectors] }
}

/// The action that stands for a direction.
fn turned(direction: &Value) -> Outcome<Action> {
    Ok(Action::ALL[place_of(&DIRECTIONS.map(|(word, _)| word), direction)?])
}

fn word<T>(value: &Value, read: impl Fn(&str) -> Option<T>) -> Outcome<T> {
    value.as_str().and_then(read).ok_or_else(|| format!("unknown word {value}").into())
}

fn node(value: &Value) -> Outcome<Node> {
    let number = value["id"].as_u64().ok_or("expected an id")?;
    let (race, action) = (place_of(&RACES, &value["race"])?, place_of(&ACTIONS, &value["action"])?);
    let from_robot = SpatialRelation {
        distance: Some(word(&value["distance"], DistanceWord::from_word)?),
        direction: Some(both(race, action)),
        ..SpatialRelation::default()
    };
    Ok(Node {
        id: EntityId::new("pedestrian", u32::try_from(number)?),
        category: "person".into(),
        score: 1.0,
        bbox: PixelBox::from([0.0, 0.0, 1.0, 1.0]),
        attributes: Attributes {
            age: Belief::certain(word(&value["age"], Age::from_word)?),
            gender: Belief::certain(word(&value["gender"], Gender::from_word)?),
            action: Belief::certain(turned(&value["sr_robot"])?),
            ..Attributes::default()
        },
        center: None,
        heading_rad: None,
        height_m: None,
        velocity_mps: None,
        group: None,
        from_robot: Some(from_robot),
    })
}

fn edge(value: &Value) -> Outcome<Edge> {
    let number = |place: usize| value[place].as_u64().ok_or("expected a number");
    let code = usize::try_from(number(2)?)?;
    let distances = DistanceWord::ALL.len();
    let relation = SpatialRelation {
        distance: Some(DistanceWord::ALL[code % distances]),
        direction: Some(Direction::level(DIRECTIONS[code / distances].1)),
        ..SpatialRelation::default()
    };
    let end =
        |number: u64| Ok::<_, Box<dyn Error>>(EntityId::new("pedestrian", u32::try_from(number)?));
    let (from, to) = (end(number(0)?)?, end(number(1)?)?);
    Ok(Edge { from, to, relation: EdgeRelation::Spatial(relation) })
}

/// A graph sorted as [`SceneGraph`] says.
fn graph(value: &Value) -> Outcome<SceneGraph> {
    let mut edges: Vec<Edge> = list(&value["edges"])?.iter().map(edge).collect::<Outcome<_>>()?;
    edges.sort_by(|a, b| (&a.from, &a.to).cmp(&(&b.from, &b.to)));
    Ok(SceneGraph {
        frame: FrameId::default(),
        lateral: LateralConvention::Physical,
        nodes: list(&value["nodes"])?.iter().map(node).collect::<Outcome<_>>()?,
        edges,
        between: Vec::new(),
        issues: Vec::new(),
    })
}

fn conditions(value: &Value) -> Outcome<Vec<Condition>> {
    let asked = value.as_object().ok_or("expected attributes")?;
    asked.iter().map(|(key, value)| condition(key, value)).collect()
}

fn condition(key: &str, value: &Value) -> Outcome<Condition> {
    let one_of = |directions: Vec<Direction>| {
        let from_robot = |direction| Condition::FromRobot(Place::Direction(direction));
        Condition::Any(directions.into_iter().map(from_robot).collect())
    };
    Ok(match key {
        "age" => Condition::Age(word(value, Age::from_word)?),
        "gender" => Condition::Gender(word(value, Gender::from_word)?),
        "distance" => Condition::FromRobot(Place::Distance(word(value, DistanceWord::from_word)?)),
        "sr_robot" => Condition::Action(turned(value)?),
        "race" => {
            let race = place_of(&RACES, value)?;
            one_of((0..ACTIONS.len()).map(|action| both(race, action)).collect())
        }
        "action" => {
            let action = place_of(&ACTIONS, value)?;
            one_of((0..RACES.len()).map(|race| both(race, action)).collect())
        }
        other => return Err(format!("unknown attribute {other}").into()),
    })
}

fn query(value: &Value) -> Outcome<Query> {
    let mut asked = conditions(&value["main"])?;
    let relation = &value["rel"];
    if !relation.is_null() {
        let placed = |place| RelationKind::Placed { place, viewpoint: Viewpoint::Subject };
        let words = DIRECTIONS.map(|(word, _)| word);
        let sector = DIRECTIONS[place_of(&words, &relation["dir"])?].1;
        let mut kinds = vec![placed(Place::Direction(Direction::level(sector)))];
        if !relation["dist"].is_null() {
            let distance = word(&relation["dist"], DistanceWord::from_word)?;
            kinds.push(placed(Place::Distance(distance)));
        }
        let partner = Pattern { conditions: conditions(&value["target"])?, ..Pattern::default() };
        asked.push(Condition::Related(Related { kinds, partner, quantity: Quantity::SOME }));
    }
    Ok(Query { target: Pattern { conditions: asked, ..Pattern::default() }, ..Query::default() })
}
