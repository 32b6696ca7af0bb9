//! Where a polynomial stops growing, and the inverse of a growing function: what distortion models
//! need in order not to fold back.

/// Halvings and Newton steps after which a search ends; a bracket of doubles is exhausted before.
const MAX_STEPS: usize = 200;

/// Largest residual of an inverse, relative to `1 + |target| + |slope| |x|`: a few roundings.
pub(super) const RESIDUAL: f64 = 1e-14;

/// The value of `p[0] + p[1] x + p[2] x² + …`.
pub(super) fn evaluate(p: &[f64], x: f64) -> f64 {
    p.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

/// The polynomial's derivative.
pub(super) fn derivative(p: &[f64]) -> Vec<f64> {
    p.iter().zip(0_u32..).skip(1).map(|(c, power)| c * f64::from(power)).collect()
}

/// The product of two polynomials.
pub(super) fn product(p: &[f64], q: &[f64]) -> Vec<f64> {
    let mut sum = vec![0.0; (p.len() + q.len()).saturating_sub(1)];
    for (i, a) in p.iter().enumerate() {
        for (j, b) in q.iter().enumerate() {
            sum[i + j] += a * b;
        }
    }
    sum
}

/// The sum of two polynomials.
pub(super) fn sum(p: &[f64], q: &[f64]) -> Vec<f64> {
    let (long, short) = if p.len() < q.len() { (q, p) } else { (p, q) };
    let mut sum = long.to_vec();
    sum.iter_mut().zip(short).for_each(|(a, b)| *a += b);
    sum
}

/// The largest `x ≤ upper` such that the polynomial is positive on all of `[0, x)`.
pub(super) fn positive_up_to(p: &[f64], upper: f64) -> f64 {
    if evaluate(p, 0.0) > 0.0 {
        sign_changes(p, upper).first().copied().unwrap_or(upper)
    } else {
        0.0
    }
}

/// Where the polynomial's sign changes in `[0, upper]`, ascending: between two neighbouring turning
/// points there is at most one such place, and the turning points are the derivative's sign changes.
fn sign_changes(p: &[f64], upper: f64) -> Vec<f64> {
    if p.len() < 2 {
        return Vec::new();
    }
    let mut stops = vec![0.0];
    stops.extend(sign_changes(&derivative(p), upper));
    stops.push(upper);
    stops.windows(2).filter_map(|ends| sign_change(p, ends[0], ends[1])).collect()
}

fn sign_change(p: &[f64], mut low: f64, mut high: f64) -> Option<f64> {
    let positive = |x| evaluate(p, x) > 0.0;
    let start = positive(low);
    if positive(high) == start {
        return None;
    }
    for _ in 0..MAX_STEPS {
        let middle = 0.5 * (low + high);
        if positive(middle) == start {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(low)
}

/// The `x` in `[0, upper]` with `f(x) = target`, for an `f` that grows from `f(0) = 0` and gives its
/// value and slope: Newton's steps, and halved brackets where those leave the bracket or gain little.
///
/// `None` when no `x` is found: the target is out of reach or not a number.
pub(super) fn invert(f: impl Fn(f64) -> (f64, f64), target: f64, upper: f64) -> Option<f64> {
    let (mut low, mut high) = (0.0, upper);
    let mut x = target.clamp(low, high);
    let mut last_error = f64::INFINITY;
    for _ in 0..MAX_STEPS {
        let (value, slope) = f(x);
        let error = value - target;
        if error.abs() <= RESIDUAL * (1.0 + target + slope.abs() * x) {
            return Some(x);
        }
        if error > 0.0 {
            high = x;
        } else {
            low = x;
        }
        let newton = x - error / slope;
        let gains = low < newton && newton < high && error.abs() < 0.5 * last_error;
        x = if gains { newton } else { 0.5 * (low + high) };
        last_error = error.abs();
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn arithmetic_of_polynomials() {
        assert_eq!(evaluate(&[1.0, 2.0, 3.0], 2.0), 17.0);
        assert_eq!(derivative(&[1.0, 2.0, 3.0]), [2.0, 6.0]);
        assert_eq!(product(&[1.0, 1.0], &[1.0, -1.0]), [1.0, 0.0, -1.0]);
        assert_eq!(sum(&[1.0], &[1.0, 2.0]), [2.0, 2.0]);
    }

    #[test]
    fn the_first_of_several_zeros_counts() {
        // (1 - x)(2 - x)(3 - x)
        let p = product(&product(&[1.0, -1.0], &[2.0, -1.0]), &[3.0, -1.0]);
        assert!((positive_up_to(&p, 1e6) - 1.0).abs() < 1e-12);
        assert_eq!(positive_up_to(&p, 0.5), 0.5);
        assert_eq!(positive_up_to(&[1.0, 0.0, 1.0], 1e6), 1e6);
        assert_eq!(positive_up_to(&[-1.0, 1.0], 1e6), 0.0);
        assert_eq!(positive_up_to(&[f64::NAN, 1.0], 1e6), 0.0);
    }

    proptest! {
        #[test]
        fn the_sign_changes_at_the_limit_and_not_before(
            constant in 0.01..2.0,
            others in prop::collection::vec(-2.0..2.0, 0..9),
            at in 0.0..1.0,
        ) {
            let p = sum(&[constant], &product(&[0.0, 1.0], &others));
            let limit = positive_up_to(&p, 3.0);
            prop_assert!(evaluate(&p, at * limit) > -1e-9);
            prop_assert!(limit == 3.0 || evaluate(&p, limit.next_up()) <= 0.0);
        }

        #[test]
        fn the_inverse_inverts(x in 0.0..20.0) {
            let cubic = |x: f64| (x + x.powi(3), 1.0 + 3.0 * x * x);
            let found = invert(cubic, cubic(x).0, 1e6).unwrap();
            prop_assert!((found - x).abs() < 1e-11 * (1.0 + x));
        }
    }

    #[test]
    fn what_is_out_of_reach_has_no_inverse() {
        let identity = |x: f64| (x, 1.0);
        assert_eq!(invert(identity, 3.0, 2.0), None);
        assert_eq!(invert(identity, f64::NAN, 2.0), None);
        assert_eq!(invert(identity, 2.0, 2.0), Some(2.0));
    }
}
