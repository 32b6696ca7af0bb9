//! What each kind of error costs: the gap to a run that is given the truth, split into shares.

use jrdb_types::score::{Budget, Share};

/// So many parts of the truth can be told apart: each doubles the number of runs.
pub const TRUTHS_MAX: usize = 8;

/// Why a gap cannot be split.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BudgetError {
    /// There are too many parts.
    #[error("expected at most {TRUTHS_MAX} parts of the truth, found {0}")]
    TooMany(usize),
    /// There is not one value for each subset of the parts.
    #[error("expected {expected} values, one for each subset, found {found}")]
    Values {
        /// Two to the number of parts.
        expected: usize,
        /// How many values were given.
        found: usize,
    },
    /// A value is no number.
    #[error("expected a finite value for subset {subset:#b}, found {value}")]
    NotFinite {
        /// Which subset, as a mask.
        subset: usize,
        /// Its value.
        value: f64,
    },
}

/// Splits the gap between a run and one that is given all parts of the truth.
///
/// `values[mask]` is the metric of the run that is given the parts whose bits are set in `mask`,
/// bit 0 for the first. The shares are Shapley's (Shapley, "A value for n-person games", 1953):
/// with n parts,
///
/// ```text
/// φ_i = Σ over S without i of |S|! (n−|S|−1)! / n! · (v(S ∪ i) − v(S))
/// ```
///
/// They add up to the gap whatever the parts have to do with each other; the gains of one part at a
/// time do not.
///
/// # Errors
/// [`BudgetError`], with more than [`TRUTHS_MAX`] parts, or without one finite value for each
/// subset.
///
/// ```
/// let truths = ["attributes", "position"].map(String::from);
/// // Either is worth 0.1 alone; both together 0.4.
/// let budget = jrdb_metrics::budget(&truths, &[0.5, 0.6, 0.6, 0.9])?;
/// assert!((budget.shares[0].shapley - 0.2).abs() < 1e-12);
/// assert!((budget.shares[1].alone - 0.1).abs() < 1e-12);
/// assert!((budget.shares[1].cumulative - 0.3).abs() < 1e-12);
/// # Ok::<(), jrdb_metrics::BudgetError>(())
/// ```
pub fn budget(truths: &[String], values: &[f64]) -> Result<Budget, BudgetError> {
    check(truths.len(), values)?;
    let all = values.len() - 1;
    let share = |(i, truth): (usize, &String)| {
        let before = (1 << i) - 1;
        Share {
            truth: truth.clone(),
            alone: values[1 << i] - values[0],
            cumulative: values[before | 1 << i] - values[before],
            shapley: shapley(i, truths.len(), values),
        }
    };
    let shares = truths.iter().enumerate().map(share).collect();
    Ok(Budget { without: values[0], with_all: values[all], shares })
}

fn check(truths: usize, values: &[f64]) -> Result<(), BudgetError> {
    if truths > TRUTHS_MAX {
        return Err(BudgetError::TooMany(truths));
    }
    let (expected, found) = (1 << truths, values.len());
    if expected != found {
        return Err(BudgetError::Values { expected, found });
    }
    match values.iter().position(|value| !value.is_finite()) {
        Some(subset) => Err(BudgetError::NotFinite { subset, value: values[subset] }),
        None => Ok(()),
    }
}

/// The gain of part `i`, averaged over all orders of the `n` parts.
fn shapley(i: usize, n: usize, values: &[f64]) -> f64 {
    let part = 1 << i;
    let without = (0..values.len()).filter(|subset| subset & part == 0);
    let weighted = |subset: usize| {
        let before = subset.count_ones() as usize;
        let orders = factorial(before) * factorial(n - before - 1);
        orders / factorial(n) * (values[subset | part] - values[subset])
    };
    without.map(weighted).sum()
}

fn factorial(n: usize) -> f64 {
    (1..=n).map(|k| k as f64).product()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn names(count: usize) -> Vec<String> {
        (0..count).map(|n| format!("truth {n}")).collect()
    }

    #[test]
    fn independent_parts_have_their_own_gain_in_every_column() {
        let gains = [0.1, 0.2, 0.05];
        let given = |mask: usize| (0..3).filter(move |i| mask >> i & 1 == 1).map(|i| gains[i]);
        let values: Vec<f64> = (0..8).map(|mask| 0.4 + given(mask).sum::<f64>()).collect();
        let budget = budget(&names(3), &values).unwrap();
        for (share, gain) in budget.shares.iter().zip(gains) {
            for found in [share.alone, share.cumulative, share.shapley] {
                assert!((found - gain).abs() < 1e-12, "{share:?}");
            }
        }
        assert!((budget.gap() - 0.35).abs() < 1e-12);
    }

    #[test]
    fn what_cannot_be_split_is_said() {
        let error = |truths, values: &[f64]| budget(&names(truths), values).unwrap_err();
        assert_eq!(error(9, &[]), BudgetError::TooMany(9));
        assert_eq!(error(2, &[0.0; 3]), BudgetError::Values { expected: 4, found: 3 });
        let words = "expected a finite value for subset 0b1, found NaN";
        assert_eq!(error(1, &[0.0, f64::NAN]).to_string(), words);
        assert_eq!(budget(&[], &[0.5]).unwrap().gap(), 0.0);
    }

    proptest! {
        #[test]
        fn shares_add_up_to_the_gap(
            values in proptest::collection::vec(-1.0..1.0, 256), truths in 0_usize..9,
        ) {
            let budget = budget(&names(truths), &values[..1 << truths]).unwrap();
            let sum = |of: fn(&Share) -> f64| budget.shares.iter().map(of).sum::<f64>();
            prop_assert!((sum(|share| share.shapley) - budget.gap()).abs() < 1e-12);
            prop_assert!((sum(|share| share.cumulative) - budget.gap()).abs() < 1e-12);
        }
    }
}
