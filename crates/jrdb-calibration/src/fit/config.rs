//! Every number that shapes the comparison of cloud and image.

use serde::{Deserialize, Serialize};

use crate::Error;
use crate::config::expect;

/// Most steps of a search on either side: bounds the time that a configuration can ask for.
const MAX_STEPS: f64 = 500.0;
/// Steps on either side of the best one that its parabola is fitted to.
pub(super) const PARABOLA_STEPS: usize = 3;

/// Configuration of [`crate::check_fit`] and [`crate::refine`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FitConfig {
    /// Largest yaw that counts as consistent, radians. 1°: JRDB's panorama is put together from five viewpoints
    /// 6 cm off its axis, which moves nine tenths of its far points by up to 11 columns, 1.05°.
    pub yaw_tolerance_rad: f64,
    /// Largest height that counts as consistent, metres. 6 cm: 7 rows at 4 m in JRDB's official panorama, which is
    /// what its rows are off for far points (median over measured pairs of camera and panorama pixels). At
    /// 5 cm one of three bundled scenes, which have no error, was called off.
    pub height_tolerance_m: f64,
    /// Standard deviation of a height that no scatter between sectors shows, metres, added in quadrature. 0.02 m: an
    /// outline lies a little behind the last beam that meets the thing, and a LiDAR above the camera sees past it.
    /// In twelve drawn scenes without error, heights came out 0.010 m (LiDAR 0.14 m below the camera) and
    /// 0.034 m (0.34 m above it) too large in the mean, 0.01 m being scatter.
    pub height_bias_m: f64,
    /// The same for pitch and roll of [`crate::refine`], radians. 0.3°: root mean square of what refinement finds in
    /// drawn scenes without error.
    pub tilt_bias_rad: f64,
    /// Yaws searched on either side, radians. 6°: a wrong yaw that is larger is seen at a glance.
    pub yaw_range_rad: f64,
    /// Heights searched on either side, metres. 0.3 m: a larger error is seen at a glance.
    pub height_range_m: f64,
    /// Step of the search for the yaw, radians. 0.1° is about one column of a JRDB panorama.
    pub yaw_step_rad: f64,
    /// Step of the search for the height, metres. 0.02 m is 3 rows at 3 m in a JRDB panorama.
    pub height_step_m: f64,
    /// Standard deviation of the Gaussian that smooths the image before its gradient, pixels: about the
    /// distance of neighbouring LiDAR points of a ring in a JRDB panorama.
    pub blur_px: f64,
    /// A near surface ends between two beams when the step of the inverse range, relative to the nearer one, is
    /// this much larger than the steps on both sides (a plane has equal steps). 0.1 is a chair 0.3 m before
    /// a wall at 3 m; the results on real and drawn scenes are the same from 0.05 to 0.2.
    pub min_jump: f64,
    /// Beams closer in elevation than this are one ring, and rings are not thicker, radians. 0.5°: between
    /// the noise of a ring (0.05°) and the distance of rings (2° in a 16-beam LiDAR).
    pub ring_rad: f64,
    /// Width of a column of beams one above the other, radians. 0.4°: the turn of a 16-beam LiDAR at 20 Hz,
    /// so that each ring has a point in nearly every column.
    pub column_rad: f64,
    /// Equal sectors of azimuth that are left out one at a time for the uncertainty. 16 of 22.5°: wide
    /// enough that hardly any edge is in two.
    pub sectors: usize,
    /// Fewer edges tell nothing. 60: four for each of the sixteen sectors.
    pub min_edges: usize,
    /// The image's edges must lie on the cloud's edges more than elsewhere by this many standard errors over the
    /// sectors. 4: of 72 sweeps of real and drawn scenes turned by 60° to 300°, so that they belong elsewhere, one
    /// reached that at its best yaw; all that were not turned did.
    pub min_significance: f64,
    /// Standard errors that uncertainty counts for: an offset is judged when this many are within the
    /// tolerance, or when it is beyond the tolerance by this many. 2: nineteen times of twenty.
    pub coverage: f64,
}

