//! How probable it is that a word holds, given a measured number and its uncertainty.

use jrdb_types::{Direction, DistanceWord, LateralConvention, SpatialRelation};

use crate::SearchConfig;

/// Probability that the true distance lies in the word's bin: a normal distribution around the measured
/// one. Graphs of words only give 0 or 1.
pub(crate) fn of_distance(
    relation: &SpatialRelation,
    asked: DistanceWord,
    config: &SearchConfig,
) -> f64 {
    let Some(distance_m) = relation.distance_m else {
        return certainty(relation.distance == Some(asked));
    };
    let (low, high) = asked.bounds_m();
    // Nothing is nearer than 0: the first bin keeps the whole lower tail.
    let low = if low == 0.0 { f64::NEG_INFINITY } else { low };
    normal_between(low - distance_m, high - distance_m, config.position_sigma_m)
}

/// Probability that the true bearing lies in the asked sector: a normal distribution around the measured
/// one, as wide as position (at this distance) and heading allow. The elevation must be equal.
pub(crate) fn of_direction(
    relation: &SpatialRelation,
    asked: Direction,
    lateral: LateralConvention,
    heading_sigma_rad: f64,
    config: &SearchConfig,
) -> f64 {
    let Some(found) = relation.direction else { return 0.0 };
    let (Some(bearing_rad), Some(distance_m)) = (relation.bearing_rad, relation.distance_m) else {
        return certainty(found == asked);
    };
    if found.elevation != asked.elevation {
        return 0.0;
    }
    let sector = match lateral {
        LateralConvention::Physical => asked.sector,
        LateralConvention::EngineHead => asked.sector.mirrored(),
    };
    let from_position = config.position_sigma_m.atan2(distance_m);
    let sigma_deg = from_position.hypot(heading_sigma_rad).to_degrees();
    let (low, high) = sector.bounds_deg();
    let turn = |turns: f64| {
        let bearing_deg = bearing_rad.to_degrees() + 360.0 * turns;
        normal_between(low - bearing_deg, high - bearing_deg, sigma_deg)
    };
    (turn(-1.0) + turn(0.0) + turn(1.0)).min(1.0)
}

fn certainty(holds: bool) -> f64 {
    if holds { 1.0 } else { 0.0 }
}

/// Probability of a zero-mean normal variable between two values.
fn normal_between(low: f64, high: f64, sigma: f64) -> f64 {
    if sigma <= 0.0 {
        return certainty(low < 0.0 && 0.0 <= high);
    }
    (normal_cdf(high / sigma) - normal_cdf(low / sigma)).clamp(0.0, 1.0)
}

/// Standard normal distribution function through the complementary error function of Abramowitz and
/// Stegun 7.1.26; absolute error below 1.5e-7.
fn normal_cdf(z: f64) -> f64 {
    if z.is_infinite() {
        return if z > 0.0 { 1.0 } else { 0.0 };
    }
    const P: f64 = 0.327_591_1;
    const A: [f64; 5] =
        [0.254_829_592, -0.284_496_736, 1.421_413_741, -1.453_152_027, 1.061_405_429];
    let x = z.abs() / std::f64::consts::SQRT_2;
    let t = 1.0 / (1.0 + P * x);
    let polynomial = A.iter().rev().fold(0.0, |sum, a| (sum + a) * t);
    let upper_tail = polynomial * (-x * x).exp() / 2.0;
    if z > 0.0 { 1.0 - upper_tail } else { upper_tail }
}

#[cfg(test)]
mod tests {
    use super::*;
    use jrdb_types::vocab::Sector;
    use proptest::prelude::*;

    fn relation(distance_m: f64, bearing_rad: f64) -> SpatialRelation {
        SpatialRelation {
            distance_m: Some(distance_m),
            bearing_rad: Some(bearing_rad),
            direction: Some(Direction::level(Sector::Front)),
            ..SpatialRelation::default()
        }
    }

    #[test]
    fn a_distance_on_a_bound_is_even() {
        let config = SearchConfig::default();
        let p = |word| of_distance(&relation(1.5, 0.0), word, &config);
        assert!((p(DistanceWord::Close) - 0.5).abs() < 1e-3);
        assert!((p(DistanceWord::Moderate) - 0.5).abs() < 1e-3);
        assert!(p(DistanceWord::Far) < 1e-6);
    }

    #[test]
    fn words_without_numbers_are_certain() {
        let config = SearchConfig::default();
        let words =
            SpatialRelation { distance: Some(DistanceWord::Far), ..SpatialRelation::default() };
        assert_eq!(of_distance(&words, DistanceWord::Far, &config), 1.0);
        assert_eq!(of_distance(&words, DistanceWord::Close, &config), 0.0);
    }

    proptest! {
        #[test]
        fn the_words_share_out_one_probability(distance_m in 0.0..20.0, bearing in -3.1..3.1) {
            let (config, relation) = (SearchConfig::default(), relation(distance_m, bearing));
            let distances: f64 = DistanceWord::ALL.iter().map(|w| of_distance(&relation, *w, &config)).sum();
            prop_assert!((distances - 1.0).abs() < 1e-6);
            let physical = LateralConvention::Physical;
            let sectors: f64 = Sector::ALL
                .iter()
                .map(|s| of_direction(&relation, Direction::level(*s), physical, 0.1, &config))
                .sum();
            // At no distance the bearing is anyone's guess and its tails wind round more than once.
            let tolerance = if distance_m > 0.2 { 1e-6 } else { 0.05 };
            prop_assert!((sectors - 1.0).abs() < tolerance);
        }
    }
}
