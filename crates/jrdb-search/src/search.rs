//! The stage: a graph and a query in, an answer with its trace out.

use jrdb_graph::GraphIndex;
use jrdb_types::answer::{CandidateTrace, Ranked};
use jrdb_types::issue::IssueKind;
use jrdb_types::query::Category;
use jrdb_types::vocab::MatchPolicy;
use jrdb_types::{Answer, EntityId, Issue, Node, Query, SceneGraph, Task};

use crate::SearchConfig;
use crate::check::{Judge, Verdict, is_of};

/// Answers a query on one frame.
///
/// The paper's two phases: a candidate must have enough of the asked attributes, then an edge of each asked
/// relation to a partner that matches in turn. `strict` demands all attributes, `majority` more
/// than half; `ranked` is `majority`, then selects the tier that satisfies most conditions, so that it
/// equals `strict` whenever anything matches strictly.
///
/// Words decide what holds; the numbers behind them give the probabilities of the ranking. `strict` and
/// `majority` rank what they select, `ranked` every candidate that is not impossible.
#[must_use]
pub fn search(graph: &SceneGraph, query: &Query, config: &SearchConfig) -> Answer {
    let judge = Judge { index: GraphIndex::new(graph), lateral: graph.lateral, config };
    let candidates: Vec<(&Node, Verdict)> = judge
        .index
        .nodes()
        .iter()
        .filter(|node| is_of(&query.target.category, node))
        .map(|node| (node, judge.judge(&node.id, Some(node), &query.target)))
        .collect();
    let selection = select(&candidates, config.policy);
    let is_selected = |id: &EntityId| selection.binary_search(id).is_ok();
    let mut issues = query.issues.clone();
    issues.extend(missing_kind(&candidates, &query.target.category));
    let trace = candidates.iter().map(|(node, verdict)| CandidateTrace {
        id: node.id.clone(),
        selected: is_selected(&node.id),
        passed_attributes: verdict.passed_attributes,
        passed_relations: verdict.passed_relations,
        checks: verdict.checks.clone(),
    });
    Answer {
        frame: graph.frame.clone(),
        question: query.text.clone(),
        task: query.task,
        policy: config.policy,
        lateral: graph.lateral,
        count: (query.task == Task::Count).then_some(selection.len()),
        ranking: rank(&candidates, |id| config.policy == MatchPolicy::Ranked || is_selected(id)),
        trace: trace.collect(),
        issues,
        selection,
    }
}

fn select(candidates: &[(&Node, Verdict)], policy: MatchPolicy) -> Vec<EntityId> {
    let survivors: Vec<_> = candidates.iter().filter(|(_, verdict)| verdict.passed()).collect();
    let tier = match policy {
        MatchPolicy::Ranked => survivors.iter().map(|(_, verdict)| verdict.satisfied).max(),
        MatchPolicy::Strict | MatchPolicy::Majority => None,
    };
    let in_tier = |verdict: &Verdict| tier.is_none_or(|tier| verdict.satisfied == tier);
    let mut selection: Vec<EntityId> = survivors
        .iter()
        .filter(|(_, verdict)| in_tier(verdict))
        .map(|(node, _)| node.id.clone())
        .collect();
    selection.sort();
    selection
}

fn rank(candidates: &[(&Node, Verdict)], is_ranked: impl Fn(&EntityId) -> bool) -> Vec<Ranked> {
    let mut ranking: Vec<Ranked> = candidates
        .iter()
        .filter(|(node, verdict)| {
            is_ranked(&node.id) && (verdict.passed() || verdict.probability > 0.0)
        })
        .map(|(node, verdict)| Ranked {
            id: node.id.clone(),
            bbox: node.bbox,
            probability: node.score * verdict.probability,
        })
        .collect();
    ranking.sort_by(|a, b| b.probability.total_cmp(&a.probability).then(a.id.cmp(&b.id)));
    ranking
}

fn missing_kind(candidates: &[(&Node, Verdict)], category: &Category) -> Option<Issue> {
    let asked = match category {
        _ if !candidates.is_empty() => return None,
        Category::Person => "people",
        Category::Object => "objects",
        Category::Class(name) => name,
    };
    Some(Issue::new(IssueKind::NotInGraph, format!("the scene graph holds no {asked}")))
}
