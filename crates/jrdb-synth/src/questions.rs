//! Questions about a frame whose answers are known and do not hang on a hair.

use std::collections::{BTreeMap, BTreeSet};

use jrdb_graph::GraphConfig;
use jrdb_projection::{ProjectionConfig, Scan};
use jrdb_search::SearchConfig;
use jrdb_types::detection::PERSON;
use jrdb_types::issue::IssueKind;
use jrdb_types::vocab::{MatchPolicy, Occlusion};
use jrdb_types::{Answer, Detection, Detections, Localizer, Query, Question, SceneGraph, Truth};

use super::random::Random;
use super::robot;
use super::wording;

/// Scenes with every position moved a little, in each of which an answer must stay the same.
const JITTERS: u64 = 24;
/// Most that a position is off when it comes from LiDAR points, along and across the line of sight,
/// metres: what a localiser does to people it sees.
const JITTER_M: [f64; 2] = [0.25, 0.08];
/// The same of people whom others hide and of furniture, through which one sees the floor: the
/// points in the box may be anything's.
const UNSURE_JITTER_M: [f64; 2] = [3.0, 0.15];

/// At most so many questions of one pattern.
const PER_PATTERN: usize = 2;
/// A relation to anybody of a kind that holds for more people than this tells nobody apart.
const TOLD_APART: usize = 3;

/// Questions about a frame, by category, with the strict answer on the true scene.
///
/// Kept are those that the parser reads without trouble, that somebody answers, and whose answer is
/// the same in every jittered scene.
pub(super) fn questions(labels: &Detections, seed: u64) -> Vec<Question> {
    let truth = graph(labels);
    let mut random = Random::stream(seed, 0x5eed + u64::from(labels.frame.frame));
    let jittered: Vec<SceneGraph> =
        (0..JITTERS).map(|_| graph(&jitter(labels, &mut random))).collect();
    let mut asked: BTreeMap<(&str, &str), usize> = BTreeMap::new();
    let mut seen = BTreeSet::new();
    let mut questions = Vec::new();
    for sentence in random.shuffled(&wording::sentences(&truth)) {
        let count = asked.entry((sentence.category, sentence.pattern)).or_default();
        if *count >= PER_PATTERN || !seen.insert(sentence.text.clone()) {
            continue;
        }
        let Some(Settled { text, query, truth }) = settled(&sentence.text, &truth, &jittered)
        else {
            continue;
        };
        if !sentence.is_vague || truth.ids.len() <= TOLD_APART {
            *count += 1;
            let (category, frame) = (sentence.category.into(), labels.frame.clone());
            questions.push(Question {
                id: None,
                text,
                query: Some(query),
                category,
                frame,
                slots: Vec::new(),
                truth: Some(truth),
            });
        }
    }
    questions.sort_by(|a, b| (&a.category, &a.text).cmp(&(&b.category, &b.text)));
    questions
}

/// A question that is safe to ask.
struct Settled {
    /// The sentence in singular or plural, as its answer is.
    text: String,
    /// What it means, in the notation of queries.
    query: String,
    truth: Truth,
}

/// A sentence as a question with its answer; none when it is not safe.
fn settled(text: &str, truth: &SceneGraph, jittered: &[SceneGraph]) -> Option<Settled> {
    let query = jrdb_parser::parse(text);
    if query.issues.iter().any(|issue| issue.kind != IssueKind::Ambiguous) {
        return None;
    }
    let answer = strict(truth, &query);
    let same = |graph: &SceneGraph| strict(graph, &query).selection == answer.selection;
    if answer.selection.is_empty() || !jittered.iter().all(same) {
        return None;
    }
    let boxes = answer
        .selection
        .iter()
        .filter_map(|id| truth.nodes.iter().find(|node| node.id == *id).map(|node| node.bbox));
    let boxes = boxes.collect();
    let text = if answer.selection.len() > 1 { wording::plural(text) } else { text.into() };
    let count = answer.number();
    let truth = Truth { ids: answer.selection, boxes, count, ..Truth::default() };
    Some(Settled { text, query: jrdb_parser::notation::write(&query), truth })
}

fn strict(graph: &SceneGraph, query: &Query) -> Answer {
    let config = SearchConfig { policy: MatchPolicy::Strict, ..SearchConfig::default() };
    jrdb_search::search(graph, query, &config)
}

/// The scene graph on the 3D boxes of the labels.
fn graph(labels: &Detections) -> SceneGraph {
    let config = ProjectionConfig { localizer: Localizer::Given, ..ProjectionConfig::default() };
    let entities =
        jrdb_projection::project(labels, &Scan::new(&[], &robot::calibration().rig()), &config)
            .expect("the labels are of this rig's image");
    jrdb_graph::build(&entities, &GraphConfig::default())
}

fn jitter(labels: &Detections, random: &mut Random) -> Detections {
    let mut labels = labels.clone();
    for thing in &mut labels.detections {
        let [along_m, across_m] = if is_unsure(thing) { UNSURE_JITTER_M } else { JITTER_M };
        if let Some(label) = &mut thing.box3d {
            let [x, y, _] = label.center;
            let range_m = x.hypot(y).max(f64::EPSILON);
            // Nothing is ever placed on the other side of the robot.
            let along_m = random.about_zero(along_m.min(range_m / 2.0));
            let across_m = random.about_zero(across_m);
            let (cos, sin) = (x / range_m, y / range_m);
            label.center[0] += along_m * cos - across_m * sin;
            label.center[1] += along_m * sin + across_m * cos;
        }
    }
    labels
}

fn is_unsure(thing: &Detection) -> bool {
    let hidden = [Some(Occlusion::SeverelyOccluded), Some(Occlusion::FullyOccluded)];
    thing.category != PERSON || hidden.contains(&thing.occlusion)
}
