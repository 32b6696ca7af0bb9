//! Intervals of ratios by the studentised bootstrap over recordings.
//!
//! Frames of a recording are not independent, so recordings are what is drawn, with replacement.
//! The standard error of a ratio of sums over recordings is that of its linearisation (Cochran,
//! "Sampling Techniques", 3rd edition 1977, section 6.3):
//!
//! ```text
//! θ = Σ pᵣ / Σ wᵣ     se² = R/(R−1) · Σ (pᵣ − θ wᵣ)² / (Σ wᵣ)²
//! ```
//!
//! Every draw b gives t_b = (θ_b − θ) / se_b, and the interval is θ − t·se at the 97.5 % and 2.5 %
//! quantile of the t_b (Efron and Tibshirani, "An Introduction to the Bootstrap", 1993, section
//! 12.5). Percentile intervals are too narrow with as few recordings as there are. A difference of
//! two methods is drawn as one: both lose and gain the same recordings.
//!
//! In 8,000 simulated studies (the test `coverage`) 94.0 to 94.2 % of these intervals hold the
//! truth with 27 recordings of very unequal length, 93 % with 10, and 89 % of Student's with 5.
//! Where nearly all recordings are at the top of the scale, 90 to 91 % do with 27.

use jrdb_types::score::{Interval, IntervalMethod};
use serde::{Deserialize, Serialize};

use crate::random::Random;
use crate::ratio::Ratio;
use crate::student::quantile_975;

/// How intervals are drawn.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct BootstrapConfig {
    /// How often recordings are drawn.
    pub draws: usize,
    /// The seed of the draws: the same seed gives the same intervals everywhere.
    pub seed: u64,
}

impl Default for BootstrapConfig {
    /// 10,000 draws: the ends of an interval vary by about a hundredth of its width from seed to
    /// seed.
    fn default() -> Self {
        Self { draws: 10_000, seed: 1 }
    }
}

/// With fewer recordings the draws repeat each other too much, and Student's quantile is taken.
pub(crate) const FEW_RECORDINGS: usize = 10;

/// A draw whose standard error is less than this part of the run's own has lost what varies.
const COLLAPSED: f64 = 0.1;

/// Student's quantile is taken when more than this part of the draws collapse.
const COLLAPSED_MAX: f64 = 0.005;

/// Probability of each tail of a 95 % interval.
const TAIL: f64 = 0.025;

/// A ratio of sums over recordings, or the difference of two over the same recordings.
pub(crate) struct Contrast {
    /// The ratios that count positive and negative, by recording.
    plus: Vec<Ratio>,
    minus: Option<Vec<Ratio>>,
    /// Least and greatest possible value.
    range: [f64; 2],
}

/// A value and its standard error.
#[derive(Clone, Copy)]
struct Value {
    value: f64,
    error: f64,
}

impl Contrast {
    /// A ratio; recordings without a denominator do not count.
    pub(crate) fn ratio(mut of: Vec<Ratio>, range: [f64; 2]) -> Self {
        of.retain(|ratio| ratio.whole > 0.0);
        Self { plus: of, minus: None, range }
    }

    /// The difference `b - a`; recordings without a denominator on both sides do not count.
    pub(crate) fn difference(a: &[Ratio], b: &[Ratio], range: [f64; 2]) -> Self {
        let told = a.iter().zip(b).filter(|(a, b)| a.whole > 0.0 || b.whole > 0.0);
        let (minus, plus): (Vec<Ratio>, Vec<Ratio>) = told.map(|(a, b)| (*a, *b)).unzip();
        let range = [range[0] - range[1], range[1] - range[0]];
        Self { plus, minus: Some(minus), range }
    }

    /// How many recordings count.
    pub(crate) fn recordings(&self) -> usize {
        self.plus.len()
    }

    /// The value when each recording counts as often as its weight says; `None` without a
    /// denominator.
    fn weighted(&self, weights: &[f64]) -> Option<Value> {
        let plus = Linear::new(&self.plus, weights)?;
        let Some(all_minus) = &self.minus else {
            let residual = |r: usize| plus.residual(&self.plus[r]);
            return Some(Value { value: plus.value, error: error(weights, residual) });
        };
        let minus = Linear::new(all_minus, weights)?;
        let residual = |r: usize| plus.residual(&self.plus[r]) - minus.residual(&all_minus[r]);
        Some(Value { value: plus.value - minus.value, error: error(weights, residual) })
    }

    /// The 95 % interval; `None` with one recording, or without a value.
    pub(crate) fn interval(&self, config: &BootstrapConfig) -> Option<Interval> {
        let recordings = self.recordings();
        let run = self.weighted(&vec![1.0; recordings]).filter(|_| recordings > 1)?;
        let drawn = if recordings < FEW_RECORDINGS { None } else { self.quantiles(run, config) };
        let student = quantile_975(recordings - 1);
        let ([low, high], method) = match drawn {
            Some(drawn) => (drawn, IntervalMethod::BootstrapT),
            None => ([-student, student], IntervalMethod::StudentT),
        };
        let end = |t: f64| (run.value - t * run.error).clamp(self.range[0], self.range[1]);
        Some(Interval { low: end(high), high: end(low), method })
    }

