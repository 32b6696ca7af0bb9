//! Checks and times the parser, the index and the selection on the questions and scene graphs that other programs are timed on:
//! `cargo xtask peers` starts it.
//!
//! `peer_queries DATA` takes the folder of the inputs and prints `{"rows": [{"case", "median_ms", ..}]}`: for each graph one query in the
//! mean and the index, and for the texts one question in the mean; medians of half a second of runs, seven at least. Everything is checked before it is timed:
//! selections against a plain scan of all nodes and edges, meanings against the fields that the texts were made from. A wrong
//! one ends the program with exit code 1. All on one thread.
//!
//! The queries keep who has more than half of the attributes asked of the main person, and of these who sees, in a direction
//! and perhaps at a distance, somebody with all (at most two) attributes asked of the other: our `majority`.
//!
//! The inputs' words are not all ours. Two of their actions stand as two of ours that they do not have; their fourth race, "others", is an unknown
//! race to us, for which nobody can ask: the queries that do are left out, a third of them.
#![allow(clippy::print_stdout, reason = "its result is what it prints")]

use std::error::Error;
use std::hint::black_box;
use std::path::Path;
use std::time::{Duration, Instant};

use jrdb_graph::GraphIndex;
use jrdb_search::{SearchConfig, select};
use jrdb_types::query::{Place, Viewpoint};
use jrdb_types::vocab::{MatchPolicy, Sector};
use jrdb_types::*;
use serde_json::{Value, json};

/// Everything is timed at least so often and for so long, as the others are.
const RUNS: usize = 7;
const LEAST: Duration = Duration::from_millis(500);
const SIZES: [usize; 3] = [50, 200, 2000];

/// A race that is none of ours.
const OTHERS: &str = "others";
/// Actions that are none of ours, and what stands for them.
const STAND_INS: [(&str, Action); 2] = [("talking", Action::Bending), ("holding", Action::Running)];
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
    let mut rows = vec![parse_row(list(&read(&folder.join("f/texts.json"))?)?)?];
    let asked = read(&folder.join("d/queries.json"))?;
    let asked: Vec<Value> =
        list(&asked)?.iter().filter(|asked| !asks_for_others(asked)).cloned().collect();
    let queries: Vec<Query> = asked.iter().map(query).collect::<Outcome<_>>()?;
    for n in SIZES {
        let scene = read(&folder.join(format!("d/graph_{n}.json")))?;
        rows.extend(graph_rows(n, &scene, (&asked, &queries)).map_err(|e| format!("n={n}: {e}"))?);
    }
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

fn asks_for_others(row: &Value) -> bool {
    row["main"]["race"] == OTHERS || row["target"]["race"] == OTHERS
}

fn check_meaning(row: &Value, query: &Query) -> Outcome<()> {
    if asks_for_others(row) == query.issues.is_empty() {
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
        "age" => Age::from_word(word).map(Condition::has),
        "gender" => Gender::from_word(word).map(Condition::has),
        "race" => Race::from_word(word).map(Condition::has),
        "action" => Action::from_word(word).map(Condition::has),
        "distance" => Some(Condition::FromRobot(Place::Distance(DistanceWord::from_word(word)?))),
        _ => Some(Condition::FromRobot(Place::Direction(Direction::level(sector?)))),
    }
}

/// Median time of some runs, seconds.
/// The median of many runs after one to warm up: some milliseconds of work say more about who else uses the machine.
fn median(mut work: impl FnMut()) -> f64 {
    work();
    let (started, mut times) = (Instant::now(), Vec::new());
    while times.len() < RUNS || started.elapsed() < LEAST {
        let start = Instant::now();
        work();
        times.push(start.elapsed().as_secs_f64());
    }
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

fn sector(value: &Value) -> Outcome<Direction> {
    let found = DIRECTIONS.iter().find(|(name, _)| Some(*name) == value.as_str());
    let sector = found.map(|(_, sector)| Direction::level(*sector));
    sector.ok_or_else(|| format!("unknown word {value}").into())
}

fn action(word: &str) -> Option<Action> {
    let stand_in = STAND_INS.iter().find(|(name, _)| *name == word).map(|(_, action)| *action);
    Action::from_word(word).or(stand_in)
}

fn word<T>(value: &Value, read: impl Fn(&str) -> Option<T>) -> Outcome<T> {
    value.as_str().and_then(read).ok_or_else(|| format!("unknown word {value}").into())
}

fn node(value: &Value) -> Outcome<Node> {
    let number = value["id"].as_u64().ok_or("expected an id")?;
    let from_robot = SpatialRelation {
        distance: Some(word(&value["distance"], DistanceWord::from_word)?),
        direction: Some(sector(&value["sr_robot"])?),
        ..SpatialRelation::default()
    };
    Ok(Node {
        id: EntityId::new("pedestrian", u32::try_from(number)?),
        category: "person".into(),
        score: 1.0,
        bbox: PixelBox::from([0.0, 0.0, 1.0, 1.0]),
        attributes: Attributes::default()
            .with_age(Belief::certain(word(&value["age"], Age::from_word)?))
            .with_gender(Belief::certain(word(&value["gender"], Gender::from_word)?))
            .with_race(Belief::from_label(value["race"].as_str().and_then(Race::from_word)))
            .with_action(Belief::certain(word(&value["action"], action)?)),
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
        capabilities: Some(Capabilities::open()),
        issues: Vec::new(),
    })
}

fn conditions(value: &Value) -> Outcome<Vec<Condition>> {
    let asked = value.as_object().ok_or("expected attributes")?;
    asked.iter().map(|(key, value)| condition(key, value)).collect()
}

fn condition(key: &str, value: &Value) -> Outcome<Condition> {
    Ok(match key {
        "age" => Condition::has(word(value, Age::from_word)?),
        "gender" => Condition::has(word(value, Gender::from_word)?),
        "distance" => Condition::FromRobot(Place::Distance(word(value, DistanceWord::from_word)?)),
        "sr_robot" => Condition::FromRobot(Place::Direction(sector(value)?)),
        "race" => Condition::has(word(value, Race::from_word)?),
        "action" => Condition::has(word(value, action)?),
        other => return Err(format!("unknown attribute {other}").into()),
    })
}

fn query(value: &Value) -> Outcome<Query> {
    let mut asked = conditions(&value["main"])?;
    let relation = &value["rel"];
    if !relation.is_null() {
        let placed = |place| RelationKind::Placed { place, viewpoint: Viewpoint::Subject };
        let mut kinds = vec![placed(Place::Direction(sector(&relation["dir"])?))];
        if !relation["dist"].is_null() {
            let distance = word(&relation["dist"], DistanceWord::from_word)?;
            kinds.push(placed(Place::Distance(distance)));
        }
        let partner = Pattern { conditions: conditions(&value["target"])?, ..Pattern::default() };
        asked.push(Condition::Related(Related { kinds, partner, quantity: Quantity::SOME }));
    }
    Ok(Query { target: Pattern { conditions: asked, ..Pattern::default() }, ..Query::default() })
}
