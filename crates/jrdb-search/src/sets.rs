//! Who matches, by sets of bits alone: no words, no probabilities, nothing allocated per candidate.

use std::borrow::Cow;

use jrdb_graph::BitSet;
use jrdb_types::query::{Category, Place, RelationKind, Viewpoint};
use jrdb_types::vocab::MatchPolicy;
use jrdb_types::{Condition, Direction, DistanceWord, Pattern, Quantity, Related};

use smallvec::SmallVec;

use crate::World;
use crate::evaluation::{Kinds, Link, Partner};
use crate::known::Known;
use crate::place;
use crate::searcher::Searcher;
use crate::value::Truth;
use crate::value::within_truth;

/// Numbers that fit into a majority's counter; more conditions than a question can have.
const COUNTER_BITS: usize = 32;

/// The same for the conditions of most questions, up to seven.
const SMALL_COUNTER_BITS: usize = 3;

/// Who has each of some attributes.
type Sets<'s> = SmallVec<[Cow<'s, BitSet>; 4]>;

impl<'i> Searcher<'i, '_> {
    /// Those that surely match a pattern, its pick included.
    pub(crate) fn surely_matching(&self, pattern: &Pattern) -> BitSet {
        match (&pattern.pick, self.config.world) {
            (Some(_), World::Open) => self.known_matching(pattern).yes,
            _ => self.matches(pattern),
        }
    }

    /// Those that match a pattern: strictly under `strict`, else by the paper's two phases. A pick is made from those
    /// that surely match.
    pub(crate) fn matches(&self, pattern: &Pattern) -> BitSet {
        let found = self.unpicked(pattern);
        match &pattern.pick {
            None => found,
            Some(pick) => self.pick(&found, pick),
        }
    }

    fn unpicked(&self, pattern: &Pattern) -> BitSet {
        let mut found = self.enough(pattern);
        for relation in pattern.conditions.iter().filter(|c| c.is_relation()) {
            if found.is_empty() {
                break;
            }
            found = self.narrowed(found, relation);
        }
        found
    }

    /// Those of a set for which a condition holds.
    fn narrowed(&self, mut found: BitSet, condition: &Condition) -> BitSet {
        match condition {
            Condition::Related(related) if self.see_one(related, &mut found) => found,
            _ => self.yes(condition, &found).into_owned(),
        }
    }

    /// Those of a pattern's kind that have all of its attributes, or more than half.
    fn enough(&self, pattern: &Pattern) -> BitSet {
        let kind = self.kind(&pattern.category);
        let attributes = pattern.conditions.iter().filter(|c| !c.is_relation());
        if pattern.conditions.iter().any(Condition::asks_looks) {
            return self.known_matching(pattern).yes;
        }
        self.enough_of(&kind, attributes, |condition| self.yes(condition, &kind))
    }

    /// Those of a kind that have all of some attributes, or more than half; a function tells who has one.
    pub(crate) fn enough_of<'s, T>(
        &self,
        kind: &BitSet,
        attributes: impl Iterator<Item = T> + Clone,
        having: impl Fn(T) -> Cow<'s, BitSet>,
    ) -> BitSet {
        let mut found = kind.clone();
        // More than half of two are all.
        if self.config.policy == MatchPolicy::Strict || attributes.clone().nth(2).is_none() {
            attributes.for_each(|attribute| found.intersect(&having(attribute)));
        } else {
            let sets: Sets<'_> = attributes.map(having).collect();
            more_than_half(&mut found, &sets);
        }
        found
    }

    /// Those of `within` for which a condition holds; others may be in the set or not where a condition is an attribute.
    #[inline]
    fn yes(&self, condition: &Condition, within: &BitSet) -> Cow<'i, BitSet> {
        match self.column(condition) {
            Some((yes, _)) => Cow::Borrowed(yes),
            None => Cow::Owned(self.looked_up(condition, within)),
        }
    }

    /// The same for what is in no column of the index.
    fn looked_up(&self, condition: &Condition, within: &BitSet) -> BitSet {
        let truth = |truth: &dyn Fn(usize) -> Truth| retained(within, |n| truth(n).holds());
        match condition {
            Condition::FromRobot(place) => truth(&|n| self.place_truth(n, place)),
            Condition::GroupSize(quantity) => truth(&|n| self.group_truth(n, *quantity)),
            Condition::Related(related) => self.related(related, within),
            Condition::Compared(compared) => {
                let comparison = self.comparison(compared);
                truth(&|n| comparison.truth(n))
            }
            Condition::Measures(measured) => {
                let measures = self.measures(&measured.measure);
                truth(&|n| within_truth(measures[n], &measured.within))
            }
            Condition::Nearer(nearer) => {
                let truths = self.nearer(nearer);
                truth(&|n| truths[n])
            }
            Condition::Looks(phrase) => truth(&|n| self.looks(n, &phrase.words).truth),
            Condition::Id(id) => truth(&|n| self.id_truth(n, *id)),
            Condition::Is(pattern) => {
                let mut those = self.surely_matching(pattern);
                those.intersect(within);
                those
            }
            Condition::Not(inner) => self.known(inner, within).no,
            Condition::Any(parts) => {
                let mut any = BitSet::new(within.size());
                parts.iter().for_each(|part| any.unite(&self.yes(part, within)));
                any.intersect(within);
                any
            }
            Condition::All(parts) => {
                let mut all = within.clone();
                parts.iter().for_each(|part| all.intersect(&self.yes(part, within)));
                all
            }
            // The columns have the attributes.
            Condition::Phrase(_) | Condition::Attribute(_) => BitSet::new(within.size()),
        }
    }

    /// The sets that the index has ready: who has the value, and of whom it is known.
    #[inline]
    pub(crate) fn column(&self, condition: &Condition) -> Option<(&'i BitSet, &'i BitSet)> {
        let columns = self.index.columns();
        match condition {
            Condition::Attribute(value) => Some(columns.attribute(*value)),
            Condition::FromRobot(Place::Distance(value)) => Some(columns.distance(*value)),
            Condition::FromRobot(Place::Direction(value)) => Some(columns.direction(*value)),
            _ => None,
        }
    }

    /// Where a thing is for the robot.
    pub(crate) fn place_truth(&self, number: usize, asked: &Place) -> Truth {
        let found = self.index.node(number).and_then(|node| self.seen_by_robot(node));
        found.map_or(Truth::Unknown, |found| self.of_place(place::truth(asked, &found)))
    }

    /// Whether a thing has a number.
    pub(crate) fn id_truth(&self, number: usize, asked: u32) -> Truth {
        Truth::of_known(self.index.id(number).map(|id| id.number == asked))
    }

    pub(crate) fn group_truth(&self, number: usize, asked: Quantity) -> Truth {
        Truth::of_known(self.group_size(number).map(|size| asked.holds(size as usize)))
    }

    fn related(&self, related: &Related, within: &BitSet) -> BitSet {
        let mut found = within.clone();
        if self.see_one(related, &mut found) {
            return found;
        }
        // More partners than those found for sure cannot undo that there are enough.
        if related.quantity.at_most.is_some() {
            return self.known_related(related, within).yes;
        }
        let partner = |pattern| self.sure_partner(pattern);
        self.by_relation(related, within, partner).yes
    }

    pub(crate) fn by_relation<'q>(
        &self,
        related: &'q Related,
        within: &BitSet,
        partner: impl Fn(&'q Pattern) -> Partner<'q>,
    ) -> Known {
        let kinds = Kinds::new(&related.kinds, &partner);
        let partner = partner(&related.partner);
        let mut scratch = Vec::new();
        Known::split(within, |subject| {
            let [sure, perhaps] = self.count_partners(subject, &kinds, &partner, &mut scratch);
            Truth::of_count(related.quantity, sure, perhaps)
        })
    }

    /// The partners that match for sure; nobody else is looked at.
    fn sure_partner<'q>(&self, pattern: &'q Pattern) -> Partner<'q> {
        if pattern.category == Category::Robot {
            return Partner::Robot(pattern.conditions.is_empty());
        }
        let passed = self.surely_matching(pattern);
        let undecided = BitSet::new(self.index.size());
        Partner::Things { passed, undecided, may_be_unseen: false, evaluated: None }
    }

    /// How many partners there surely are, and how many more perhaps.
    fn count_partners(
        &self,
        subject: usize,
        kinds: &Kinds<'_>,
        partner: &Partner<'_>,
        scratch: &mut Vec<u32>,
    ) -> [usize; 2] {
        if let Partner::Robot(is_free) = partner {
            let link = if *is_free { self.robot_link(subject, kinds) } else { Link::NONE };
            return [Truth::Yes, Truth::Unknown].map(|truth| usize::from(link.truth == truth));
        }
        self.possible_partners(subject, kinds, scratch);
        let mut counts = [0, self.unseen_partners(subject, kinds, partner, scratch)];
        for other in scratch.iter().map(|&other| other as usize) {
            let own = partner.truth(other);
            if own == Truth::No {
                continue;
            }
            match own.min(self.link(subject, other, kinds).truth) {
                Truth::Yes => counts[0] += 1,
                Truth::Unknown => counts[1] = counts[1].saturating_add(1),
                Truth::No => {}
            }
        }
        counts
    }

    /// Keeps those of whom "has such a one in a direction (at a distance)" or "is in a direction of such a one" holds, found in the
    /// index's runs; false, and nothing done, for other relations.
    fn see_one(&self, related: &Related, found: &mut BitSet) -> bool {
        let is_plain =
            related.quantity == Quantity::SOME && related.partner.category != Category::Robot;
        let edge = one_edge(&related.kinds).filter(|_| is_plain);
        let Some((direction, distance, viewpoint)) = edge else { return false };
        let passed = self.surely_matching(&related.partner);
        let sees = |number| self.index.seen(number, direction, distance);
        if viewpoint == Viewpoint::Subject {
            found
                .retain(|number| sees(number).iter().any(|&other| passed.contains(other as usize)));
            return true;
        }
        let mut seen = BitSet::new(found.size());
        for partner in passed.iter() {
            sees(partner).iter().for_each(|&subject| seen.insert(subject as usize));
        }
        found.intersect(&seen);
        true
    }
}

