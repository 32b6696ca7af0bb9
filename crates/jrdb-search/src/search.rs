//! The stage on one frame: a graph and a question in, an answer with its trace out.

use jrdb_graph::{BitSet, GraphIndex};
use jrdb_types::answer::Ranked;
use jrdb_types::vocab::MatchPolicy;
use jrdb_types::{Answer, EntityId, Pattern, Query, SceneGraph, Task};

use crate::evaluate::Evaluated;
use crate::searcher::Searcher;
use crate::trace::Picked;
use crate::{SearchConfig, engine, frames, issues, ranked, reply};

/// Answers a question about one frame.
///
/// The paper's two phases: a candidate must have enough of the asked attributes, then everything that is asked of its relations.
/// `strict` demands all attributes, `majority` more than half, of partners too. `ranked` orders all by the probability that
/// everything asked holds and selects those that promise the best F1; where nothing is uncertain it selects what matches strictly.
///
/// Words decide what holds; the numbers behind them, with their deviations, and the beliefs give the probabilities. `strict` and
/// `majority` give the set that they select, as the benchmark and the paper do: all of it is ranked alike, but for the confidence of
/// the detections. `ranked` ranks every candidate that is not impossible.
///
/// A question about moments is answered as [`crate::search_frames`] does for a recording of one frame.
#[must_use]
pub fn search(graph: &SceneGraph, query: &Query, config: &SearchConfig) -> Answer {
    search_indexed(&GraphIndex::new(graph), query, config)
}

/// The same on a graph that is indexed already, for many questions about one frame.
#[must_use]
pub fn search_indexed(index: &GraphIndex<'_>, query: &Query, config: &SearchConfig) -> Answer {
    if !query.slots.is_empty() {
        return frames::answer(&[index], None, query, config);
    }
    let query = &*engine::as_asked(query, config);
    let searcher = Searcher::new(index, config);
    let unpicked = Pattern { pick: None, ..query.target.clone() };
    let evaluated = searcher.evaluate_on(&unpicked, candidates(&searcher, &unpicked));
    let matching = chosen(&searcher, query, &evaluated);
    let deciding = deciding(&searcher, &query.task);
    let pick = query.target.pick.as_ref();
    let selection = pick.map_or_else(|| matching.clone(), |pick| deciding.pick(&matching, pick));
    let picked = pick.map(|pick| Picked::new(&deciding, pick, &matching));
    let trace = evaluated.kind.iter().filter_map(|number| {
        let (id, selected) = (index.id(number)?, selection.contains(number));
        Some(searcher.trace(id, number, &evaluated, picked.as_ref(), selected))
    });
    let frame = index.scene().frame.clone();
    let mut answer = Answer::new(frame, query, config.policy, searcher.lateral());
    answer.reply = reply::reply(&searcher, query, &selection);
    answer.ranking = ranking(&searcher, query, &evaluated, &selection);
    answer.trace = trace.collect();
    answer.selection = ids(index, &selection);
    answer.issues.extend(issues::of(&searcher, query));
    answer
}

/// The numbers of the things that [`search`] selects, without reasons; a question's slots are not looked at.
///
/// Under `strict` and `majority` this works on sets of bits alone.
///
/// ```
/// use jrdb_graph::GraphIndex;
/// use jrdb_search::{SearchConfig, select};
/// use jrdb_types::{FrameId, LateralConvention, Query, SceneGraph};
/// # let graph = SceneGraph::new(FrameId::default(), LateralConvention::Physical, vec![]);
/// let index = GraphIndex::new(&graph);
/// let found = select(&index, &Query::default(), &SearchConfig::default());
/// assert_eq!(found.iter().filter_map(|number| index.id(number)).count(), 0);
/// ```
#[must_use]
pub fn select(index: &GraphIndex<'_>, query: &Query, config: &SearchConfig) -> BitSet {
    let query = &*engine::as_asked(query, config);
    let searcher = Searcher::new(index, config);
    if engine::pools(config) || (config.policy == MatchPolicy::Ranked && presupposes(&query.task)) {
        let unpicked = Pattern { pick: None, ..query.target.clone() };
        let evaluated = searcher.evaluate_on(&unpicked, candidates(&searcher, &unpicked));
        let matching = chosen(&searcher, query, &evaluated);
        let pick = query.target.pick.as_ref();
        return pick.map_or_else(|| matching.clone(), |pick| searcher.pick(&matching, pick));
    }
    by_sets(&searcher, &query.target)
}

