//! The stage on one frame: a graph and a question in, an answer with its trace out.

use jrdb_graph::{BitSet, GraphIndex};
use jrdb_types::answer::Ranked;
use jrdb_types::vocab::MatchPolicy;
use jrdb_types::{Answer, Pattern, Query, SceneGraph};

use crate::candidates::{by_sets, candidates, deciding, ids, in_order, presupposes};
use crate::evaluation::Evaluated;
use crate::looks::{Blind, Looks};
use crate::searcher::Searcher;
use crate::trace::Picked;
use crate::{SearchConfig, benchmark, frames, issues, ranked, reply, status};

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
    search_with(index, query, config, &Blind)
}

/// The same with somebody who can be asked how things look, for the words that no table holds. A
/// question about moments is answered without.
#[must_use]
pub fn search_with(
    index: &GraphIndex<'_>,
    query: &Query,
    config: &SearchConfig,
    eyes: &dyn Looks,
) -> Answer {
    if !query.slots.is_empty() {
        return frames::answer(&[index], None, query, config);
    }
    let query = &*benchmark::as_asked(query, config);
    let searcher = Searcher::seeing(index, config, eyes);
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
    let strictly = searcher.with(strict_of(config.policy));
    status::settle(&mut answer, &strictly, query, &evaluated);
    answer
}

/// Answers a question about a recording: its frames in the order of time.
///
/// `slots` says which of the frames (by their place in the list) each slot covers, where the caller knows. Else a slot covers the
/// frames of its seconds, both ends included, counted from the first frame's number at
/// [`SearchConfig::frames_per_second`]; and a slot without seconds is any moment.
///
/// A track matches a slot of several frames when it matches in more than half of those that it is seen in; it matches any moment when
/// it matches in one frame. What is asked one after the other must be matched one after the other, by the earliest moments
/// that there are, unless [`SearchConfig::order`] says otherwise. A question without slots is about the whole recording.
///
/// Under [`crate::Pooling::PerCondition`] every slot has the engine's answer, and the selection and number are the first slot's, as
/// the benchmark reads them.
#[must_use]
pub fn search_frames(
    recording: &[SceneGraph],
    slots: Option<&[Vec<usize>]>,
    query: &Query,
    config: &SearchConfig,
) -> Answer {
    let indices: Vec<GraphIndex<'_>> = recording.iter().map(GraphIndex::new).collect();
    let indices: Vec<&GraphIndex<'_>> = indices.iter().collect();
    match indices.as_slice() {
        [only] if slots.is_none() && query.slots.is_empty() => search_indexed(only, query, config),
        _ => frames::answer(&indices, slots, query, config),
    }
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
    let query = &*benchmark::as_asked(query, config);
    let searcher = Searcher::new(index, config);
    if benchmark::pools(config)
        || (config.policy == MatchPolicy::Ranked && presupposes(&query.task))
    {
        let unpicked = Pattern { pick: None, ..query.target.clone() };
        let evaluated = searcher.evaluate_on(&unpicked, candidates(&searcher, &unpicked));
        let matching = chosen(&searcher, query, &evaluated);
        let pick = query.target.pick.as_ref();
        return pick.map_or_else(|| matching.clone(), |pick| searcher.pick(&matching, pick));
    }
    by_sets(&searcher, &query.target)
}

/// Those that match, without the pick.
fn chosen(searcher: &Searcher<'_, '_>, query: &Query, evaluated: &Evaluated<'_>) -> BitSet {
    if benchmark::pools(&searcher.config) {
        return benchmark::pooled_numbers(searcher, evaluated.pattern);
    }
    match searcher.config.policy {
        MatchPolicy::Strict | MatchPolicy::Majority => evaluated.passed.clone(),
        MatchPolicy::Ranked if presupposes(&query.task) => {
            ranked::unpicked_choice(searcher, evaluated)
        }
        MatchPolicy::Ranked => by_sets(searcher, evaluated.pattern),
    }
}

/// The policy by which a candidate satisfies a question: under `ranked` all conditions must hold.
fn strict_of(policy: MatchPolicy) -> MatchPolicy {
    if policy == MatchPolicy::Ranked { MatchPolicy::Strict } else { policy }
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
