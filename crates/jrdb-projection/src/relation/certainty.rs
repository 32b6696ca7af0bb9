//! How certain a sector is when the heading is not.

use jrdb_types::vocab::Sector;

/// Probability that the bearing lies in the sector it seems to lie in, when the heading that it is measured from
/// has a normal error of `std_rad`.
///
/// The bounds are [`Sector::bounds_deg`]; a deviation of 0 gives 1. Errors beyond half a turn wrap around: the
/// probabilities of the eight sectors add up to 1.
#[must_use]
pub fn probability(sector: Sector, bearing_rad: f64, std_rad: f64) -> f64 {
    if std_rad <= 0.0 {
        return 1.0;
    }
    let (from, to) = sector.bounds_deg();
    let (from, to) = (from.to_radians(), to.to_radians());
    let below = |bound: f64| normal_cdf((bound - bearing_rad) / std_rad);
    let turns = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|turn| turn * std::f64::consts::TAU);
    turns.iter().map(|turn| below(to + turn) - below(from + turn)).sum::<f64>().clamp(0.0, 1.0)
}

/// The standard normal distribution function, to 1.5e-7 (Abramowitz and Stegun 7.1.26).
fn normal_cdf(x: f64) -> f64 {
    const P: f64 = 0.327_591_1;
    const A: [f64; 5] =
        [0.254_829_592, -0.284_496_736, 1.421_413_741, -1.453_152_027, 1.061_405_429];
    let z = x.abs() / std::f64::consts::SQRT_2;
    let t = 1.0 / (1.0 + P * z);
    let tail = A.iter().rev().fold(0.0, |sum, a| sum * t + a) * t * (-z * z).exp() / 2.0;
    if x < 0.0 { tail } else { 1.0 - tail }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_middle_of_a_wide_sector_is_certain_and_a_bound_is_not() {
        assert!(probability(Sector::Left, 90_f64.to_radians(), 0.15) > 0.99);
        let at_bound = probability(Sector::Front, 30_f64.to_radians(), 0.05);
        assert!((at_bound - 0.5).abs() < 1e-3, "{at_bound}");
        assert_eq!(probability(Sector::BackLeft, 2.4, 0.0), 1.0);
    }

    #[test]
    fn straight_behind_is_the_middle_of_back_on_either_side_of_the_turn() {
        let [left, right] = [3.1, -3.1].map(|bearing| probability(Sector::Back, bearing, 0.2));
        assert!((left - right).abs() < 1e-9 && left > 0.99);
    }

    proptest! {
        #[test]
        fn the_sectors_share_one_certainty(bearing in -3.1..3.1, std in 0.01..2.0) {
            let sum: f64 = Sector::ALL.iter().map(|&s| probability(s, bearing, std)).sum();
            prop_assert!((sum - 1.0).abs() < 1e-5, "{sum}");
        }
    }
}
