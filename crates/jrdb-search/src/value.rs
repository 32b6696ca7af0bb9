//! What checking one condition on one thing comes to.

use jrdb_types::Quantity;
use jrdb_types::query::Interval;

/// Three-valued: of the unknown nothing holds, and neither does its contrary.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub(crate) enum Truth {
    No,
    #[default]
    Unknown,
    Yes,
}

impl Truth {
    pub(crate) fn of(holds: bool) -> Self {
        if holds { Self::Yes } else { Self::No }
    }

    /// Of something that may not be known.
    pub(crate) fn of_known(holds: Option<bool>) -> Self {
        holds.map_or(Self::Unknown, Self::of)
    }

    pub(crate) fn holds(self) -> bool {
        self == Self::Yes
    }

    /// Whether as many as asked are so, where this many surely are and so many more perhaps.
    pub(crate) fn of_count(asked: Quantity, sure: usize, perhaps: usize) -> Self {
        let most = sure.saturating_add(perhaps);
        let [least_asked, most_asked] =
            [Some(asked.at_least), asked.at_most].map(|bound| bound.map(|bound| bound as usize));
        let is_enough = least_asked.is_none_or(|least| sure >= least);
        if is_enough && most_asked.is_none_or(|limit| most <= limit) {
            return Self::Yes;
        }
        let too_few = least_asked.is_some_and(|least| most < least);
        let too_many = most_asked.is_some_and(|limit| sure > limit);
        if too_few || too_many { Self::No } else { Self::Unknown }
    }

    /// The contrary.
    pub(crate) fn negated(self) -> Self {
        match self {
            Self::No => Self::Yes,
            Self::Unknown => Self::Unknown,
            Self::Yes => Self::No,
        }
    }
}

/// Whether a measure lies within bounds.
pub(crate) fn within_truth(measure: Option<f64>, within: &Interval) -> Truth {
    Truth::of_known(measure.map(|measure| within.contains(measure)))
}

/// A number of things that has no bound: of a kind that perception does not see there may be any number.
pub(crate) const UNBOUNDED: usize = usize::MAX;

/// Number that nothing has.
pub(crate) const NOBODY: u32 = u32::MAX;

/// One condition on one thing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Value {
    pub(crate) truth: Truth,
    /// Probability that it holds, as believed.
    pub(crate) probability: f64,
    /// The same for the ranking, where ages are smoothed.
    pub(crate) ranking: f64,
    /// How many conditions hold in it; a relation counts its partner's too.
    pub(crate) satisfied: u32,
    /// Whether a belief that is neither 0 nor 1 has a part in it.
    pub(crate) uncertain: bool,
    /// The best partner of a relation.
    pub(crate) witness: u32,
}

impl Value {
    /// Nothing is known, and nothing probable.
    pub(crate) const UNKNOWN: Self = Self {
        truth: Truth::Unknown,
        probability: 0.0,
        ranking: 0.0,
        satisfied: 0,
        uncertain: false,
        witness: NOBODY,
    };

    /// Words that were not understood: it is as probable that they hold as that they do not.
    pub(crate) const NOT_UNDERSTOOD: Self =
        Self { probability: 0.5, ranking: 0.5, ..Self::UNKNOWN };

    /// Something of one truth and one probability.
    pub(crate) fn new(truth: Truth, probability: f64) -> Self {
        let satisfied = u32::from(truth.holds());
        Self { truth, probability, ranking: probability, satisfied, ..Self::UNKNOWN }
    }

    /// Something that holds or not, for sure, unless it is unknown.
    pub(crate) fn certain(truth: Truth) -> Self {
        Self::new(truth, if truth.holds() { 1.0 } else { 0.0 })
    }

    /// The contrary. Of what is unknown and not at all probable the contrary is not probable either.
    pub(crate) fn negated(self) -> Self {
        let truth = self.truth.negated();
        let unknown = self.truth == Truth::Unknown;
        let other = |p: f64| if unknown && p == 0.0 { 0.0 } else { 1.0 - p };
        Self {
            truth,
            probability: other(self.probability),
            ranking: other(self.ranking),
            satisfied: u32::from(truth.holds()),
            ..self
        }
    }

    /// All of several, taken as independent.
    pub(crate) fn all(parts: impl Iterator<Item = Self>) -> Self {
        let start = Self { truth: Truth::Yes, probability: 1.0, ranking: 1.0, ..Self::UNKNOWN };
        let all = parts.fold(start, |all, part| Self {
            truth: all.truth.min(part.truth),
            probability: all.probability * part.probability,
            ranking: all.ranking * part.ranking,
            uncertain: all.uncertain || part.uncertain,
            ..all
        });
        Self { satisfied: u32::from(all.truth.holds()), ..all }
    }

    /// At least one of several, taken as independent.
    pub(crate) fn any(parts: impl Iterator<Item = Self>) -> Self {
        let start = Self { truth: Truth::No, ..Self::UNKNOWN };
        let either = |p: f64, q: f64| p + q - p * q;
        let any = parts.fold(start, |any, part| Self {
            truth: any.truth.max(part.truth),
            probability: either(any.probability, part.probability),
            ranking: either(any.ranking, part.ranking),
            uncertain: any.uncertain || part.uncertain,
            ..any
        });
        Self { satisfied: u32::from(any.truth.holds()), ..any }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_unknown_stays_unknown_under_not() {
        let unknown = Value::new(Truth::Unknown, 0.2).negated();
        assert_eq!((unknown.truth, unknown.probability), (Truth::Unknown, 0.8));
        assert_eq!(Value::UNKNOWN.negated().probability, 0.0);
        assert_eq!(Value::certain(Truth::No).negated(), Value::certain(Truth::Yes));
    }

    #[test]
    fn a_count_is_settled_when_every_number_between_its_bounds_gives_one_truth() {
        let truth = |asked, sure, perhaps| Truth::of_count(asked, sure, perhaps);
        assert_eq!(truth(Quantity::SOME, 0, 3), Truth::Unknown);
        assert_eq!(truth(Quantity::SOME, 1, UNBOUNDED), Truth::Yes);
        assert_eq!(truth(Quantity::NONE, 0, 1), Truth::Unknown);
        assert_eq!(truth(Quantity::NONE, 1, UNBOUNDED), Truth::No);
        assert_eq!(truth(Quantity::exactly(2), 1, 0), Truth::No);
        assert_eq!(truth(Quantity::exactly(2), 1, 2), Truth::Unknown);
        assert_eq!(truth(Quantity::at_least(4), 1, 2), Truth::No);
    }

    #[test]
    fn nothing_is_all_of_nothing_and_none_is_any_of_nothing() {
        assert_eq!(Value::all(std::iter::empty()).truth, Truth::Yes);
        assert_eq!(Value::any(std::iter::empty()).truth, Truth::No);
    }

    #[test]
    fn alternatives_of_one_attribute_add_to_at_most_one() {
        let half = Value::new(Truth::No, 0.5);
        let any = Value::any([half, half, Value::UNKNOWN].into_iter());
        assert_eq!((any.truth, any.probability), (Truth::Unknown, 0.75));
    }
}
