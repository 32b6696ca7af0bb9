//! What is believed of a thing, against what is asked.

use std::fmt::Display;

use jrdb_types::answer::{Measured, Unit};
use jrdb_types::vocab::Color;
use jrdb_types::{Action, Age, Attributes, Belief, Condition, Gender, Race};

use crate::place::{interval, measured};
use crate::value::{Truth, Value};
use crate::wording;

/// One attribute of one thing, with the asked value.
pub(crate) struct Asked {
    pub(crate) value: Value,
    pub(crate) found: Option<String>,
    pub(crate) measured: Option<Measured>,
}

/// The value of an attribute condition, without words; `None` when the condition is none.
pub(crate) fn value(
    condition: &Condition,
    known: Option<&Attributes>,
    age_neighbor: f64,
) -> Option<Value> {
    Some(match condition {
        Condition::Age(asked) => {
            let value = of_belief(known.map(|k| &k.age), *asked, Age::ALL.len());
            let ranking = known.map_or(value.ranking, |k| smoothed(&k.age, *asked, age_neighbor));
            Value { ranking: value.ranking.max(ranking), ..value }
        }
        Condition::Gender(asked) => of_belief(known.map(|k| &k.gender), *asked, Gender::ALL.len()),
        Condition::Race(asked) => of_belief(known.map(|k| &k.race), *asked, Race::ALL.len()),
        Condition::Action(asked) => of_belief(known.map(|k| &k.action), *asked, Action::ALL.len()),
        Condition::UpperColor(asked) => {
            of_belief(known.map(|k| &k.upper_color), *asked, Color::ALL.len())
        }
        Condition::LowerColor(asked) => {
            of_belief(known.map(|k| &k.lower_color), *asked, Color::ALL.len())
        }
        _ => return None,
    })
}

/// The same with what was found, for the trace.
pub(crate) fn told(
    condition: &Condition,
    known: Option<&Attributes>,
    age_neighbor: f64,
) -> Option<Asked> {
    let value = value(condition, known, age_neighbor)?;
    let (found, measured) = match (condition, known) {
        (Condition::Age(asked), Some(k)) => (wording::belief(&k.age), balance(&k.age, *asked)),
        (Condition::Gender(asked), Some(k)) => {
            (wording::belief(&k.gender), balance(&k.gender, *asked))
        }
        (Condition::Race(asked), Some(k)) => (wording::belief(&k.race), balance(&k.race, *asked)),
        (Condition::Action(asked), Some(k)) => {
            (wording::belief(&k.action), balance(&k.action, *asked))
        }
        (Condition::UpperColor(asked), Some(k)) => {
            (wording::belief(&k.upper_color), balance(&k.upper_color, *asked))
        }
        (Condition::LowerColor(asked), Some(k)) => {
            (wording::belief(&k.lower_color), balance(&k.lower_color, *asked))
        }
        _ => (None, None),
    };
    Some(Asked { value, found, measured })
}

/// An attribute holds when the asked value is the most probable one; of an unknown attribute every value
/// is equally probable and none holds.
fn of_belief<T: Ord + Copy>(belief: Option<&Belief<T>>, asked: T, values: usize) -> Value {
    match belief.filter(|belief| !belief.is_unknown()) {
        None => Value::new(Truth::Unknown, 1.0 / values as f64),
        Some(belief) => {
            let probability = belief.probability(asked).clamp(0.0, 1.0);
            let uncertain = belief.0.values().any(|&p| p > 0.0 && p < 1.0);
            let truth = Truth::of(belief.best() == Some(asked));
            Value { uncertain, ..Value::new(truth, probability) }
        }
    }
}

/// `max_b p(b) ε^|a - b|`: what another age group counts for this one.
fn smoothed(belief: &Belief<Age>, asked: Age, neighbor: f64) -> f64 {
    let steps = |age: Age| (age as i32 - asked as i32).abs();
    belief.0.iter().map(|(&age, p)| p * neighbor.powi(steps(age))).fold(0.0, f64::max)
}

/// The asked value's probability and where it draws level with its strongest rival, if the two trade probability.
pub(crate) fn balance<T: Ord + Copy + Display>(belief: &Belief<T>, asked: T) -> Option<Measured> {
    let rival = rival(belief, asked).map_or(0.0, |(_, p)| p);
    let mine = belief.probability(asked);
    let level = f64::midpoint(mine, rival);
    (!belief.is_unknown())
        .then(|| measured(mine, Unit::Probability, interval(level, f64::INFINITY)))
}

/// The most probable of the other values.
pub(crate) fn rival<T: Ord + Copy>(belief: &Belief<T>, asked: T) -> Option<(T, f64)> {
    let others =
        belief.0.iter().map(|(&value, &p)| (value, p)).filter(|(value, _)| *value != asked);
    others.reduce(|best, next| if next.1 > best.1 { next } else { best })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    fn aged(belief: Belief<Age>) -> Attributes {
        Attributes { age: belief, ..Attributes::default() }
    }

    #[test]
    fn a_neighbouring_age_counts_in_the_ranking_only() {
        let young = Condition::Age(Age::Young);
        let adolescent = aged(Belief::certain(Age::Adolescent));
        let elderly = aged(Belief::certain(Age::Elderly));
        let [near, far] = [adolescent, elderly].map(|a| value(&young, Some(&a), 0.1).unwrap());
        assert_eq!((near.truth, near.probability), (Truth::No, 0.0));
        assert!(near.ranking > far.ranking && far.ranking > 0.0);
        let sure = value(&young, Some(&aged(Belief::certain(Age::Young))), 0.1).unwrap();
        assert_eq!((sure.ranking, sure.uncertain), (1.0, false));
    }

    #[test]
    fn probability_traded_with_the_rival_is_level_half_way() {
        let belief = Belief(BTreeMap::from([(Age::Child, 0.6), (Age::Young, 0.3)]));
        let found = balance(&belief, Age::Child).unwrap();
        assert!((found.margin - 0.15).abs() < 1e-12);
        let found = balance(&belief, Age::Young).unwrap();
        assert!((found.margin + 0.15).abs() < 1e-12);
        assert_eq!(balance(&Belief::<Age>::default(), Age::Young), None);
    }
}
