//! Who matches and who does not, by Kleene's three-valued logic on sets of bits.

use std::borrow::Cow;

use jrdb_graph::BitSet;
use jrdb_types::query::Category;
use jrdb_types::{Condition, Pattern, Related};

use crate::World;
use crate::evaluation::Partner;
use crate::searcher::Searcher;
use crate::value::Truth;
use crate::value::within_truth;

/// What is known of some things: for whom something holds and for whom it does not. Of all others it is unknown.
#[derive(Debug, Clone)]
pub(crate) struct Known {
    pub(crate) yes: BitSet,
    pub(crate) no: BitSet,
}

impl Known {
    /// Nothing is known.
    pub(crate) fn nothing(within: &BitSet) -> Self {
        Self { yes: BitSet::new(within.size()), no: BitSet::new(within.size()) }
    }

    /// Sorts the members of a set by a truth.
    pub(crate) fn split(within: &BitSet, mut truth: impl FnMut(usize) -> Truth) -> Self {
        let mut known = Self::nothing(within);
        for number in within.iter() {
            match truth(number) {
                Truth::Yes => known.yes.insert(number),
                Truth::No => known.no.insert(number),
                Truth::Unknown => {}
            }
        }
        known
    }

    /// All of several.
    pub(crate) fn all(parts: impl Iterator<Item = Self>, within: &BitSet) -> Self {
        let start = Self { yes: within.clone(), no: BitSet::new(within.size()) };
        parts.fold(start, |mut all, part| {
            all.yes.intersect(&part.yes);
            all.no.unite(&part.no);
            all
        })
    }

    pub(crate) fn negated(self) -> Self {
        Self { yes: self.no, no: self.yes }
    }

    pub(crate) fn within(mut self, set: &BitSet) -> Self {
        self.yes.intersect(set);
        self.no.intersect(set);
        self
    }

    /// Those of a set for whom it holds or is unknown.
    pub(crate) fn possible(&self, within: &BitSet) -> BitSet {
        let mut possible = within.clone();
        possible.subtract(&self.no);
        possible
    }
}

impl Searcher<'_, '_> {
    /// For whom of `within` a condition holds, and for whom it does not.
    pub(crate) fn known(&self, condition: &Condition, within: &BitSet) -> Known {
        if let Some((yes, known)) = self.column(condition) {
            return self.known_in_column(condition, within, [yes, known]);
        }
        let split = |truth: &dyn Fn(usize) -> Truth| Known::split(within, truth);
        match condition {
            Condition::FromRobot(place) => split(&|n| self.place_truth(n, place)),
            Condition::GroupSize(quantity) => split(&|n| self.group_truth(n, *quantity)),
            Condition::Related(related) => self.known_related(related, within),
            Condition::Compared(compared) => {
                let comparison = self.comparison(compared);
                split(&|n| comparison.truth(n))
            }
            Condition::Measures(measured) => {
                let measures = self.measures(&measured.measure);
                split(&|n| within_truth(measures[n], &measured.within))
            }
            Condition::Nearer(nearer) => {
                let truths = self.nearer(nearer);
                split(&|n| truths[n])
            }
            Condition::Looks(phrase) => split(&|n| self.looks(n, &phrase.words).truth),
            Condition::Id(id) => split(&|n| self.id_truth(n, *id)),
            Condition::Is(pattern) => self.known_matching(pattern).within(within),
            Condition::Not(inner) => self.known(inner, within).negated(),
            Condition::Any(parts) => {
                let parts = self.alternatives(parts);
                let contrary = parts.iter().map(|part| self.known(part, within).negated());
                Known::all(contrary, within).negated()
            }
            Condition::All(parts) => {
                Known::all(parts.iter().map(|part| self.known(part, within)), within)
            }
            // The columns have the attributes.
            Condition::Phrase(_) | Condition::Attribute(_) => Known::nothing(within),
        }
    }

    fn known_in_column(
        &self,
        condition: &Condition,
        within: &BitSet,
        [yes, known]: [&BitSet; 2],
    ) -> Known {
        let (mut holds, mut fails) = (within.clone(), within.clone());
        holds.intersect(yes);
        fails.intersect(known);
        fails.subtract(yes);
        if self.has_blind_places() && matches!(condition, Condition::FromRobot(_)) {
            fails = BitSet::new(within.size());
        }
        Known { yes: holds, no: fails }
    }

    /// Who matches a pattern, its pick included, and who does not: strictly under `strict`, else by the paper's two
    /// phases. Of kinds that perception does not see, the graph need not hold everything: see
    /// [`Searcher::may_be_unseen`].
    pub(crate) fn known_matching(&self, pattern: &Pattern) -> Known {
        let kind = self.kind(&pattern.category).into_owned();
        let attributes = pattern.conditions.iter().filter(|c| !c.is_relation());
        let attributes = self.known_attributes(attributes, &kind);
        let mut yes = self.enough_of(&kind, attributes.iter(), |known| Cow::Borrowed(&known.yes));
        let possible = |known: &Known| Cow::Owned(known.possible(&kind));
        let mut maybe = self.enough_of(&kind, attributes.iter(), possible);
        for relation in pattern.conditions.iter().filter(|c| c.is_relation()) {
            let known = self.known(relation, &maybe);
            yes.intersect(&known.yes);
            maybe.subtract(&known.no);
        }
        if let Some(pick) = &pattern.pick {
            let picked = match self.config.world {
                World::Open => self.picked(&yes, &maybe, pick, self.may_be_unseen(pattern)),
                World::Closed => self.picked_from(&yes, pick),
            };
            (yes, maybe) = (picked.yes.clone(), picked.possible(&maybe));
        }
        let mut no = BitSet::below(kind.size(), kind.size());
        no.subtract(&maybe);
        Known { yes, no }
    }

    /// What is known of some attributes; how things look is asked last, about those that may match.
    fn known_attributes<'q>(
        &self,
        attributes: impl Iterator<Item = &'q Condition>,
        kind: &BitSet,
    ) -> Vec<Known> {
        let (asked, plain): (Vec<&Condition>, Vec<&Condition>) =
            attributes.partition(|condition| condition.asks_looks());
        let mut known: Vec<Known> = plain.iter().map(|c| self.known(c, kind)).collect();
        let mut open = kind.clone();
        known.iter().for_each(|known| open.subtract(&known.no));
        known.extend(asked.iter().map(|c| self.known(c, &open)));
        known
    }

    pub(crate) fn known_related(&self, related: &Related, within: &BitSet) -> Known {
        self.by_relation(related, within, |pattern| self.known_partner(pattern))
    }

    /// The partners that match, and those of which it is not known.
    pub(crate) fn known_partner<'q>(&self, pattern: &'q Pattern) -> Partner<'q> {
        if pattern.category == Category::Robot {
            return Partner::Robot(pattern.conditions.is_empty());
        }
        let Known { yes: passed, no } = self.known_matching(pattern);
        let mut undecided = BitSet::below(passed.size(), passed.size());
        undecided.subtract(&no);
        undecided.subtract(&passed);
        let may_be_unseen = self.may_be_unseen(pattern);
        Partner::Things { passed, undecided, may_be_unseen, evaluated: None }
    }
}
