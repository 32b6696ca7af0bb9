//! A sweep as rings of beams around the LiDAR.

use std::f64::consts::{PI, TAU};

use nalgebra::{Point3, Vector3};

use super::FitConfig;

/// A LiDAR's return as it is seen from the LiDAR.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Beam {
    /// Counter-clockwise from +x, radians, in `[-π, π]`.
    pub(super) azimuth_rad: f64,
    /// Rise per metre of horizontal range.
    pub(super) slope: f64,
    /// One over the horizontal range, 1/m: along a plane it is linear in the slope.
    pub(super) inverse_range: f64,
}

impl Beam {
    /// The return at a point, unless it is straight above, below or at the LiDAR.
    fn at(arm: &Vector3<f64>) -> Option<Self> {
        let range_m = arm.x.hypot(arm.y);
        let beam = Self {
            azimuth_rad: arm.y.atan2(arm.x),
            slope: arm.z / range_m,
            inverse_range: 1.0 / range_m,
        };
        (beam.slope.is_finite() && beam.inverse_range.is_finite()).then_some(beam)
    }

    /// Where this beam is at another inverse range.
    pub(super) fn point(&self, origin: &Point3<f64>, inverse_range: f64) -> Point3<f64> {
        let (sin, cos) = self.azimuth_rad.sin_cos();
        origin + Vector3::new(cos, sin, self.slope) / inverse_range
    }

    /// Which of `count` equal parts of a turn the beam is in.
    pub(super) fn part(&self, count: usize) -> usize {
        let turn = (self.azimuth_rad + PI) / TAU;
        ((turn * count as f64) as usize).min(count - 1)
    }
}

/// The beams of a sweep, ring by ring from below, each in the order of the azimuth.
pub(super) fn rings(
    origin: &Point3<f64>,
    points: &[Point3<f64>],
    config: &FitConfig,
) -> Vec<Vec<Beam>> {
    let mut beams: Vec<Beam> = points.iter().filter_map(|p| Beam::at(&(p - origin))).collect();
    beams.sort_by(|a, b| {
        let by_slope = a.slope.total_cmp(&b.slope);
        by_slope.then(a.azimuth_rad.total_cmp(&b.azimuth_rad))
    });
    let mut rings: Vec<Vec<Beam>> = Vec::new();
    let mut lowest_rad = f64::NEG_INFINITY;
    for beam in beams {
        let elevation_rad = beam.slope.atan();
        match rings.last_mut() {
            Some(ring) if elevation_rad - lowest_rad <= config.ring_rad => ring.push(beam),
            _ => {
                lowest_rad = elevation_rad;
                rings.push(vec![beam]);
            }
        }
    }
    for ring in &mut rings {
        ring.sort_by(|a, b| a.azimuth_rad.total_cmp(&b.azimuth_rad));
    }
    rings
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_two_elevations_are_two_rings_in_the_order_of_the_azimuth() {
        let origin = Point3::new(0.0, 0.0, 0.3);
        let at = |azimuth: f64, slope: f64, range: f64| {
            origin + Vector3::new(azimuth.cos(), azimuth.sin(), slope) * range
        };
        let points = [at(1.0, 0.1, 3.0), at(-2.0, 0.1004, 7.0), at(0.5, -0.1, 2.0)];
        let rings = rings(&origin, &points, &FitConfig::default());
        let found: Vec<Vec<f64>> = rings
            .iter()
            .map(|ring| ring.iter().map(|b| (b.azimuth_rad * 10.0).round() / 10.0).collect())
            .collect();
        assert_eq!(found, [vec![0.5], vec![-2.0, 1.0]]);
        let beam = rings[0][0];
        assert!((beam.point(&origin, beam.inverse_range) - points[2]).norm() < 1e-12);
    }

    #[test]
    fn what_is_above_the_lidar_is_no_beam() {
        let points = [Point3::new(0.0, 0.0, 1.0), Point3::origin()];
        assert!(rings(&Point3::origin(), &points, &FitConfig::default()).is_empty());
    }

    #[test]
    fn parts_of_a_turn_start_behind() {
        let beam = |azimuth_rad| Beam { azimuth_rad, slope: 0.0, inverse_range: 1.0 };
        assert_eq!([-PI, -0.1, 0.1, PI].map(|a| beam(a).part(4)), [0, 1, 2, 3]);
    }
}
