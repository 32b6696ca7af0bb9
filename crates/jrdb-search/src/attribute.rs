//! What is believed of a thing, against what is asked.

use jrdb_types::answer::{Finding, Measured, Unit};
use jrdb_types::{Attribute, AttributeBelief, AttributeValue, Attributes};

use crate::place::{interval, measured};
use crate::value::{Truth, Value};

/// The value of an attribute condition.
///
/// It holds when the asked value is the most probable one; of an unknown attribute every value is equally probable and none
/// holds. Of ordered attributes a neighbouring value counts in the ranking.
pub(crate) fn value(asked: AttributeValue, known: Option<&Attributes>, neighbor: f64) -> Value {
    let row = asked.attribute().row();
    let belief = known.map(|known| known.belief(asked.attribute()));
    let Some(belief) = belief.filter(|belief| !belief.is_unknown()) else {
        return Value::new(Truth::Unknown, 1.0 / row.words.len() as f64);
    };
    let probability = belief.probability(asked).clamp(0.0, 1.0);
    let uncertain = belief.entries().iter().any(|&(_, p)| p > 0.0 && p < 1.0);
    let truth = Truth::of(belief.best() == Some(asked));
    let value = Value { uncertain, ..Value::new(truth, probability) };
    if !row.ordered {
        return value;
    }
    Value { ranking: value.ranking.max(smoothed(belief, asked, neighbor)), ..value }
}

/// `max_b p(b) ε^|a - b|`: what another value of an ordered attribute counts for this one.
fn smoothed(belief: AttributeBelief<'_>, asked: AttributeValue, neighbor: f64) -> f64 {
    let steps = |value: AttributeValue| value.index().abs_diff(asked.index()) as i32;
    let each = belief.entries().iter().map(|&(value, p)| p * neighbor.powi(steps(value)));
    each.fold(0.0, f64::max)
}

/// The most probable value of an attribute, with its probability.
pub(crate) fn finding(known: &Attributes, attribute: Attribute) -> Option<Finding> {
    let belief = known.belief(attribute);
    let value = belief.best()?;
    Some(Finding::Attribute { value, probability: belief.probability(value) })
}

/// The asked value's probability and where it draws level with its strongest rival, if the two trade probability.
pub(crate) fn balance(known: &Attributes, asked: AttributeValue) -> Option<Measured> {
    let belief = known.belief(asked.attribute());
    let rival = belief.rival(asked).map_or(0.0, |(_, p)| p);
    let mine = belief.probability(asked);
    let level = f64::midpoint(mine, rival);
    (!belief.is_unknown())
        .then(|| measured(mine, Unit::Probability, interval(level, f64::INFINITY)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use jrdb_types::{Age, Belief};

    #[test]
    fn a_neighbouring_age_counts_in_the_ranking_only() {
        let young = AttributeValue::from(Age::Young);
        let certain = |age: Age| Attributes::certain([age.into()]);
        let [near, far] =
            [Age::Adolescent, Age::Elderly].map(|age| value(young, Some(&certain(age)), 0.1));
        assert_eq!((near.truth, near.probability), (Truth::No, 0.0));
        assert!(near.ranking > far.ranking && far.ranking > 0.0);
        let sure = value(young, Some(&certain(Age::Young)), 0.1);
        assert_eq!((sure.ranking, sure.uncertain), (1.0, false));
    }

    #[test]
    fn probability_traded_with_the_rival_is_level_half_way() {
        let belief = Belief([(Age::Child, 0.6), (Age::Young, 0.3)].into());
        let known = Attributes::default().with_age(belief);
        let found = balance(&known, Age::Child.into()).unwrap();
        assert!((found.margin - 0.15).abs() < 1e-12);
        let found = balance(&known, Age::Young.into()).unwrap();
        assert!((found.margin + 0.15).abs() < 1e-12);
        assert_eq!(balance(&Attributes::default(), Age::Young.into()), None);
    }
}
