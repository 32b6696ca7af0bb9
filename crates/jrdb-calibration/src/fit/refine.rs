//! The mount that fits best, as far as the data determine it.

use std::collections::BTreeMap;

use faer::{Col, Mat};
use jrdb_types::calibration::{Freedom, Motion, RefinedFreedom, RefinedLidar, Refinement};

use super::evidence::{Edges, Evidence};
use super::score::{self, Curve, Sum};
use super::{FitConfig, View};
use crate::Error;
use crate::least_squares::covariance;

/// Each freedom in turn is moved to its best, so often.
const ROUNDS: usize = 3;

/// Finds yaw, pitch, roll and height of each LiDAR at which the images' edges lie best on the cloud's.
///
/// What the data do not determine is left as it is: freedoms are given up one at a time, the worst first.
///
/// # Errors
/// Those of [`crate::check_fit`].
pub fn refine(views: &[View<'_>], config: &FitConfig) -> Result<Refinement, Error> {
    let evidence = Evidence::new(views, config)?;
    let lidar = |sensor| Search { evidence: &evidence, sensor, config }.refined();
    Ok(Refinement { lidars: evidence.sensors().map(lidar).collect() })
}

/// The search for one LiDAR's mount.
struct Search<'a> {
    evidence: &'a Evidence<'a>,
    sensor: &'a str,
    config: &'a FitConfig,
}

