//! The default policy: rank by probability, then choose how far down the ranking to go.

use jrdb_graph::BitSet;
use jrdb_types::Pattern;
use jrdb_types::query::Pick;
use jrdb_types::vocab::MatchPolicy;

use crate::evaluation::Evaluated;
use crate::measure::in_order;
use crate::probability::of_count;
use crate::searcher::Searcher;

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
    let mut chosen = BitSet::new(searcher.index.size());
    best_expected_f1(promising(searcher, evaluated))
        .into_iter()
        .for_each(|number| chosen.insert(number));
    if chosen.is_empty() { best_tier(evaluated) } else { chosen }
}

/// How probably each is there and matches, with its number.
pub(crate) fn promising(
    searcher: &Searcher<'_, '_>,
    evaluated: &Evaluated<'_>,
) -> Vec<(f64, usize)> {
    let each = evaluated.kind.iter().map(|number| {
        let score = searcher.index.node(number).map_or(1.0, |node| node.score);
        (score * evaluated.verdicts[number].probability, number)
    });
    each.collect()
}

/// The most probable ones, so many that the expected F1 is greatest; none where all are impossible.
pub(crate) fn best_expected_f1<T: Ord + Copy>(mut probabilities: Vec<(f64, T)>) -> Vec<T> {
    probabilities.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let ps: Vec<f64> = probabilities.iter().map(|(p, _)| *p).collect();
    let counting = ps.iter().take_while(|p| **p > NEGLIGIBLE).count();
    let f1 = match counting {
        1..=EXACT_MAX => expected_f1(&ps[..counting]),
        _ => roughly_expected_f1(&ps),
    };
    let (mut best, mut best_length) = (0.0, 0);
    for (f1, length) in f1.into_iter().zip(1..) {
        if f1 > best + ROUNDING {
            (best, best_length) = (f1, length);
        }
    }
    probabilities.truncate(best_length);
    probabilities.into_iter().map(|(_, thing)| thing).collect()
}

/// What is less probable counts for nothing where the expected F1 is computed exactly.
const NEGLIGIBLE: f64 = 1e-3;
/// For more things the expected F1 is approximated.
const EXACT_MAX: usize = 40;
/// A longer selection must be better by more than sums of so many numbers are off.
const ROUNDING: f64 = 1e-12;

/// Expected F1 with the first 1, 2 ... of a ranking selected: `E[2 h / (k + h + r)]`, with h hits among the k selected and r
/// among the rest, each a Poisson binomial number. In quadratic time by Ye, Chai, Lee and Chieu, "Optimizing F-measures: a tale
/// of two approaches" (2012): `E[1 / (a + r)]` for one rest follows from that for the rest shorter by one.
fn expected_f1(ps: &[f64]) -> Vec<f64> {
    let mut hits = vec![vec![1.0]];
    for (p, k) in ps.iter().zip(0..) {
        let before: &Vec<f64> = &hits[k];
        let at = |h: usize| before.get(h).copied().unwrap_or(0.0);
        let came = |h: usize| if h > 0 { at(h - 1) * p } else { 0.0 };
        let after = (0..=k + 1).map(|h| at(h) * (1.0 - p) + came(h)).collect();
        hits.push(after);
    }
    // At place a: the expected 1 / (a + r).
    let mut inverse: Vec<f64> = (0..=2 * ps.len()).map(|a| 1.0 / a.max(1) as f64).collect();
    let mut f1 = vec![0.0; ps.len()];
    for k in (1..=ps.len()).rev() {
        let p = ps[k - 1];
        let f = |(h, q): (usize, &f64)| 2.0 * h as f64 * q * inverse[k + h];
        f1[k - 1] = hits[k].iter().enumerate().map(f).sum();
        for a in 1..2 * k {
            inverse[a] = p * inverse[a + 1] + (1.0 - p) * inverse[a];
        }
    }
    f1
}

/// The same, about: twice the expected number of hits over the number selected plus the expected number there is.
fn roughly_expected_f1(ps: &[f64]) -> Vec<f64> {
    let all: f64 = ps.iter().sum();
    let mut hits = 0.0;
    let each = ps.iter().zip(1..).map(|(p, length)| {
        hits += p;
        2.0 * hits / (f64::from(length) + all)
    });
    each.collect()
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
    fn the_expected_f1_is_that_of_all_cases_together() {
        let ps = [0.9, 0.6, 0.35, 0.2];
        let found = expected_f1(&ps);
        for k in 1..=ps.len() {
            let cases = (0..1_usize << ps.len()).map(|case| {
                let is_in = |place: usize| case >> place & 1 == 1;
                let p = |place: usize| if is_in(place) { ps[place] } else { 1.0 - ps[place] };
                let hits = (0..k).filter(|&place| is_in(place)).count();
                let f1 = 2.0 * hits as f64 / (k + case.count_ones() as usize) as f64;
                f1 * (0..ps.len()).map(p).product::<f64>()
            });
            assert!((found[k - 1] - cases.sum::<f64>()).abs() < 1e-12, "{k}");
        }
    }

    #[test]
    fn one_guess_is_better_than_none_and_good_seconds_count() {
        assert_eq!(chosen(&[0.1]), 1);
        assert_eq!(chosen(&[0.9, 0.8, 0.05]), 2);
        assert_eq!(chosen(&[0.5, 0.5, 0.5]), 3);
    }
}
