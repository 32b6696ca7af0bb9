//! The logarithm of a sum of exponentials, which converts scores to log-probabilities.

/// Numbers that are added up side by side, so that vector registers can; the sum does not depend on
/// their width.
const LANES: usize = 16;

/// Natural logarithm of the sum of the exponentials of scores, within 1e-6. NaN counts as nothing.
pub(crate) fn log_sum_exp(scores: &[f32]) -> f64 {
    let highest = highest(scores);
    if !highest.is_finite() {
        return f64::from(highest);
    }
    let (whole, rest) = scores.as_chunks::<LANES>();
    let mut sums = [0.0_f32; LANES];
    let mut total = 0.0;
    for (number, chunk) in (1..).zip(whole) {
        for (sum, score) in sums.iter_mut().zip(chunk) {
            *sum += exp(score - highest);
        }
        // Single precision is enough for some additions, not for a whole vocabulary.
        if number % 64 == 0 {
            total += sums.iter().map(|sum| f64::from(*sum)).sum::<f64>();
            sums = [0.0; LANES];
        }
    }
    total += sums.iter().map(|sum| f64::from(*sum)).sum::<f64>();
    total += rest.iter().map(|score| f64::from(exp(score - highest))).sum::<f64>();
    f64::from(highest) + total.ln()
}

/// The highest score; negative infinity if there are no scores. NaN is ignored.
pub(crate) fn highest(scores: &[f32]) -> f32 {
    let higher = |a: f32, b: f32| if b > a { b } else { a };
    let (whole, rest) = scores.as_chunks::<LANES>();
    let mut lanes = [f32::NEG_INFINITY; LANES];
    for chunk in whole {
        for (lane, score) in lanes.iter_mut().zip(chunk) {
            *lane = higher(*lane, *score);
        }
    }
    lanes.iter().chain(rest).copied().fold(f32::NEG_INFINITY, higher)
}

/// The exponential of a number that is not above 0, within 1e-7 of its size; 0 below -87.
///
/// x = (n + r) ln 2 with a whole n and r in `[-1/2, 1/2]`; 2^r by its Taylor series, 2^n by its
/// bits.
#[inline(always)]
fn exp(x: f32) -> f32 {
    const LEAST: f32 = -87.0;
    // Adding this rounds to a whole number, which then stands in the last bits.
    const SHIFT: f32 = 12_582_912.0;
    let t = x.max(LEAST) * std::f32::consts::LOG2_E;
    let shifted = t + SHIFT;
    let r = (t - (shifted - SHIFT)) * std::f32::consts::LN_2;
    let series = r * (1.0 / 720.0) + 1.0 / 120.0;
    let series = r * series + 1.0 / 24.0;
    let series = r * series + 1.0 / 6.0;
    let series = r * series + 0.5;
    let series = r * series + 1.0;
    let series = r * series + 1.0;
    let power = f32::from_bits((shifted.to_bits().wrapping_add(127)) << 23);
    if x >= LEAST { series * power } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn exact(scores: &[f32]) -> f64 {
        let highest = scores.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let sum: f64 = scores.iter().map(|s| (f64::from(*s) - f64::from(highest)).exp()).sum();
        f64::from(highest) + sum.ln()
    }

    #[test]
    fn what_is_no_number_counts_as_nothing() {
        assert_eq!(log_sum_exp(&[]), f64::NEG_INFINITY);
        assert_eq!(log_sum_exp(&[f32::NEG_INFINITY; 3]), f64::NEG_INFINITY);
        assert_eq!(log_sum_exp(&[f32::NAN, 2.0, f32::NEG_INFINITY]), 2.0);
    }

    proptest! {
        #[test]
        fn it_is_the_definition_to_six_digits(scores in proptest::collection::vec(-90.0_f32..30.0, 1..3000)) {
            prop_assert!((log_sum_exp(&scores) - exact(&scores)).abs() < 1e-6);
        }
    }
}
