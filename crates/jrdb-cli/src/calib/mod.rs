//! Frames of a dataset as the calibration check wants them, and its report in words.

mod floors;
mod frame;
mod gross;

use jrdb_projection::nalgebra::{UnitQuaternion, Vector3};
use serde::Serialize;

use crate::Error;

pub use floors::{floor_lines, tilted_more};
pub use frame::{BaseSweep, CalibFrame, Mounts, base_sweeps, with_views};
pub use gross::{GrossError, gross_errors};

/// An error added to mounts, to see what the check makes of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Plant {
    /// Added to the yaw, degrees, counter-clockwise from above.
    pub yaw_deg: f64,
    /// Added to the height, metres.
    pub height_m: f64,
    /// LiDARs that get it; all when empty.
    pub lidars: Vec<String>,
}

impl Plant {
    /// Whether nothing is added.
    #[must_use]
    pub fn is_nothing(&self) -> bool {
        self.yaw_deg == 0.0 && self.height_m == 0.0
    }

    /// Whether a LiDAR gets it.
    #[must_use]
    pub fn concerns(&self, lidar: &str) -> bool {
        self.lidars.is_empty() || self.lidars.iter().any(|name| name == lidar)
    }

    /// The mounts with the error: each LiDAR turned about its own origin, and raised.
    ///
    /// # Errors
    /// When the error is not finite or there is no LiDAR that should get it.
    pub fn apply(&self, mounts: &Mounts) -> Result<Mounts, Error> {
        let known: Vec<&String> = mounts.keys().collect();
        if let Some(name) = self.lidars.iter().find(|name| !known.contains(name)) {
            return Err(Error::Usage(format!("expected a LiDAR of {known:?}, found {name:?}")));
        }
        if !(self.yaw_deg.is_finite() && self.height_m.is_finite()) {
            let found = format!("{}° and {} m", self.yaw_deg, self.height_m);
            return Err(Error::Usage(format!("expected a finite error to plant, found {found}")));
        }
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), self.yaw_deg.to_radians());
        let mut mounts = mounts.clone();
        for (_, mount) in mounts.iter_mut().filter(|(name, _)| self.concerns(name)) {
            mount.rotation = turn * mount.rotation;
            mount.translation.vector.z += self.height_m;
        }
        Ok(mounts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use jrdb_projection::nalgebra::{Isometry3, Point3};

    #[test]
    fn a_planted_error_moves_the_points_by_itself() {
        let at = Isometry3::from_parts(
            Vector3::new(0.0, 0.0, 0.3).into(),
            UnitQuaternion::from_euler_angles(0.0, 0.0, 0.1),
        );
        let mounts = Mounts::from([("a".into(), at), ("b".into(), at)]);
        let plant = Plant { yaw_deg: 90.0, height_m: 0.2, lidars: vec!["b".into()] };
        let planted = plant.apply(&mounts).unwrap();
        assert_eq!(planted["a"], mounts["a"]);
        let [before, after] =
            [&mounts, &planted].map(|mounts| mounts["b"] * Point3::new(1.0, 0.0, 0.0));
        assert!((after - Point3::new(-before.y, before.x, before.z + 0.2)).norm() < 1e-12);
        let stranger = Plant { lidars: vec!["c".into()], ..plant };
        let error = stranger.apply(&mounts).unwrap_err().to_string();
        assert_eq!(error, r#"expected a LiDAR of ["a", "b"], found "c""#);
    }
}
