//! Small movements of a LiDAR about itself.

use nalgebra::{Isometry3, Point3, Rotation3, Vector3};
use serde::{Deserialize, Serialize};

/// A way in which a LiDAR can be mounted wrongly.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Freedom {
    /// Turned about the z axis, counter-clockwise from above; radians.
    Yaw,
    /// Turned about the y axis, nose down; radians.
    Pitch,
    /// Turned about the x axis, left side up; radians.
    Roll,
    /// Along the z axis, up; metres.
    Height,
}

impl Freedom {
    /// All, in the order of the numbers in a [`Motion`].
    pub const ALL: [Self; 4] = [Self::Yaw, Self::Pitch, Self::Roll, Self::Height];
}

/// A movement of a LiDAR in the base frame: turned about its own origin by `Rz(yaw) Ry(pitch) Rx(roll)`,
/// then raised.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Motion {
    /// About z, radians.
    pub yaw_rad: f64,
    /// About y, radians.
    pub pitch_rad: f64,
    /// About x, radians.
    pub roll_rad: f64,
    /// Along z, metres.
    pub height_m: f64,
}

impl Motion {
    /// The transform `after_from_before` of points of the base frame for a LiDAR at `origin`.
    #[must_use]
    pub fn about(&self, origin: &Point3<f64>) -> Isometry3<f64> {
        let turn = Rotation3::from_euler_angles(self.roll_rad, self.pitch_rad, self.yaw_rad);
        let shift = origin.coords - turn * origin.coords + Vector3::z() * self.height_m;
        Isometry3::from_parts(shift.into(), turn.into())
    }

    /// One of its numbers, radians or metres.
    #[must_use]
    pub fn get(&self, freedom: Freedom) -> f64 {
        match freedom {
            Freedom::Yaw => self.yaw_rad,
            Freedom::Pitch => self.pitch_rad,
            Freedom::Roll => self.roll_rad,
            Freedom::Height => self.height_m,
        }
    }

    /// The same with one number replaced.
    #[must_use]
    pub fn with(mut self, freedom: Freedom, value: f64) -> Self {
        match freedom {
            Freedom::Yaw => self.yaw_rad = value,
            Freedom::Pitch => self.pitch_rad = value,
            Freedom::Roll => self.roll_rad = value,
            Freedom::Height => self.height_m = value,
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn it_turns_about_the_lidar_and_then_rises() {
        let origin = Point3::new(1.0, 0.0, 0.5);
        let motion = Motion { yaw_rad: FRAC_PI_2, height_m: 0.1, ..Motion::default() };
        let moved = motion.about(&origin) * Point3::new(3.0, 0.0, 0.5);
        assert!((moved - Point3::new(1.0, 2.0, 0.6)).norm() < 1e-12);
    }

    #[test]
    fn pitch_is_nose_down_and_roll_left_side_up() {
        let moved = |motion: Motion, x, y| motion.about(&Point3::origin()) * Point3::new(x, y, 0.0);
        assert!(moved(Motion { pitch_rad: 0.1, ..Motion::default() }, 1.0, 0.0).z < -0.09);
        assert!(moved(Motion { roll_rad: 0.1, ..Motion::default() }, 0.0, 1.0).z > 0.09);
    }

    #[test]
    fn numbers_come_back_as_they_were_set() {
        for freedom in Freedom::ALL {
            assert_eq!(Motion::default().with(freedom, 0.3).get(freedom), 0.3);
        }
    }
}
