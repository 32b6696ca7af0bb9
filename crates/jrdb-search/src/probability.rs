//! How probable it is that a number lies where it is asked to, given its uncertainty.

use jrdb_types::query::Interval;
use jrdb_types::{Direction, DistanceWord, SpatialRelation};

use crate::geometry::near_deg;
use crate::observer::Observer;

/// Probability that the true distance lies in the word's bin: a normal distribution around the measured
/// one. Graphs of words only give 0 or 1.
pub(crate) fn of_distance(
    relation: &SpatialRelation,
    asked: DistanceWord,
    observer: &Observer<'_>,
) -> f64 {
    let Some(distance_m) = relation.distance_m else {
        return certainty(relation.distance == Some(asked));
    };
    let (low, high) = asked.bounds_m();
    // Nothing is nearer than 0: the first bin keeps the whole lower tail.
    let low = if low == 0.0 { f64::NEG_INFINITY } else { low };
    normal_between(low - distance_m, high - distance_m, observer.config.position_sigma_m)
}

/// Probability that the true distance lies in an interval.
pub(crate) fn of_metres(distance_m: f64, asked: &Interval, observer: &Observer<'_>) -> f64 {
    let low = asked.min.filter(|&min| min > 0.0).unwrap_or(f64::NEG_INFINITY);
    let high = asked.max.unwrap_or(f64::INFINITY);
    if observer.config.position_sigma_m <= 0.0 {
        return certainty(asked.contains(distance_m));
    }
    normal_between(low - distance_m, high - distance_m, observer.config.position_sigma_m)
}

/// Probability that the true bearing lies in the asked sector: a normal distribution around the measured
/// one, as wide as position (at this distance) and heading allow. The elevation must be equal.
///
/// Where the graph says how sure the heading makes the sector that it names, that counts instead of the configured
/// deviation, and the other sectors share the rest.
pub(crate) fn of_direction(
    relation: &SpatialRelation,
    asked: Direction,
    observer: &Observer<'_>,
) -> f64 {
    let Some(found) = relation.direction else { return 0.0 };
    let (Some(bearing_rad), Some(distance_m)) = (relation.bearing_rad, relation.distance_m) else {
        return certainty(found == asked);
    };
    if found.elevation != asked.elevation {
        return 0.0;
    }
    let sector = |direction: Direction, heading_sigma_rad| {
        let (low, high) = direction.sector.named(observer.lateral).bounds_deg();
        let sigma = bearing_sigma_deg(distance_m, heading_sigma_rad, observer);
        on_circle(bearing_rad.to_degrees(), low, high, sigma)
    };
    let heading_sigma_rad = observer.heading_sigma_rad();
    match relation.direction_probability {
        Some(sure) if heading_sigma_rad > 0.0 => {
            let of_found = sure * sector(found, 0.0);
            let others = 1.0 - sector(found, heading_sigma_rad);
            let share = if others > 0.0 { sector(asked, heading_sigma_rad) / others } else { 0.0 };
            if asked == found { of_found } else { ((1.0 - of_found) * share).clamp(0.0, 1.0) }
        }
        _ => sector(asked, heading_sigma_rad),
    }
}

/// Probability that the true bearing is within an angle of another, degrees.
pub(crate) fn of_degrees(
    relation: &SpatialRelation,
    center: f64,
    half_width: f64,
    observer: &Observer<'_>,
) -> f64 {
    let Some(bearing_rad) = relation.bearing_rad else { return 0.0 };
    let distance_m = relation.distance_m.unwrap_or(f64::INFINITY);
    let sigma = bearing_sigma_deg(distance_m, observer.heading_sigma_rad(), observer);
    on_circle(bearing_rad.to_degrees(), center - half_width, center + half_width, sigma)
}

/// Standard deviation of a bearing, degrees.
pub(crate) fn bearing_sigma_deg(
    distance_m: f64,
    heading_sigma_rad: f64,
    observer: &Observer<'_>,
) -> f64 {
    observer.config.position_sigma_m.atan2(distance_m).hypot(heading_sigma_rad).to_degrees()
}

/// Probability that a normal angle lies between two others, degrees.
fn on_circle(angle: f64, low: f64, high: f64, sigma: f64) -> f64 {
    let angle = near_deg(angle, f64::midpoint(low, high));
    let turn = |turns: f64| {
        let angle = angle + 360.0 * turns;
        normal_between(low - angle, high - angle, sigma)
    };
    (turn(-1.0) + turn(0.0) + turn(1.0)).min(1.0)
}

/// Probability that what is so far off, at least 0, is at most so far off.
pub(crate) fn of_offset(offset_m: f64, max_m: f64, sigma_m: f64) -> f64 {
    if sigma_m <= 0.0 {
        return certainty(offset_m <= max_m);
    }
    normal_between(-max_m - offset_m, max_m - offset_m, sigma_m)
}

pub(crate) fn certainty(holds: bool) -> f64 {
    if holds { 1.0 } else { 0.0 }
}

