//! What evaluating a pattern comes to: its conditions on everything that it may mean, and the relations that they ask for.

use std::cell::OnceCell;
use std::sync::Arc;

use jrdb_graph::BitSet;
use jrdb_types::answer::Criterion;
use jrdb_types::query::{Order, Place, RelationKind, Viewpoint};
use jrdb_types::vocab::PairWord;
use jrdb_types::{Condition, Pattern};

use crate::place::is_distance;
use crate::probability::certainty;
use crate::value::{Truth, Value};

/// A pattern, evaluated.
pub(crate) struct Evaluated<'q> {
    pub(crate) pattern: &'q Pattern,
    /// Things of its kind.
    pub(crate) kind: BitSet,
    pub(crate) columns: Vec<Column<'q>>,
    /// By number; of other kinds nothing passes.
    pub(crate) verdicts: Vec<Verdict>,
    /// Those that pass, its pick included.
    pub(crate) passed: BitSet,
}

/// One condition on every thing, and what it consists of.
pub(crate) struct Column<'q> {
    pub(crate) condition: &'q Condition,
    /// The condition for the traces, which share it; made for the first.
    shared: OnceCell<Arc<Condition>>,
    pub(crate) values: Vec<Value>,
    pub(crate) inner: Inner<'q>,
}

impl<'q> Column<'q> {
    pub(crate) fn new(condition: &'q Condition, values: Vec<Value>, inner: Inner<'q>) -> Self {
        Self { condition, shared: OnceCell::new(), values, inner }
    }

    /// The condition as a trace holds it.
    pub(crate) fn criterion(&self) -> Criterion {
        let shared = self.shared.get_or_init(|| Arc::new(self.condition.clone()));
        Criterion::Condition(Arc::clone(shared))
    }
}

/// What a condition consists of.
pub(crate) enum Inner<'q> {
    Leaf,
    Relation { kinds: Kinds<'q>, partner: Partner<'q> },
    Comparison(Comparison),
    Pattern(Box<Evaluated<'q>>),
    Parts(Vec<Column<'q>>),
}

/// What checking every condition of a pattern on one thing came to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Verdict {
    /// Enough attributes hold (the paper's phase 1).
    pub(crate) passed_attributes: bool,
    /// Every relation holds (the paper's phase 2).
    pub(crate) passed_relations: bool,
    /// Whether it matches, as far as that is known: under `ranked`, whether strictly.
    pub(crate) truth: Truth,
    /// Conditions that hold, those of the witnesses included.
    pub(crate) satisfied: u32,
    /// Product of the probabilities of the conditions, as believed.
    pub(crate) probability: f64,
    /// The same for the ranking.
    pub(crate) ranking: f64,
    /// Whether a belief that is neither 0 nor 1 has a part in it.
    pub(crate) uncertain: bool,
}

impl Verdict {
    pub(crate) const OTHER_KIND: Self = Self {
        passed_attributes: false,
        passed_relations: false,
        truth: Truth::No,
        satisfied: 0,
        probability: 0.0,
        ranking: 0.0,
        uncertain: false,
    };

    pub(crate) fn passed(&self) -> bool {
        self.passed_attributes && self.passed_relations
    }
}

impl Evaluated<'_> {
    /// Gives everything that does not pass the truth that a function gives it, everything else passes.
    pub(crate) fn decide(&mut self, of_others: impl Fn(usize, Truth) -> Truth) {
        for number in self.kind.iter() {
            let verdict = &mut self.verdicts[number];
            let passes = self.passed.contains(number);
            verdict.truth = if passes { Truth::Yes } else { of_others(number, verdict.truth) };
        }
    }

    /// Probabilities that a thing matches, as believed and for the ranking. With a pick only those that it takes, or may
    /// take, can match.
    pub(crate) fn probabilities(&self, number: usize) -> [f64; 2] {
        let verdict = &self.verdicts[number];
        let is_left = self.passed.contains(number) || verdict.truth != Truth::No;
        if self.pattern.pick.is_some() && !is_left {
            return [0.0; 2];
        }
        [verdict.probability, verdict.ranking]
    }
}

/// Which things may be a partner.
pub(crate) enum Partner<'q> {
    /// The robot; not if anything is asked of it.
    Robot(bool),
    /// Things that match a pattern; with their probabilities where these are wanted.
    Things {
        passed: BitSet,
        /// Those of which it is not known.
        undecided: BitSet,
        /// There may be more of them than the graph holds.
        may_be_unseen: bool,
        evaluated: Option<Box<Evaluated<'q>>>,
    },
}

impl Partner<'_> {
    pub(crate) fn passed(&self, number: usize) -> bool {
        matches!(self, Self::Things { passed, .. } if passed.contains(number))
    }

    /// Whether there may be more of them than the graph holds.
    pub(crate) fn may_be_unseen(&self) -> bool {
        matches!(self, Self::Things { may_be_unseen: true, .. })
    }

    pub(crate) fn truth(&self, number: usize) -> Truth {
        match self {
            Self::Things { undecided, .. } if undecided.contains(number) => Truth::Unknown,
            _ => Truth::of(self.passed(number)),
        }
    }

    /// Probabilities that it matches: as believed, and for the ranking.
    pub(crate) fn probabilities(&self, number: usize) -> [f64; 2] {
        match self {
            Self::Things { evaluated: Some(evaluated), .. } => evaluated.probabilities(number),
            _ => [certainty(self.passed(number)); 2],
        }
    }
}