/// A direction in words, and a distance in words where one is asked, all seen from one side.
fn one_edge(kinds: &[RelationKind]) -> Option<(Direction, Option<DistanceWord>, Viewpoint)> {
    let (mut direction, mut distance, mut from) = (None, None, None);
    for kind in kinds {
        let RelationKind::Placed { place, viewpoint } = kind else { return None };
        if *viewpoint == Viewpoint::Robot || from.is_some_and(|from| from != *viewpoint) {
            return None;
        }
        from = Some(*viewpoint);
        match place {
            Place::Direction(word) if direction.is_none() => direction = Some(*word),
            Place::Distance(word) if distance.is_none() => distance = Some(*word),
            _ => return None,
        }
    }
    Some((direction?, distance, from?))
}

fn retained(within: &BitSet, holds: impl FnMut(usize) -> bool) -> BitSet {
    let mut kept = within.clone();
    kept.retain(holds);
    kept
}

/// Keeps those that are in more than half of the sets.
fn more_than_half(found: &mut BitSet, sets: &[Cow<'_, BitSet>]) {
    match sets.len() >> SMALL_COUNTER_BITS {
        0 => keep_majority::<SMALL_COUNTER_BITS>(found, sets),
        _ => keep_majority::<COUNTER_BITS>(found, sets),
    }
}

/// The same with 64 counters at once, one bit of each in a word.
fn keep_majority<const BITS: usize>(found: &mut BitSet, sets: &[Cow<'_, BitSet>]) {
    let needed = sets.len() / 2 + 1;
    for (place, word) in found.words_mut().iter_mut().enumerate() {
        if *word == 0 {
            continue;
        }
        let mut counters = [0_u64; BITS];
        for set in sets {
            let mut carry = set.words()[place];
            for counter in &mut counters {
                (*counter, carry) = (*counter ^ carry, *counter & carry);
            }
        }
        *word &= at_least(&counters, needed);
    }
}

/// The counters that have reached a number.
fn at_least(counters: &[u64], number: usize) -> u64 {
    let (mut more, mut equal) = (0, u64::MAX);
    for (bit, &counter) in counters.iter().enumerate().rev() {
        if number >> bit & 1 == 1 {
            equal &= counter;
        } else {
            more |= equal & counter;
            equal &= !counter;
        }
    }
    more | equal
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counters_count_each_bit_on_its_own() {
        let sets: Vec<BitSet> = (0..5)
            .map(|set| {
                let mut members = BitSet::new(70);
                (set..70).for_each(|number| members.insert(number));
                members
            })
            .collect();
        for count in 3..=5 {
            let sets: Vec<Cow<'_, BitSet>> = sets[..count].iter().map(Cow::Borrowed).collect();
            let mut found = BitSet::below(70, 70);
            more_than_half(&mut found, &sets);
            // Number n is in n + 1 of the sets.
            let first = found.iter().next();
            assert_eq!((first, found.count()), (Some(count / 2), 70 - count / 2), "{count}");
        }
    }
}
