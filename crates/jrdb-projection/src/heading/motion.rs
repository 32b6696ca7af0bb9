//! Motion, and the heading that it tells: people walk the way they face.

use jrdb_types::Heading;
use jrdb_types::vocab::HeadingSource;

use super::config::HeadingConfig;
use crate::relation::wrap_rad;

/// Where something was at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackPoint {
    /// Seconds, from any start.
    pub time_s: f64,
    /// x and y, metres, in a frame that does not move with the robot.
    pub position_m: [f64; 2],
}

/// How something moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Velocity along x and y, metres per second.
    pub velocity_mps: [f64; 2],
    /// Standard deviation of each component of the velocity, metres per second.
    pub std_mps: f64,
}

/// The velocity that fits a track best: least squares over its points. `None` from fewer than two times, or
/// when a number is not finite.
///
/// The positions must be in a frame at rest: seen from a moving robot everybody moves.
///
/// ```
/// use jrdb_projection::heading::motion::{TrackPoint, velocity};
/// let at = |time_s: f64| TrackPoint { time_s, position_m: [2.0 - time_s, 0.5] };
/// let found = velocity(&[at(0.0), at(0.1), at(0.2)], 0.07).unwrap();
/// assert!((found.velocity_mps[0] + 1.0).abs() < 1e-9 && found.velocity_mps[1] == 0.0);
/// ```
#[must_use]
pub fn velocity(track: &[TrackPoint], position_std_m: f64) -> Option<Motion> {
    let count = track.len() as f64;
    let mean_s = track.iter().map(|p| p.time_s).sum::<f64>() / count;
    let spread: f64 = track.iter().map(|p| (p.time_s - mean_s).powi(2)).sum();
    let slope = |axis: usize| {
        let mean_m = track.iter().map(|p| p.position_m[axis]).sum::<f64>() / count;
        let product = |p: &TrackPoint| (p.time_s - mean_s) * (p.position_m[axis] - mean_m);
        track.iter().map(product).sum::<f64>() / spread
    };
    let motion =
        Motion { velocity_mps: [slope(0), slope(1)], std_mps: position_std_m / spread.sqrt() };
    let is_finite = motion.velocity_mps.iter().all(|v| v.is_finite()) && motion.std_mps.is_finite();
    is_finite.then_some(motion)
}

/// The heading of somebody who moves: the way of the velocity. `None` when slower than `motion_min_mps` or than
/// twice the velocity's own deviation.
#[must_use]
pub fn heading(motion: &Motion, config: &HeadingConfig) -> Option<Heading> {
    let [x, y] = motion.velocity_mps;
    let speed_mps = x.hypot(y);
    let moves = speed_mps >= config.motion_min_mps && speed_mps >= 2.0 * motion.std_mps;
    moves.then(|| Heading {
        angle_rad: wrap_rad(y.atan2(x)),
        std_rad: (motion.std_mps / speed_mps).hypot(config.motion_body_std_rad),
        source: HeadingSource::Motion,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn walk(speed_mps: f64) -> Vec<TrackPoint> {
        let at = |i: i32| {
            let time_s = f64::from(i) / 15.0;
            TrackPoint { time_s, position_m: [1.0, 2.0 + speed_mps * time_s] }
        };
        (0..8).map(at).collect()
    }

    #[test]
    fn who_walks_to_the_left_faces_left() {
        let motion = velocity(&walk(1.2), 0.05).unwrap();
        let found = heading(&motion, &HeadingConfig::default()).unwrap();
        assert!((found.angle_rad - std::f64::consts::FRAC_PI_2).abs() < 1e-9);
        assert!(found.std_rad > HeadingConfig::default().motion_body_std_rad);
    }

    #[test]
    fn who_stands_has_no_heading_by_motion() {
        let motion = velocity(&walk(0.1), 0.05).unwrap();
        assert_eq!(heading(&motion, &HeadingConfig::default()), None);
        let one_time = [walk(1.0)[0], walk(1.0)[0]];
        assert_eq!(velocity(&one_time, 0.05), None);
        assert_eq!(velocity(&[], 0.05), None);
    }
}