impl Default for FitConfig {
    /// Values from one real JRDB frame and four drawn ones; see each field.
    fn default() -> Self {
        Self {
            yaw_tolerance_rad: 1.0_f64.to_radians(),
            height_tolerance_m: 0.06,
            height_bias_m: 0.02,
            tilt_bias_rad: 0.3_f64.to_radians(),
            yaw_range_rad: 6.0_f64.to_radians(),
            height_range_m: 0.3,
            yaw_step_rad: 0.1_f64.to_radians(),
            height_step_m: 0.02,
            blur_px: 2.0,
            min_jump: 0.1,
            ring_rad: 0.5_f64.to_radians(),
            column_rad: 0.4_f64.to_radians(),
            sectors: 16,
            min_edges: 60,
            min_significance: 4.0,
            coverage: 2.0,
        }
    }
}

impl FitConfig {
    pub(super) fn check(&self) -> Result<(), Error> {
        let positive = [
            ("yaw_tolerance_rad", self.yaw_tolerance_rad),
            ("height_tolerance_m", self.height_tolerance_m),
            ("height_bias_m", self.height_bias_m),
            ("tilt_bias_rad", self.tilt_bias_rad),
            ("blur_px", self.blur_px),
            ("min_jump", self.min_jump),
            ("ring_rad", self.ring_rad),
            ("column_rad", self.column_rad),
            ("coverage", self.coverage),
        ];
        for (field, value) in positive {
            let proper = value.is_finite() && value > 0.0;
            expect(proper, (field, "finite and over 0", value.to_string()))?;
        }
        let searches = [
            ("yaw_step_rad", self.yaw_range_rad, self.yaw_step_rad),
            ("height_step_m", self.height_range_m, self.height_step_m),
        ];
        for (field, range, step) in searches {
            let steps = range / step;
            let proper = step > 0.0 && (PARABOLA_STEPS as f64..=MAX_STEPS).contains(&steps);
            expect(proper, (field, "between 1/500 and 1/3 of its range", step.to_string()))?;
        }
        let yaw = self.yaw_range_rad.to_string();
        expect(self.yaw_range_rad < 1.0, ("yaw_range_rad", "less than 1", yaw))?;
        let blur = self.blur_px.to_string();
        expect(self.blur_px <= 20.0, ("blur_px", "at most 20", blur))?;
        let thin = [("ring_rad", self.ring_rad), ("column_rad", self.column_rad)];
        for (field, angle) in thin {
            expect(angle >= 1e-3, (field, "at least 0.001", angle.to_string()))?;
        }
        let sectors = self.sectors.to_string();
        expect((4..=360).contains(&self.sectors), ("sectors", "from 4 to 360", sectors))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(change: impl Fn(&mut FitConfig)) -> String {
        let mut config = FitConfig::default();
        change(&mut config);
        config.check().unwrap_err().to_string()
    }

    #[test]
    fn the_default_is_in_its_own_bounds() {
        assert_eq!(FitConfig::default().check(), Ok(()));
    }

    #[test]
    fn a_bad_threshold_is_named() {
        assert_eq!(error(|c| c.sectors = 1), "expected sectors to be from 4 to 360, found 1");
        assert!(error(|c| c.blur_px = f64::NAN).contains("blur_px"));
        assert!(error(|c| c.blur_px = 1e9).contains("blur_px"));
        assert!(error(|c| c.column_rad = 1e-12).contains("column_rad"));
        assert!(error(|c| c.yaw_range_rad = 7.0).contains("yaw"));
    }

    #[test]
    fn a_search_that_would_take_forever_is_refused() {
        assert!(error(|c| c.height_step_m = 1e-9).contains("height_step_m"));
        assert!(error(|c| c.yaw_step_rad = 0.0).contains("yaw_step_rad"));
    }

    #[test]
    fn a_misspelt_threshold_is_refused() {
        assert!(serde_json::from_str::<FitConfig>(r#"{"blur": 5.0}"#).is_err());
    }
}