    /// The 2.5 % and 97.5 % quantiles of the studentised draws; `None` when too many collapse.
    fn quantiles(&self, run: Value, config: &BootstrapConfig) -> Option<[f64; 2]> {
        let mut random = Random::seeded(config.seed);
        let mut weights = vec![0.0; self.recordings()];
        let mut drawn: Vec<f64> = Vec::with_capacity(config.draws);
        for _ in 0..config.draws {
            draw(&mut random, &mut weights);
            let value = self.weighted(&weights);
            let whole = value.filter(|value| value.error > COLLAPSED * run.error);
            drawn.extend(whole.map(|value| (value.value - run.value) / value.error));
        }
        let collapsed = config.draws - drawn.len();
        let tail = (TAIL * (drawn.len() + 1) as f64) as usize;
        if tail == 0 || collapsed as f64 > COLLAPSED_MAX * config.draws as f64 {
            return None;
        }
        drawn.sort_unstable_by(f64::total_cmp);
        Some([drawn[tail - 1], drawn[drawn.len() - tail]])
    }
}

/// Draws as many recordings as there are, with replacement: how often each was drawn.
fn draw(random: &mut Random, weights: &mut [f64]) {
    weights.fill(0.0);
    for _ in 0..weights.len() {
        weights[random.below(weights.len())] += 1.0;
    }
}

/// A ratio of weighted sums, and its derivative.
struct Linear {
    value: f64,
    whole: f64,
}

impl Linear {
    fn new(ratios: &[Ratio], weights: &[f64]) -> Option<Self> {
        let (mut part, mut whole) = (0.0, 0.0);
        for (ratio, weight) in ratios.iter().zip(weights) {
            part += weight * ratio.part;
            whole += weight * ratio.whole;
        }
        (whole > 0.0).then(|| Self { value: part / whole, whole })
    }

    /// How much one recording pulls the ratio.
    fn residual(&self, of: &Ratio) -> f64 {
        (of.part - self.value * of.whole) / self.whole
    }
}

fn error(weights: &[f64], residual: impl Fn(usize) -> f64) -> f64 {
    let count = weights.len() as f64;
    let squares = weights.iter().enumerate().map(|(r, weight)| weight * residual(r).powi(2));
    (squares.sum::<f64>() * count / (count - 1.0)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ratios(parts: &[f64]) -> Vec<Ratio> {
        parts.iter().map(|&part| Ratio { part, whole: 10.0 }).collect()
    }

    #[test]
    fn of_equal_recordings_the_error_is_that_of_the_mean() {
        let contrast = Contrast::ratio(ratios(&[1.0, 3.0, 5.0]), [0.0, 1.0]);
        let value = contrast.weighted(&[1.0; 3]).unwrap();
        assert!((value.value - 0.3).abs() < 1e-12);
        assert!((value.error - 0.2 / 3.0_f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn one_recording_has_no_interval_and_few_have_students() {
        let of = |parts: &[f64]| {
            let contrast = Contrast::ratio(ratios(parts), [0.0, 1.0]);
            contrast.interval(&BootstrapConfig::default())
        };
        assert_eq!(of(&[3.0]), None);
        let few = of(&[1.0, 3.0, 5.0]).unwrap();
        assert_eq!(few.method, IntervalMethod::StudentT);
        assert!(few.low == 0.0 && (few.high - 0.3 - 4.302_653 * 0.2 / 3.0_f64.sqrt()).abs() < 1e-9);
    }

    #[test]
    fn where_one_recording_differs_draws_collapse_and_students_quantile_is_taken() {
        let mut parts = vec![10.0; 27];
        parts[4] = 7.0;
        let contrast = Contrast::ratio(ratios(&parts), [0.0, 1.0]);
        let interval = contrast.interval(&BootstrapConfig::default()).unwrap();
        assert_eq!((interval.method, interval.high), (IntervalMethod::StudentT, 1.0));
        assert!(interval.low > 0.95, "{interval:?}");
    }

    #[test]
    fn a_run_does_not_differ_from_itself() {
        let of: Vec<f64> = (0..27).map(|n| f64::from(n * 7 % 11)).collect();
        let contrast = Contrast::difference(&ratios(&of), &ratios(&of), [0.0, 1.0]);
        let interval = contrast.interval(&BootstrapConfig::default()).unwrap();
        assert_eq!([interval.low, interval.high], [0.0, 0.0]);
    }

    #[test]
    fn the_same_seed_gives_the_same_interval_and_another_seed_a_similar_one() {
        let of: Vec<f64> = (0..27).map(|n| f64::from(n * 7 % 11)).collect();
        let contrast = Contrast::ratio(ratios(&of), [0.0, 1.0]);
        let with = |seed| contrast.interval(&BootstrapConfig { seed, ..Default::default() });
        let (one, other) = (with(1).unwrap(), with(2).unwrap());
        assert_eq!(with(1), Some(one));
        assert!(one != other && (one.low - other.low).abs() < 0.05 * one.half_width());
    }
}
