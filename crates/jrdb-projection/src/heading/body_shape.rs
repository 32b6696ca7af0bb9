//! The line of the shoulders, from the shape of the body in the cloud.

use nalgebra::{Matrix2, Vector2};

use super::config::HeadingConfig;
use crate::BaseCloud;

/// Where the shoulders run: known up to half a turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShoulderLine {
    /// The direction at right angles to the shoulders, radians counter-clockwise from +x: the front, or the back.
    pub normal_rad: f64,
    /// Standard deviation, radians.
    pub std_rad: f64,
}

/// The principal axis of a body's points, seen from above; `None` from too few points (`shape_min_points`) or
/// without a clear axis (`shape_min_elongation`).
///
/// A body is wider than deep. A LiDAR sees the side towards it only: whoever stands in profile shows a short line
/// along the line of sight, or none.
#[must_use]
pub fn shoulder_line(
    cloud: &BaseCloud,
    used: &[u32],
    config: &HeadingConfig,
) -> Option<ShoulderLine> {
    if used.len() < config.shape_min_points {
        return None;
    }
    let body: Vec<Vector2<f64>> =
        used.iter().map(|&i| cloud.point(i as usize).xy().coords).collect();
    let mean = body.iter().sum::<Vector2<f64>>() / body.len() as f64;
    let spread: Matrix2<f64> = body.iter().map(|p| (p - mean) * (p - mean).transpose()).sum();
    let axes = spread.symmetric_eigen();
    let wide = axes.eigenvalues.imax();
    let [long, short] = [axes.eigenvalues[wide], axes.eigenvalues[1 - wide]].map(f64::sqrt);
    let normal = axes.eigenvectors.column(1 - wide).into_owned();
    let is_clear = long >= config.shape_min_elongation * short;
    is_clear.then(|| ShoulderLine {
        normal_rad: normal.y.atan2(normal.x),
        std_rad: config.shape_std_rad,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of an upright sheet, 0.45 m wide, its normal at `normal_rad`, 3 m ahead.
    fn sheet(normal_rad: f64, count: usize) -> BaseCloud {
        let (mut x, mut y, mut z) = (Vec::new(), Vec::new(), Vec::new());
        for i in 0..count {
            let along = (i % 20) as f64 / 20.0 * 0.45 - 0.225;
            x.push((3.0 - normal_rad.sin() * along) as f32);
            y.push((normal_rad.cos() * along) as f32);
            z.push(1.6 * (i / 20) as f32 / (count / 20) as f32 - 0.8);
        }
        BaseCloud { x, y, z, ..BaseCloud::default() }
    }

    #[test]
    fn the_shoulders_run_across_the_front() {
        let cloud = sheet(0.4, 400);
        let used: Vec<u32> = (0..400).collect();
        let found = shoulder_line(&cloud, &used, &HeadingConfig::default()).unwrap();
        let off = (found.normal_rad - 0.4).rem_euclid(std::f64::consts::PI);
        assert!(off.min(std::f64::consts::PI - off) < 1e-3, "{found:?}");
    }

    #[test]
    fn a_few_points_show_no_shoulders() {
        let cloud = sheet(0.4, 60);
        let used: Vec<u32> = (0..60).collect();
        assert_eq!(shoulder_line(&cloud, &used, &HeadingConfig::default()), None);
        assert_eq!(shoulder_line(&cloud, &[], &HeadingConfig::default()), None);
    }
}
