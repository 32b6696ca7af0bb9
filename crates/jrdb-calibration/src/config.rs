//! Every number that shapes the search for the floor.

use serde::{Deserialize, Serialize};

use crate::Error;

/// Steepest tilt that may be allowed: above it a floor is no longer told from a wall by its heights.
const STEEPEST_RAD: f64 = std::f64::consts::FRAC_PI_6;
/// Largest ratio of a length searched to the tolerance: bounds the time and memory of the vote.
const MAX_STEPS: f64 = 400.0;

/// Configuration of [`crate::fit_floor`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FloorConfig {
    /// Points farther from the z axis are not looked at, metres. JRDB's upper LiDAR sees the floor from 4 m
    /// on; in a real frame what it sees of it within 8 m lies in one plane (6 mm rms), and beyond, some
    /// lies 0.1 m lower.
    pub range_m: f64,
    /// Lowest and highest z that the floor may have under the base frame's origin, metres. Holds JRDB's
    /// base (0.9 m above the floor), KITTI's LiDAR (1.73 m above) and a base on the floor.
    pub height_range_m: [f64; 2],
    /// Largest angle between the floor's normal and the z axis, radians. 5° is generous for loose mounts
    /// and soft tyres; the real JRDB floors measured tilt by about 0.5°, KITTI's roads by about 1°.
    pub max_tilt_rad: f64,
    /// Only the lowest point of each square of this side votes, metres: a person who stands there has a few
    /// votes, not hundreds, and a piece of floor has as many near the robot as far away. About the length
    /// of a foot; smaller squares are empty between the LiDAR's rings.
    pub cell_m: f64,
    /// Points at most this far from the plane are on it, metres: two and a half to eight times the rms of the
    /// real floors measured, for noise, unevenness and the quantised ranges of the LiDAR.
    pub tolerance_m: f64,
    /// The floor is the lowest plane that has at least this share of the votes of the best plane. In the
    /// real sweep where furniture hides most of the floor, the floor has 0.73 of the best plane's votes.
    pub strong_share: f64,
    /// Of planes whose heights differ by at most this only the strongest counts, metres: more than a
    /// step or kerb (0.2 m), less than a seat (0.45 m).
    pub separation_m: f64,
    /// Fewer points do not make a floor. The sparsest real floor measured has five times as many.
    pub min_inliers: usize,
    /// Least standard deviation of the floor's points along their narrower direction, metres; a strip
    /// one metre wide has 0.29.
    pub min_spread_m: f64,
    /// Largest root mean square distance of the floor's points from their plane, metres. Whole real floors
    /// had 0.006 to 0.019; planes through clutter, in halves of the same sweeps, 0.021 to 0.027. Points
    /// that fill the slab evenly have `tolerance_m / √3`: change both together.
    pub max_rms_m: f64,
}

impl Default for FloorConfig {
    /// Values from measurements on four JRDB and two KITTI sweeps; see each field.
    fn default() -> Self {
        Self {
            range_m: 8.0,
            height_range_m: [-2.5, 0.5],
            max_tilt_rad: 5.0_f64.to_radians(),
            cell_m: 0.2,
            tolerance_m: 0.05,
            strong_share: 0.5,
            separation_m: 0.3,
            min_inliers: 50,
            min_spread_m: 0.25,
            max_rms_m: 0.02,
        }
    }
}

impl FloorConfig {
    pub(crate) fn check(&self) -> Result<(), Error> {
        self.check_lengths()?;
        let [low, high] = self.height_range_m;
        let steps = self.range_m.max(high - low) / self.tolerance_m;
        expect(
            (0.0..=1.0).contains(&self.strong_share),
            ("strong_share", "in [0, 1]", self.strong_share.to_string()),
        )?;
        expect(
            0.0 < self.max_tilt_rad && self.max_tilt_rad <= STEEPEST_RAD,
            ("max_tilt_rad", "over 0 and at most π/6", self.max_tilt_rad.to_string()),
        )?;
        expect(
            low.is_finite() && high.is_finite() && low < high,
            ("height_range_m", "two finite numbers, the lower first", format!("{low}, {high}")),
        )?;
        expect(
            steps <= MAX_STEPS,
            (
                "tolerance_m",
                "at least 1/400 of range_m and of the height range",
                self.tolerance_m.to_string(),
            ),
        )?;
        expect(self.min_inliers >= 3, ("min_inliers", "at least 3", self.min_inliers.to_string()))
    }

    fn check_lengths(&self) -> Result<(), Error> {
        let lengths = [
            ("range_m", self.range_m),
            ("cell_m", self.cell_m),
            ("tolerance_m", self.tolerance_m),
            ("separation_m", self.separation_m),
            ("min_spread_m", self.min_spread_m),
            ("max_rms_m", self.max_rms_m),
        ];
        lengths.into_iter().try_for_each(|(field, length)| {
            let proper = length.is_finite() && length > 0.0;
            expect(proper, (field, "finite and over 0", length.to_string()))
        })
    }
}

pub(crate) fn expect(
    holds: bool,
    (field, expected, found): (&'static str, &'static str, String),
) -> Result<(), Error> {
    if holds { Ok(()) } else { Err(Error::BadConfig { field, expected, found }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(change: impl Fn(&mut FloorConfig)) -> String {
        let mut config = FloorConfig::default();
        change(&mut config);
        config.check().unwrap_err().to_string()
    }

    #[test]
    fn the_default_is_in_its_own_bounds() {
        assert_eq!(FloorConfig::default().check(), Ok(()));
    }

    #[test]
    fn a_bad_threshold_is_named() {
        assert_eq!(
            error(|c| c.range_m = f64::NAN),
            "expected range_m to be finite and over 0, found NaN"
        );
        assert_eq!(
            error(|c| c.height_range_m = [0.0, -1.0]),
            "expected height_range_m to be two finite numbers, the lower first, found 0, -1"
        );
        assert!(error(|c| c.max_tilt_rad = 1.0).contains("max_tilt_rad"));
        assert!(error(|c| c.strong_share = 1.5).contains("strong_share"));
        assert!(error(|c| c.min_inliers = 2).contains("min_inliers"));
    }

    #[test]
    fn a_tolerance_that_would_take_forever_is_refused() {
        assert!(error(|c| c.tolerance_m = 1e-9).starts_with("expected tolerance_m"));
        assert!(error(|c| c.height_range_m = [-1e300, 1e300]).starts_with("expected tolerance_m"));
    }

    #[test]
    fn a_misspelt_threshold_is_refused_and_an_absent_one_is_the_default() {
        assert!(serde_json::from_str::<FloorConfig>(r#"{"range": 5.0}"#).is_err());
        let config: FloorConfig = serde_json::from_str(r#"{"range_m": 5.0}"#).unwrap();
        assert_eq!(config, FloorConfig { range_m: 5.0, ..FloorConfig::default() });
    }
}