impl Search<'_> {
    fn refined(&self) -> RefinedLidar {
        let mut free = Freedom::ALL.to_vec();
        let mut deviations = BTreeMap::new();
        let mut motion = Motion::default();
        while !free.is_empty() {
            motion = self.ascend(&free);
            let found = self.deviations(&motion, &free);
            let doubt = |i: usize| found[i].map_or(f64::INFINITY, |d| d / self.largest(free[i]));
            deviations.extend(free.iter().copied().zip(found.iter().copied()));
            let worst = (0..free.len()).max_by(|&i, &j| doubt(i).total_cmp(&doubt(j)));
            match worst.filter(|&worst| doubt(worst) > 1.0 || !self.has_match(&motion)) {
                Some(worst) => free.remove(worst),
                None => break,
            };
            motion = Motion::default();
        }
        let freedoms = Freedom::ALL.map(|freedom| RefinedFreedom {
            freedom,
            correction: motion.get(freedom),
            deviation: deviations.get(&freedom).copied().flatten(),
            is_determined: free.contains(&freedom),
        });
        RefinedLidar {
            sensor: self.sensor.into(),
            correction: motion,
            freedoms: freedoms.to_vec(),
            score_before: self.mean_score(&Motion::default()),
            score_after: self.mean_score(&motion),
        }
    }

    /// Largest standard deviation of a freedom that counts as determined.
    fn largest(&self, freedom: Freedom) -> f64 {
        let config = self.config;
        let tolerance = match freedom {
            Freedom::Height => config.height_tolerance_m,
            _ => config.yaw_tolerance_rad,
        };
        tolerance / config.coverage
    }

    fn units(&self, motion: &Motion) -> Vec<Sum> {
        self.evidence.units(self.sensor, motion, Edges::Both)
    }

    fn has_match(&self, motion: &Motion) -> bool {
        let units = self.units(motion);
        let ends: usize = units.iter().map(|unit| unit.end_count).sum();
        ends >= self.config.min_edges && score::significance(&units) >= self.config.min_significance
    }

    fn mean_score(&self, motion: &Motion) -> f64 {
        let units = self.units(motion);
        let ends: usize = units.iter().map(|unit| unit.end_count).sum();
        score::score(&units) / ends.max(1) as f64
    }

    /// The best position of each free freedom in turn, from the shipped mount.
    fn ascend(&self, free: &[Freedom]) -> Motion {
        let mut motion = Motion::default();
        for _ in 0..ROUNDS {
            for &freedom in free {
                motion = motion.with(freedom, self.curve(&motion, freedom).best());
            }
        }
        motion
    }

    fn curve(&self, motion: &Motion, freedom: Freedom) -> Curve {
        let config = self.config;
        let (range, step) = match freedom {
            Freedom::Height => (config.height_range_m, config.height_step_m),
            _ => (config.yaw_range_rad, config.yaw_step_rad),
        };
        let steps = (step, (range / step).round() as i32);
        self.evidence.curve(self.sensor, (motion, freedom), steps, Edges::Both)
    }

    /// Standard deviations of the free freedoms: the inverse of the curvature around the scatter of the units'
    /// slopes, `H⁻¹ Σ gₖ gₖᵀ H⁻¹`, or by leaving out one unit at a time, which sees a second top nearby, if that is
    /// larger; none where the score has no top.
    fn deviations(&self, motion: &Motion, free: &[Freedom]) -> Vec<Option<f64>> {
        let nowhere = vec![None; free.len()];
        let curvature = self.curvature(motion, free);
        let Some(inverse) = covariance(&curvature) else { return nowhere };
        let slopes = self.slopes(motion, free);
        let count = slopes.len() as f64;
        if count < 2.0 {
            return nowhere;
        }
        let mean = |i: usize| slopes.iter().map(|slope| slope[i]).sum::<f64>() / count;
        let means: Vec<f64> = (0..free.len()).map(mean).collect();
        let scatter = Mat::from_fn(free.len(), free.len(), |i, j| {
            slopes.iter().map(|slope| (slope[i] - means[i]) * (slope[j] - means[j])).sum::<f64>()
        });
        let covariance = &inverse * scatter * &inverse;
        let correction = count / (count - 1.0);
        let deviation = |i: usize| {
            let bias = match free[i] {
                Freedom::Yaw => 0.0,
                Freedom::Pitch | Freedom::Roll => self.config.tilt_bias_rad,
                Freedom::Height => self.config.height_bias_m,
            };
            let by_leaving_out = self.curve(motion, free[i]).measure().deviation;
            (covariance[(i, i)] * correction).max(0.0).sqrt().max(by_leaving_out).hypot(bias)
        };
        (0..free.len()).map(|i| Some(deviation(i))).collect()
    }

    /// A step over which the score's curvature is seen above its roughness: the tolerance is about half the
    /// width of its top.
    fn reach(&self, freedom: Freedom) -> f64 {
        match freedom {
            Freedom::Height => self.config.height_tolerance_m,
            _ => self.config.yaw_tolerance_rad / 2.0,
        }
    }

    fn moved(&self, motion: &Motion, freedom: Freedom, steps: f64) -> Motion {
        motion.with(freedom, motion.get(freedom) + steps * self.reach(freedom))
    }

    /// Second differences of the score, with the sign of a sum of squares: positive definite at a top.
    fn curvature(&self, motion: &Motion, free: &[Freedom]) -> Mat<f64> {
        let score = |motion: &Motion| score::score(&self.units(motion));
        let top = score(motion);
        Mat::from_fn(free.len(), free.len(), |i, j| {
            let (a, b) = (free[i], free[j]);
            let at = |p: f64, q: f64| score(&self.moved(&self.moved(motion, a, p), b, q));
            let second = if i == j {
                at(0.5, 0.5) - 2.0 * top + at(-0.5, -0.5)
            } else {
                (at(1.0, 1.0) - at(1.0, -1.0) - at(-1.0, 1.0) + at(-1.0, -1.0)) / 4.0
            };
            -second / (self.reach(a) * self.reach(b))
        })
    }

    /// Slopes of each unit's share of the score.
    fn slopes(&self, motion: &Motion, free: &[Freedom]) -> Vec<Col<f64>> {
        let sides = |&freedom: &Freedom| {
            [1.0, -1.0].map(|side| score::shares(&self.units(&self.moved(motion, freedom, side))))
        };
        let differences: Vec<_> = free.iter().map(sides).collect();
        let used = differences.first().map_or(0, |[up, _]| up.len());
        let slope = |unit: usize| {
            Col::from_fn(free.len(), |i| {
                let [up, down] = &differences[i];
                (up[unit] - down[unit]) / (2.0 * self.reach(free[i]))
            })
        };
        (0..used).map(slope).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::motion::about;
    use super::super::{Sweep, world};
    use super::*;
    use jrdb_types::Image;
    use nalgebra::Point3;

    fn refined(error: Motion, image: &Image) -> RefinedLidar {
        let (origin, points) = world::sweep(0.1);
        let moved = about(&error, &origin);
        let points: Vec<Point3<f64>> = points.iter().map(|point| moved * point).collect();
        let sweep = Sweep { sensor: "lidar", origin: moved * origin, points: &points };
        let view = View { camera: &world::camera(), image, sweeps: &[sweep] };
        refine(&[view], &FitConfig::default()).unwrap().lidars.remove(0)
    }

    #[test]
    fn an_error_in_every_freedom_is_undone() {
        let degrees = f64::to_radians;
        let error = Motion {
            yaw_rad: degrees(1.5),
            pitch_rad: degrees(-1.0),
            roll_rad: degrees(0.8),
            height_m: 0.06,
        };
        let found = refined(error, &world::picture());
        assert!(found.score_after > found.score_before + 0.1, "{found:?}");
        for freedom in &found.freedoms {
            let left = freedom.correction + error.get(freedom.freedom);
            let tolerance = match freedom.freedom {
                Freedom::Yaw => degrees(0.25),
                Freedom::Pitch | Freedom::Roll => degrees(0.5),
                Freedom::Height => 0.03,
            };
            assert!(freedom.is_determined && left.abs() < tolerance, "{freedom:?} leaves {left}");
        }
    }

    #[test]
    fn without_edges_in_the_image_everything_is_left_alone() {
        let found = refined(Motion::default(), &Image::filled(1880, 240, [128; 3]));
        assert_eq!(found.correction, Motion::default());
        assert!(found.freedoms.iter().all(|f| !f.is_determined && f.correction == 0.0));
    }
}
