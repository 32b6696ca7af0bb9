//! One candidate tried alone: with what its answer hangs on, and everybody else as they are.

use jrdb_graph::{BitSet, GraphIndex};
use jrdb_types::query::{Category, Measure, RelationKind};
use jrdb_types::vocab::MatchPolicy;
use jrdb_types::{Condition, EntityId, Pattern, Query};

use super::number::{Number, Scratch};
use crate::candidates::{candidates, presupposes};
use crate::evaluation::Evaluated;
use crate::searcher::Searcher;
use crate::{SearchConfig, benchmark, ranked};

/// How far the edges reach that a pattern hangs on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Reach {
    /// No edge matters.
    Nothing,
    /// Only edges of the candidate.
    Own,
    /// Edges between others too.
    Everything,
}

impl Reach {
    /// Reach of a pattern, in graphs where every thing has a centre or not.
    pub(super) fn of(pattern: &Pattern, all_placed: bool) -> Self {
        let reach = |condition| Self::of_condition(condition, all_placed);
        let conditions = pattern.conditions.iter().map(reach);
        let pick = pattern.pick.iter().map(|pick| Self::of_measure(&pick.measure, all_placed));
        conditions.chain(pick).max().unwrap_or(Self::Nothing)
    }

    /// Of what is asked of others: what hangs on their edges hangs on all.
    fn beyond(self) -> Self {
        if self == Self::Nothing { self } else { Self::Everything }
    }

    fn of_condition(condition: &Condition, all_placed: bool) -> Self {
        let of = |pattern: &Pattern| Self::of(pattern, all_placed);
        match condition {
            Condition::Related(related) => {
                let others = related.kinds.iter().map(|kind| match kind {
                    RelationKind::Between(others) => of(others).beyond(),
                    _ => Self::Own,
                });
                others.fold(of(&related.partner).beyond().max(Self::Own), Self::max)
            }
            Condition::Compared(compared) => {
                let measure = Self::of_measure(&compared.measure, all_placed);
                measure.max(of(&compared.than).beyond())
            }
            Condition::Is(pattern) => of(pattern).beyond(),
            Condition::Not(inner) => Self::of_condition(inner, all_placed),
            Condition::Any(parts) | Condition::All(parts) => {
                let parts = parts.iter().map(|part| Self::of_condition(part, all_placed));
                parts.max().unwrap_or(Self::Nothing)
            }
            Condition::GroupSize(_) | Condition::Nearer(_) => Self::Everything,
            Condition::Attribute(_)
            | Condition::FromRobot(_)
            | Condition::Measures(_)
            | Condition::Looks(_)
            | Condition::Id(_)
            | Condition::Phrase(_) => Self::Nothing,
        }
    }

    fn of_measure(measure: &Measure, all_placed: bool) -> Self {
        match measure {
            Measure::DistanceTo(pattern) if pattern.category != Category::Robot && !all_placed => {
                Self::Everything
            }
            Measure::DistanceTo(pattern) => Self::of(pattern, all_placed).beyond(),
            _ => Self::Nothing,
        }
    }
}

/// Everybody as they are, under a policy that chooses from a ranking.
struct Ranking {
    /// Probability and number of everybody.
    promising: Vec<(f64, usize)>,
    uncertain: BitSet,
    strict: BitSet,
}

/// A graph with the edges that one candidate's answer hangs on.
pub(super) struct Candidate<'g, 'q> {
    scratch: Scratch<'g>,
    query: &'q Query,
    config: SearchConfig,
    /// Absent where everybody is chosen for themselves.
    ranking: Option<Ranking>,
}

impl Ranking {
    fn new(searcher: &Searcher<'_, '_>, everybody: &Evaluated<'_>) -> Self {
        let mut uncertain = everybody.kind.clone();
        uncertain.retain(|number| everybody.verdicts[number].uncertain);
        let mut strict = searcher.with(MatchPolicy::Strict).matches(everybody.pattern);
        strict.intersect(&everybody.kind);
        Self { promising: ranked::promising(searcher, everybody), uncertain, strict }
    }

    /// Whether a thing would be chosen at a probability; `None` where nobody is probable at all.
    fn takes(&self, number: usize, probability: f64) -> Option<bool> {
        let own = |(p, other)| (if other == number { probability } else { p }, other);
        let chosen = ranked::best_expected_f1(self.promising.iter().copied().map(own).collect());
        (!chosen.is_empty()).then(|| chosen.contains(&number))
    }
}

impl<'g, 'q> Candidate<'g, 'q> {
    /// For a question of which a candidate can be tried alone; else `None`.
    pub(super) fn new(
        index: &GraphIndex<'g>,
        query: &'q Query,
        config: &SearchConfig,
        reach: Reach,
    ) -> Option<Self> {
        if reach == Reach::Everything || query.target.pick.is_some() || benchmark::pools(config) {
            return None;
        }
        let is_ranked = config.policy == MatchPolicy::Ranked;
        let ranking = (is_ranked && presupposes(&query.task)).then(|| {
            let searcher = Searcher::new(index, config);
            let kind = candidates(&searcher, &query.target);
            Ranking::new(&searcher, &searcher.evaluate_on(&query.target, kind))
        });
        let policy =
            if is_ranked && ranking.is_none() { MatchPolicy::Strict } else { config.policy };
        let scratch = Scratch::with_edges(index.scene(), Vec::new());
        Some(Self { scratch, query, config: config.with(policy), ranking })
    }

    /// Whether what is found of one candidate is the answer, whatever becomes of the others.
    pub(super) fn is_exact(&self) -> bool {
        self.ranking.is_none()
    }

    /// Turns to another candidate.
    pub(super) fn turn_to(&mut self, index: &GraphIndex<'_>, id: &EntityId, reach: Reach) {
        let Some(number) = index.number(id).filter(|_| reach == Reach::Own) else { return };
        let rows = [index.outgoing(number), index.incoming(number)];
        let mut places: Vec<u32> = rows.iter().flat_map(|row| row.edges).copied().collect();
        places.sort_unstable();
        let edges = places.iter().map(|&place| index.scene().edges[place as usize].clone());
        self.scratch.set_edges(edges.collect());
    }

    /// Whether a thing would be selected with a number changed; `None` where that cannot be said of it alone.
    pub(super) fn is_selected(
        &mut self,
        id: &EntityId,
        number: &Number,
        from: f64,
        to: f64,
    ) -> Option<bool> {
        let index = GraphIndex::new(self.scratch.with(number, from, to));
        let place = index.number(id)?;
        let evaluate = |searcher: &Searcher<'_, '_>| {
            let mut only = BitSet::new(index.size());
            only.insert(place);
            let evaluated = searcher.evaluate_on(&self.query.target, only);
            let verdict = evaluated.verdicts[place];
            (verdict, evaluated.passed.contains(place))
        };
        let searcher = Searcher::new(&index, &self.config);
        let (verdict, passed) = evaluate(&searcher);
        let Some(ranking) = &self.ranking else { return Some(passed) };
        if !verdict.uncertain && ranking.uncertain.iter().all(|other| other == place) {
            let (_, is_strict) = evaluate(&searcher.with(MatchPolicy::Strict));
            if is_strict || ranking.strict.iter().any(|other| other != place) {
                return Some(is_strict);
            }
        }
        let score = index.node(place).map_or(1.0, |node| node.score);
        ranking.takes(place, score * verdict.probability)
    }
}
