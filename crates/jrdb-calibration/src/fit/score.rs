//! How well the image's edges lie on the cloud's, over one way of moving the cloud.

use jrdb_types::calibration::Measure;

use crate::least_squares;

use super::config::PARABOLA_STEPS;

/// Strengths of one part of the evidence.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Sum {
    /// Over places where a surface ends.
    pub(super) ends: f64,
    pub(super) end_count: usize,
    /// Over other places.
    pub(super) smooth: f64,
    pub(super) smooth_count: usize,
}

impl Sum {
    pub(super) fn add(&mut self, strength: f64, is_end: bool) {
        let (sum, count) = if is_end {
            (&mut self.ends, &mut self.end_count)
        } else {
            (&mut self.smooth, &mut self.smooth_count)
        };
        *sum += strength;
        *count += 1;
    }

    fn plus(self, other: Self) -> Self {
        Self {
            ends: self.ends + other.ends,
            end_count: self.end_count + other.end_count,
            smooth: self.smooth + other.smooth,
            smooth_count: self.smooth_count + other.smooth_count,
        }
    }

    fn usual(&self) -> f64 {
        self.smooth / self.smooth_count.max(1) as f64
    }

    /// How much stronger the image's edges are at the ends than is usual elsewhere, summed over the ends.
    pub(super) fn score(&self) -> f64 {
        self.excess(self.usual())
    }

    fn excess(&self, usual: f64) -> f64 {
        self.ends - self.end_count as f64 * usual
    }
}

/// The whole of the evidence but one unit.
fn total(units: &[Sum], without: Option<usize>) -> Sum {
    let kept = units.iter().enumerate().filter(|(i, _)| Some(*i) != without);
    kept.fold(Sum::default(), |sum, (_, unit)| sum.plus(*unit))
}

pub(super) fn score(units: &[Sum]) -> f64 {
    total(units, None).score()
}

/// What each unit that holds an end adds to the score.
pub(super) fn shares(units: &[Sum]) -> Vec<f64> {
    let usual = total(units, None).usual();
    units.iter().filter(|unit| unit.end_count > 0).map(|unit| unit.excess(usual)).collect()
}

/// Score over its standard error, from how much the units' shares scatter.
pub(super) fn significance(units: &[Sum]) -> f64 {
    let shares = shares(units);
    let count = shares.len() as f64;
    let sum: f64 = shares.iter().sum();
    let scatter: f64 = shares.iter().map(|share| (share - sum / count).powi(2)).sum();
    let error = (scatter * count / (count - 1.0)).sqrt();
    if error > 0.0 { sum / error } else { 0.0 }
}

/// The evidence at each of evenly spaced positions.
pub(super) struct Curve {
    /// Radians or metres.
    pub(super) positions: Vec<f64>,
    /// Per position, per unit.
    pub(super) units: Vec<Vec<Sum>>,
}

impl Curve {
    /// The position of the highest score, between the grid's by a parabola, and its place in the grid.
    fn peak(&self, without: Option<usize>) -> (f64, usize) {
        let scores: Vec<f64> = self.units.iter().map(|u| total(u, without).score()).collect();
        let mut best = 0;
        for (i, score) in scores.iter().enumerate() {
            if *score > scores[best] {
                best = i;
            }
        }
        let reach = PARABOLA_STEPS.min(best).min(scores.len() - 1 - best);
        let shift = vertex(&scores[best - reach..=best + reach]).unwrap_or(0.0);
        let step =
            if self.positions.len() > 1 { self.positions[1] - self.positions[0] } else { 0.0 };
        (self.positions[best] + shift.clamp(-1.0, 1.0) * step, best)
    }

    /// The position of the highest score.
    pub(super) fn best(&self) -> f64 {
        self.peak(None).0
    }

    /// The evidence of two LiDARs as one; both have the same positions and units.
    pub(super) fn plus(mut self, other: &Self) -> Self {
        for (here, there) in self.units.iter_mut().zip(&other.units) {
            for (unit, more) in here.iter_mut().zip(there) {
                *unit = unit.plus(*more);
            }
        }
        self
    }

    /// The best position and what it is worth; a cloud that must move by `x` has a mount that is off by `-x`.
    pub(super) fn measure(&self) -> Measure {
        let (position, best) = self.peak(None);
        let units = &self.units[best];
        let used: Vec<usize> = (0..units.len()).filter(|&i| units[i].end_count > 0).collect();
        let count = used.len() as f64;
        let others: Vec<f64> = used.iter().map(|&i| self.peak(Some(i)).0).collect();
        let mean = others.iter().sum::<f64>() / count.max(1.0);
        let scatter: f64 = others.iter().map(|other| (other - mean).powi(2)).sum();
        Measure {
            offset: -position,
            deviation: (scatter * (count - 1.0).max(0.0) / count.max(1.0)).sqrt(),
            edges: units.iter().map(|unit| unit.end_count).sum(),
            significance: significance(units),
            at_border: best == 0 || best + 1 == self.positions.len(),
        }
    }
}

/// Where the least-squares parabola through evenly spaced values has its top, in steps from the middle.
fn vertex(values: &[f64]) -> Option<f64> {
    let middle = (values.len() / 2) as f64;
    let row = |(i, value): (usize, &f64)| {
        let x = i as f64 - middle;
        ([1.0, x, x * x], *value)
    };
    let rows: Vec<_> = values.iter().enumerate().map(row).collect();
    let [_, slope, curvature] = least_squares::solve(&rows)?;
    (curvature < 0.0).then(|| -slope / (2.0 * curvature))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sum(ends: f64, end_count: usize) -> Sum {
        Sum { ends, end_count, smooth: 10.0, smooth_count: 100 }
    }

    /// Four units whose scores are parabolas around the given tops.
    fn curve(tops: [f64; 4]) -> Curve {
        let positions: Vec<f64> = (-20..=20).map(|i| f64::from(i) * 0.1).collect();
        let unit = |x: f64, top: f64| sum(50.0 - 10.0 * (x - top).powi(2), 30);
        let units = positions.iter().map(|x| tops.map(|top| unit(*x, top)).to_vec()).collect();
        Curve { positions, units }
    }

    #[test]
    fn the_top_is_found_between_the_steps_and_the_mount_is_off_the_other_way() {
        let found = curve([0.234; 4]).measure();
        assert!((found.offset + 0.234).abs() < 1e-9, "{found:?}");
        assert!(found.deviation < 1e-9 && found.edges == 120 && !found.at_border);
    }

    #[test]
    fn sectors_that_disagree_make_it_uncertain() {
        let found = curve([0.0, 0.2, 0.4, 0.6]).measure();
        // The standard error of the mean of the four.
        let expected = (0.2_f64 / 12.0).sqrt();
        assert!((found.offset + 0.3).abs() < 1e-9);
        assert!((found.deviation - expected).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn a_top_beyond_the_range_is_at_the_border() {
        assert!(curve([5.0; 4]).measure().at_border);
    }

    #[test]
    fn evidence_of_one_sector_only_is_not_significant() {
        let spread = [sum(20.0, 30); 8];
        let mut single = [sum(3.0, 30); 8];
        single[3] = sum(139.0, 30);
        assert_eq!(score(&spread), score(&single));
        assert!(significance(&spread[..]) == 0.0 || significance(&spread[..]) > 100.0);
        assert!(significance(&single) < 2.0);
    }

    #[test]
    fn no_evidence_is_no_offset() {
        let empty = Curve { positions: vec![-0.1, 0.0, 0.1], units: vec![vec![]; 3] };
        let found = empty.measure();
        assert_eq!((found.edges, found.significance), (0, 0.0));
    }
}
