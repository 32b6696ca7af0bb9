//! What JRDB-Reasoning's engine does differently: how it pools frames, and how it takes relations apart.

use std::borrow::Cow;
use std::collections::BTreeSet;

use jrdb_graph::{BitSet, GraphIndex};
use jrdb_types::answer::Sighting;
use jrdb_types::query::{RelationKind, Slot};
use jrdb_types::vocab::MatchPolicy;
use jrdb_types::{Condition, EntityId, Pattern, Query, Related, SceneGraph};

use crate::SearchConfig;
use crate::candidates::{by_sets, ids as ids_of};
use crate::config::{Existentials, Pooling};
use crate::searcher::Searcher;

/// The engine's unit: a thing with one box, so that whoever moves counts once per box. The box as its bits.
type Boxed<'a> = (&'a EntityId, [u64; 4]);

/// Whether conditions are pooled one by one.
pub(crate) fn pools(config: &SearchConfig) -> bool {
    config.pooling == Pooling::PerCondition
}

/// The ids that JRDB-Reasoning's engine gives for a sub-question: those that satisfy each of its conditions at some moment
/// of the slot. Sorted; all people when there are no conditions.
///
/// `frames` are the slot's. Unlike for a whole question, a condition that nobody satisfies leaves nobody.
///
/// ```
/// use jrdb_search::{SearchConfig, benchmark_sub_answer};
/// use jrdb_types::{Condition, Gender};
/// let women = benchmark_sub_answer(&[], &[Condition::has(Gender::Female)], &SearchConfig::benchmark());
/// assert!(women.is_empty());
/// ```
#[must_use]
pub fn benchmark_sub_answer(
    frames: &[&SceneGraph],
    conditions: &[Condition],
    config: &SearchConfig,
) -> Vec<EntityId> {
    let indices: Vec<GraphIndex<'_>> = frames.iter().map(|graph| GraphIndex::new(graph)).collect();
    let rewritten: Vec<Condition> = conditions.iter().map(|c| taken_apart(c, config)).collect();
    let ids = |conditions: &[Condition]| -> BTreeSet<EntityId> {
        let pattern = Pattern { conditions: conditions.to_vec(), ..Pattern::default() };
        let found = indices.iter().flat_map(|index| {
            let searcher = Searcher::new(index, &config.with(MatchPolicy::Strict));
            ids_of(index, &by_sets(&searcher, &pattern))
        });
        found.collect()
    };
    let mut all = ids(&[]);
    for condition in &rewritten {
        let those = ids(std::slice::from_ref(condition));
        all.retain(|id| those.contains(id));
    }
    all.into_iter().collect()
}

/// The engine's answer for one slot: (thing, box) of the first frame each is seen in, sorted by id, then frame.
pub(crate) fn pooled(
    frames: &[&GraphIndex<'_>],
    pattern: &Pattern,
    config: &SearchConfig,
) -> Vec<Sighting> {
    let of = |conditions: &[Condition]| pool(frames, pattern, conditions, config);
    let mut left = of(&[]);
    for condition in &pattern.conditions {
        let those = of(std::slice::from_ref(condition));
        if !those.is_empty() {
            left.retain(|unit| those.contains(unit));
        }
    }
    let mut seen = Vec::new();
    for index in frames {
        let frame = index.scene().frame.frame;
        for (_, node) in index.nodes() {
            if left.remove(&unit(&node.id, node.bbox.into())) {
                seen.push(Sighting { id: node.id.clone(), frame, bbox: node.bbox });
            }
        }
    }
    seen.sort_by(|a, b| (&a.id, a.frame).cmp(&(&b.id, b.frame)));
    seen
}

fn pool<'a>(
    frames: &[&'a GraphIndex<'_>],
    pattern: &Pattern,
    conditions: &[Condition],
    config: &SearchConfig,
) -> BTreeSet<Boxed<'a>> {
    let alone =
        Pattern { conditions: conditions.to_vec(), ..Pattern::of(pattern.category.clone()) };
    let mut pool = BTreeSet::new();
    for &index in frames {
        let found = by_sets(&Searcher::new(index, &config.with(MatchPolicy::Strict)), &alone);
        let nodes = found.iter().filter_map(|number| index.node(number));
        pool.extend(nodes.map(|node| unit(&node.id, node.bbox.into())));
    }
    pool
}

fn unit(id: &EntityId, bbox: [f64; 4]) -> Boxed<'_> {
    (id, bbox.map(f64::to_bits))
}

/// The same on one frame, as numbers.
pub(crate) fn pooled_numbers(searcher: &Searcher<'_, '_>, pattern: &Pattern) -> BitSet {
    let mut found = BitSet::new(searcher.index.size());
    let seen = pooled(&[searcher.index], pattern, &searcher.config);
    let numbers = seen.iter().filter_map(|seen| searcher.index.number(&seen.id));
    numbers.for_each(|number| found.insert(number));
    found
}

/// A question with its relations taken apart where each may have its own partner.
pub(crate) fn as_asked<'q>(query: &'q Query, config: &SearchConfig) -> Cow<'q, Query> {
    if config.existentials == Existentials::Same {
        return Cow::Borrowed(query);
    }
    let apart =
        |conditions: &[Condition]| conditions.iter().map(|c| taken_apart(c, config)).collect();
    let target = Pattern { conditions: apart(&query.target.conditions), ..query.target.clone() };
    let slots = query.slots.iter();
    let slots = slots.map(|slot| Slot { conditions: apart(&slot.conditions), ..slot.clone() });
    Cow::Owned(Query { target, slots: slots.collect(), ..query.clone() })
}

/// What is on one edge stays together: a direction and a distance.
fn taken_apart(condition: &Condition, config: &SearchConfig) -> Condition {
    let each = |parts: &[Condition]| parts.iter().map(|part| taken_apart(part, config)).collect();
    match condition {
        Condition::Related(related)
            if config.existentials == Existentials::Independent && related.kinds.len() > 1 =>
        {
            let is_placed = |kind: &&RelationKind| matches!(kind, RelationKind::Placed { .. });
            let (placed, others): (Vec<_>, Vec<_>) = related.kinds.iter().partition(is_placed);
            let others = others.into_iter().map(|kind| vec![kind.clone()]);
            let placed: Vec<RelationKind> = placed.into_iter().cloned().collect();
            let groups = std::iter::once(placed).filter(|g| !g.is_empty()).chain(others);
            let parts: Vec<Condition> = groups
                .map(|kinds| Condition::Related(Related { kinds, ..related.clone() }))
                .collect();
            match <[Condition; 1]>::try_from(parts) {
                Ok([only]) => only,
                Err(parts) => Condition::All(parts),
            }
        }
        Condition::Not(inner) => Condition::Not(Box::new(taken_apart(inner, config))),
        Condition::Any(parts) => Condition::Any(each(parts)),
        Condition::All(parts) => Condition::All(each(parts)),
        other => other.clone(),
    }
}
