//! Which things a pattern may mean, and those that match by the most probable values.

use jrdb_graph::{BitSet, GraphIndex};
use jrdb_types::answer::Ranked;
use jrdb_types::vocab::MatchPolicy;
use jrdb_types::{EntityId, Pattern, Task};

use crate::searcher::Searcher;

/// Whether a question presupposes an answer, so that the best guess is one. Counting does not.
pub(crate) fn presupposes(task: &Task) -> bool {
    matches!(
        task,
        Task::Find | Task::Where | Task::Which { .. } | Task::Choice { .. } | Task::From { .. }
    )
}

/// The searcher that decides which things are meant. If the question does not presuppose an answer, only the most probable
/// values count.
pub(crate) fn deciding<'i, 'a>(searcher: &Searcher<'i, 'a>, task: &Task) -> Searcher<'i, 'a> {
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

pub(crate) fn only_nodes(searcher: &Searcher<'_, '_>, set: &mut BitSet) {
    (searcher.index.node_count()..searcher.index.size()).for_each(|number| set.remove(number));
}

/// Nodes that match a pattern, its pick included, by the most probable values: for questions that do not presuppose an answer.
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

/// Most probable first; ties by id.
pub(crate) fn in_order(mut ranking: Vec<Ranked>) -> Vec<Ranked> {
    ranking.sort_by(|a, b| b.probability.total_cmp(&a.probability).then_with(|| a.id.cmp(&b.id)));
    ranking
}

/// Ids of some numbers, sorted.
pub(crate) fn ids(index: &GraphIndex<'_>, set: &BitSet) -> Vec<EntityId> {
    set.iter().filter_map(|number| index.id(number)).cloned().collect()
}