/// The relations asked of one pair, sorted by where the graph has them.
pub(crate) struct Kinds<'q> {
    pub(crate) asked: &'q [RelationKind],
    /// Where the partner is from the subject, and how far they are apart: of one edge.
    pub(crate) outward: Vec<Place>,
    /// Where the subject is from the partner: of one edge.
    pub(crate) inward: Vec<Place>,
    pub(crate) beside: Vec<Place>,
    pub(crate) words: Vec<PairWord>,
    pub(crate) labels: Vec<&'q str>,
    pub(crate) with: bool,
    pub(crate) between: Vec<Partner<'q>>,
}

/// Whether something holds of a pair, and how probable that is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Link {
    pub(crate) truth: Truth,
    pub(crate) probability: f64,
}

impl Link {
    pub(crate) const SURE: Self = Self { truth: Truth::Yes, probability: 1.0 };
    pub(crate) const NONE: Self = Self { truth: Truth::No, probability: 0.0 };
    pub(crate) const UNKNOWN: Self = Self { truth: Truth::Unknown, probability: 0.0 };

    /// Something that holds or not, for sure, unless it is unknown.
    pub(crate) fn certain(truth: Truth) -> Self {
        Self { truth, probability: certainty(truth.holds()) }
    }

    pub(crate) fn and(self, other: Self) -> Self {
        let probability = self.probability * other.probability;
        Self { truth: self.truth.min(other.truth), probability }
    }

    /// Whether it is the better one of two.
    pub(crate) fn beats(self, other: Self) -> bool {
        (self.truth, self.probability) > (other.truth, other.probability)
    }
}

impl<'q> Kinds<'q> {
    /// Sorts the kinds; `resolve` finds the other end of "between".
    pub(crate) fn new(
        asked: &'q [RelationKind],
        resolve: impl Fn(&'q Pattern) -> Partner<'q>,
    ) -> Self {
        let (outward, inward, beside) = (Vec::new(), Vec::new(), Vec::new());
        let (words, labels, between) = (Vec::new(), Vec::new(), Vec::new());
        let with = false;
        let mut kinds = Self { asked, outward, inward, beside, words, labels, with, between };
        for kind in asked {
            match kind {
                RelationKind::Placed { place, viewpoint } => match viewpoint {
                    Viewpoint::Partner => kinds.inward.push(*place),
                    Viewpoint::Robot if !is_distance(place) => kinds.beside.push(*place),
                    Viewpoint::Subject | Viewpoint::Robot => kinds.outward.push(*place),
                },
                RelationKind::Pair(word) => kinds.words.push(*word),
                RelationKind::Interaction(label) => kinds.labels.push(label),
                RelationKind::With => kinds.with = true,
                RelationKind::Between(pattern) => kinds.between.push(resolve(pattern)),
            }
        }
        kinds
    }

    /// Whether the relations are all on edges of the subject, so that only its neighbours can be partners.
    pub(crate) fn is_local(&self) -> bool {
        self.beside.is_empty() && self.between.is_empty()
    }

    pub(crate) fn between(&self) -> &[Partner<'q>] {
        &self.between
    }

    pub(crate) fn words(&self) -> &[PairWord] {
        &self.words
    }

    pub(crate) fn has_labels(&self) -> bool {
        !self.labels.is_empty()
    }

    pub(crate) fn is_with(&self) -> bool {
        self.with
    }

    /// Places with whether the subject is the one who looks.
    pub(crate) fn places(&self) -> impl Iterator<Item = (&Place, bool)> {
        let outward = self.outward.iter().map(|place| (place, true));
        outward.chain(self.inward.iter().chain(&self.beside).map(|place| (place, false)))
    }
}

/// A comparison, made ready: the measure of everything, and the things compared with.
pub(crate) struct Comparison {
    pub(crate) measures: Vec<Option<f64>>,
    pub(crate) than: BitSet,
    /// Those of which it is not known whether they are compared with.
    pub(crate) perhaps: BitSet,
    /// There may be more of those compared with than the graph holds.
    pub(crate) may_be_unseen: bool,
    /// What cannot be measured does not count.
    pub(crate) is_closed: bool,
    pub(crate) order: Order,
}

impl Comparison {
    /// The one of the others that is hardest to beat.
    pub(crate) fn hardest(&self, number: usize) -> Option<(usize, f64)> {
        let others = self.than.iter().filter(|&other| other != number);
        let known = others.filter_map(|other| Some((other, self.measures[other]?)));
        known.reduce(|hardest, next| {
            let is_harder = match self.order {
                Order::Least => next.1 < hardest.1,
                Order::Most => next.1 > hardest.1,
            };
            if is_harder { next } else { hardest }
        })
    }

    /// It must beat all of the others. What cannot be measured, or may be one of them, leaves that open unless
    /// another beats it.
    pub(crate) fn truth(&self, number: usize) -> Truth {
        let Some(mine) = self.measures[number] else { return Truth::Unknown };
        let beats = |theirs: f64| match self.order {
            Order::Least => mine < theirs,
            Order::Most => mine > theirs,
        };
        let Some((other, hardest)) = self.hardest(number) else { return Truth::Unknown };
        if !beats(hardest) {
            return if self.perhaps.contains(other) { Truth::Unknown } else { Truth::No };
        }
        let is_unmeasured = |other: usize| other != number && self.measures[other].is_none();
        if self.is_closed {
            return Truth::Yes;
        }
        let is_open = self.may_be_unseen
            || self.than.iter().any(is_unmeasured)
            || self.perhaps.iter().any(|other| {
                other != number && self.measures[other].is_none_or(|theirs| !beats(theirs))
            });
        if is_open { Truth::Unknown } else { Truth::Yes }
    }
}
