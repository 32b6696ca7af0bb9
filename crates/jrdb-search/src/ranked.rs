//! The default policy: rank by probability, then choose how far down the ranking to go.

use jrdb_graph::BitSet;
use jrdb_types::Pattern;
use jrdb_types::query::Pick;
use jrdb_types::vocab::MatchPolicy;

use crate::evaluate::Evaluated;
use crate::measure::in_order;
use crate::probability::of_count;
use crate::searcher::Searcher;

/// Those that a pattern means, its pick included.
pub(crate) fn choice(searcher: &Searcher<'_, '_>, pattern: &Pattern) -> BitSet {
    let evaluated = searcher.evaluate(pattern);
    if pattern.pick.is_some() { evaluated.passed } else { unpicked_choice(searcher, &evaluated) }
}

/// Those that a pattern without its pick means, of those it was evaluated on.
///
/// Where no belief is uncertain and anything matches strictly: what does. Else the part of the ranking that promises most, and
/// where nothing is probable at all the paper's two phases and of these the ones that satisfy most conditions.
pub(crate) fn unpicked_choice(searcher: &Searcher<'_, '_>, evaluated: &Evaluated<'_>) -> BitSet {
    let pattern = Pattern { pick: None, ..evaluated.pattern.clone() };
    let mut strict = searcher.with(MatchPolicy::Strict).matches(&pattern);
    strict.intersect(&evaluated.kind);
    let is_uncertain = evaluated.kind.iter().any(|number| evaluated.verdicts[number].uncertain);
    if !is_uncertain && !strict.is_empty() {
        return strict;
    }
    let promising: Vec<(f64, usize)> = evaluated
        .kind
        .iter()
        .map(|number| {
            let score = searcher.index.node(number).map_or(1.0, |node| node.score);
            (score * evaluated.verdicts[number].probability, number)
        })
        .collect();
    let mut chosen = BitSet::new(searcher.index.size());
    best_expected_f1(promising).into_iter().for_each(|number| chosen.insert(number));
    if chosen.is_empty() { best_tier(evaluated) } else { chosen }
}

/// The most probable ones, so many that the expected F1 is greatest; none where all are impossible.
///
/// With the first k of a ranking selected, the expected F1 is about `2 Σ_{i≤k} p_i / (k + Σ p)`: twice the expected number of hits over
/// the number selected plus the expected number there is.
pub(crate) fn best_expected_f1<T: Ord + Copy>(mut probabilities: Vec<(f64, T)>) -> Vec<T> {
    probabilities.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let all: f64 = probabilities.iter().map(|(p, _)| p).sum();
    let (mut hits, mut best, mut best_length) = (0.0, 0.0, 0);
    for ((p, _), length) in probabilities.iter().zip(1..) {
        hits += p;
        let f1 = 2.0 * hits / (length as f64 + all);
        if f1 > best {
            (best, best_length) = (f1, length);
        }
    }
    probabilities.truncate(best_length);
    probabilities.into_iter().map(|(_, thing)| thing).collect()
}

/// Of those that pass the two phases, the ones that satisfy most conditions.
fn best_tier(evaluated: &Evaluated<'_>) -> BitSet {
    let passed = || evaluated.kind.iter().filter(|&n| evaluated.verdicts[n].passed());
    let most = passed().map(|number| evaluated.verdicts[number].satisfied).max();
    let mut tier = BitSet::new(evaluated.kind.size());
    passed()
        .filter(|&number| Some(evaluated.verdicts[number].satisfied) == most)
        .for_each(|number| tier.insert(number));
    tier
}

/// How probably a pick takes each of some things: that it matches, and that of those before it as many match as must.
pub(crate) fn picked_probabilities(
    searcher: &Searcher<'_, '_>,
    evaluated: &Evaluated<'_>,
    pick: &Pick,
) -> Vec<f64> {
    let measures = searcher.measures(&pick.measure);
    let order = in_order(&evaluated.kind, &measures, pick.order);
    let first = pick.rank.saturating_sub(1);
    let mut probabilities = vec![0.0; searcher.index.size()];
    if pick.count == 0 {
        return probabilities;
    }
    let last = first.saturating_add(pick.count - 1);
    for (place, &number) in order.iter().enumerate() {
        let ahead = order[..place].iter().map(|&other| evaluated.verdicts[other].ranking);
        let in_turn = of_count(ahead, first, Some(last));
        probabilities[number] = evaluated.verdicts[number].ranking * in_turn;
    }
    probabilities
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chosen(probabilities: &[f64]) -> usize {
        best_expected_f1(probabilities.iter().copied().zip(0..).collect()).len()
    }

    #[test]
    fn the_certain_are_chosen_and_the_hopeless_are_not() {
        assert_eq!(chosen(&[1.0, 1.0, 0.0]), 2);
        assert_eq!(chosen(&[0.0, 0.0]), 0);
        assert_eq!(chosen(&[]), 0);
    }

    #[test]
    fn one_guess_is_better_than_none_and_good_seconds_count() {
        assert_eq!(chosen(&[0.1]), 1);
        assert_eq!(chosen(&[0.9, 0.8, 0.05]), 2);
        assert_eq!(chosen(&[0.5, 0.5, 0.5]), 3);
    }
}