/// Whether a question supposes that somebody is meant, so that the best guess is an answer. Counting does not.
pub(crate) fn presupposes(task: &Task) -> bool {
    matches!(task, Task::Find | Task::Where | Task::Which { .. })
}

/// Who decides what things are meant: where nobody need be meant, the best values alone.
fn deciding<'i, 'a>(searcher: &Searcher<'i, 'a>, task: &Task) -> Searcher<'i, 'a> {
    match searcher.config.policy {
        MatchPolicy::Ranked if !presupposes(task) => searcher.with(MatchPolicy::Strict),
        policy => searcher.with(policy),
    }
}

/// Nodes of a pattern's kind.
pub(crate) fn candidates(searcher: &Searcher<'_, '_>, pattern: &Pattern) -> BitSet {
    let mut kind = searcher.kind(&pattern.category).into_owned();
    only_nodes(searcher, &mut kind);
    kind
}

fn only_nodes(searcher: &Searcher<'_, '_>, set: &mut BitSet) {
    (searcher.index.node_count()..searcher.index.size()).for_each(|number| set.remove(number));
}

/// Those that match, without the pick.
fn chosen(searcher: &Searcher<'_, '_>, query: &Query, evaluated: &Evaluated<'_>) -> BitSet {
    if engine::pools(&searcher.config) {
        return engine::pooled_numbers(searcher, evaluated.pattern);
    }
    match searcher.config.policy {
        MatchPolicy::Strict | MatchPolicy::Majority => evaluated.passed.clone(),
        MatchPolicy::Ranked if presupposes(&query.task) => {
            ranked::unpicked_choice(searcher, evaluated)
        }
        MatchPolicy::Ranked => by_sets(searcher, evaluated.pattern),
    }
}

/// Nodes that match a pattern, its pick included, where nobody need be meant: by the best values.
pub(crate) fn by_sets(searcher: &Searcher<'_, '_>, pattern: &Pattern) -> BitSet {
    if searcher.config.policy == MatchPolicy::Ranked {
        return by_sets(&searcher.with(MatchPolicy::Strict), pattern);
    }
    if searcher.index.node_count() == searcher.index.size() {
        return searcher.matches(pattern);
    }
    let mut found = searcher.matches(&Pattern { pick: None, ..pattern.clone() });
    only_nodes(searcher, &mut found);
    pattern.pick.as_ref().map_or_else(|| found.clone(), |pick| searcher.pick(&found, pick))
}

fn ranking(
    searcher: &Searcher<'_, '_>,
    query: &Query,
    evaluated: &Evaluated<'_>,
    selection: &BitSet,
) -> Vec<Ranked> {
    let is_ranked = searcher.config.policy == MatchPolicy::Ranked;
    let picked = query.target.pick.as_ref().filter(|_| is_ranked);
    let picked = picked.map(|pick| ranked::picked_probabilities(searcher, evaluated, pick));
    let probability = |n: usize| match &picked {
        // A set has no order in it.
        _ if !is_ranked => 1.0,
        Some(picked) => picked[n],
        None => evaluated.verdicts[n].ranking,
    };
    let candidates = evaluated
        .kind
        .iter()
        .filter(|&number| selection.contains(number) || (is_ranked && probability(number) > 0.0));
    let ranked = candidates.filter_map(|number| {
        let node = searcher.index.node(number)?;
        let probability = (node.score * probability(number)).clamp(0.0, 1.0);
        Some(Ranked { id: node.id.clone(), bbox: node.bbox, probability })
    });
    in_order(ranked.collect())
}

/// Most probable first; ties by id.
pub(crate) fn in_order(mut ranking: Vec<Ranked>) -> Vec<Ranked> {
    ranking.sort_by(|a, b| b.probability.total_cmp(&a.probability).then_with(|| a.id.cmp(&b.id)));
    ranking
}

/// Ids of some numbers, sorted.
pub(crate) fn ids(index: &GraphIndex<'_>, set: &BitSet) -> Vec<EntityId> {
    set.iter().filter_map(|number| index.id(number)).cloned().collect()
}