/// Probability of a zero-mean normal variable between two values.
fn normal_between(low: f64, high: f64, sigma: f64) -> f64 {
    if sigma <= 0.0 {
        return certainty(low < 0.0 && 0.0 <= high);
    }
    (normal_cdf(high / sigma) - normal_cdf(low / sigma)).clamp(0.0, 1.0)
}

/// Beyond so many deviations there is less than the formula's error.
const TAIL: f64 = 6.0;

/// Standard normal distribution function through the complementary error function of Abramowitz and
/// Stegun 7.1.26; absolute error below 1.5e-7.
fn normal_cdf(z: f64) -> f64 {
    if z.abs() > TAIL {
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

/// Probability that the number of those that are, each with its own probability, is from `at_least` to `at_most`: the
/// Poisson binomial distribution.
pub(crate) fn of_count(
    probabilities: impl Iterator<Item = f64>,
    at_least: u32,
    at_most: Option<u32>,
) -> f64 {
    // One place for every number up to the greatest that matters, and one for all beyond; so large only as there are things.
    let mut exactly = vec![1.0];
    let top = at_most.map_or(at_least, |most| most.saturating_add(1).max(at_least)) as usize;
    for p in probabilities.filter(|&p| p > 0.0) {
        if exactly.len() <= top {
            exactly.push(0.0);
        }
        let last = exactly.len() - 1;
        let saturated = last == top;
        for number in (0..=last).rev() {
            let stays = if saturated && number == top { 1.0 } else { 1.0 - p };
            let comes = if number > 0 { exactly[number - 1] * p } else { 0.0 };
            exactly[number] = exactly[number] * stays + comes;
        }
    }
    let holds = |number: usize| {
        let number = u32::try_from(number).unwrap_or(u32::MAX);
        number >= at_least && at_most.is_none_or(|most| number <= most)
    };
    let wanted = exactly.iter().enumerate().filter(|(number, _)| holds(*number));
    wanted.map(|(_, p)| p).sum::<f64>().clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SearchConfig;
    use crate::observer::Front;
    use jrdb_types::LateralConvention;
    use jrdb_types::vocab::Sector;
    use proptest::prelude::*;

    fn from_robot(config: &SearchConfig) -> Observer<'_> {
        Observer { lateral: LateralConvention::Physical, front: Front::OfRobot, config }
    }

    fn relation(distance_m: f64, bearing_rad: f64) -> SpatialRelation {
        SpatialRelation {
            distance_m: Some(distance_m),
            bearing_rad: Some(bearing_rad),
            direction: Some(Direction::level(Sector::of_degrees(bearing_rad.to_degrees()))),
            ..SpatialRelation::default()
        }
    }

    #[test]
    fn a_distance_on_a_bound_is_even() {
        let config = SearchConfig::default();
        let p = |word| of_distance(&relation(1.5, 0.0), word, &from_robot(&config));
        assert!((p(DistanceWord::Close) - 0.5).abs() < 1e-3);
        assert!((p(DistanceWord::Moderate) - 0.5).abs() < 1e-3);
        assert!(p(DistanceWord::Far) < 1e-6);
    }

    #[test]
    fn words_without_numbers_are_certain() {
        let config = SearchConfig::default();
        let words =
            SpatialRelation { distance: Some(DistanceWord::Far), ..SpatialRelation::default() };
        assert_eq!(of_distance(&words, DistanceWord::Far, &from_robot(&config)), 1.0);
        assert_eq!(of_distance(&words, DistanceWord::Close, &from_robot(&config)), 0.0);
    }

    #[test]
    fn a_count_of_independent_things_is_poisson_binomial() {
        let ps = [0.5, 0.5, 0.25];
        let of = |least, most| of_count(ps.into_iter(), least, most);
        assert_eq!(of(1, None), 1.0 - 0.25 * 0.75);
        assert_eq!(of(0, Some(0)), 0.25 * 0.75);
        assert_eq!(of(3, Some(3)), 0.0625);
        assert_eq!(of(2, None), of(2, Some(2)) + of(3, Some(3)));
        assert_eq!((of(0, None), of(4, None), of(u32::MAX, None)), (1.0, 0.0, 0.0));
    }

    proptest! {
        #[test]
        fn the_words_share_out_one_probability(distance_m in 0.0..20.0, bearing in -3.1..3.1) {
            let (config, relation) = (SearchConfig::default(), relation(distance_m, bearing));
            let distances: f64 = DistanceWord::ALL.iter().map(|w| of_distance(&relation, *w, &from_robot(&config))).sum();
            prop_assert!((distances - 1.0).abs() < 1e-6);
            let observer = Observer { front: Front::OfPerson, ..from_robot(&config) };
            let sectors = |relation: &SpatialRelation| -> f64 {
                Sector::ALL.iter().map(|s| of_direction(relation, Direction::level(*s), &observer)).sum()
            };
            // At no distance the bearing is anyone's guess and its tails wind round more than once.
            let tolerance = if distance_m > 0.2 { 1e-6 } else { 0.05 };
            prop_assert!((sectors(&relation) - 1.0).abs() < tolerance);
            let sure = SpatialRelation { direction_probability: Some(0.7), ..relation };
            prop_assert!((sectors(&sure) - 1.0).abs() < tolerance.max(1e-3));
        }
    }
}
