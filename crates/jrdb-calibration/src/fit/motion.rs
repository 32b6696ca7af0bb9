//! Small movements of a LiDAR about itself.

use jrdb_types::calibration::Motion;
use nalgebra::{Isometry3, Point3, Rotation3, Vector3};

/// The transform `after_from_before` of points of the base frame that a movement of a LiDAR at `origin` makes.
#[must_use]
pub fn about(motion: &Motion, origin: &Point3<f64>) -> Isometry3<f64> {
    let turn = Rotation3::from_euler_angles(motion.roll_rad, motion.pitch_rad, motion.yaw_rad);
    let shift = origin.coords - turn * origin.coords + Vector3::z() * motion.height_m;
    Isometry3::from_parts(shift.into(), turn.into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn it_turns_about_the_lidar_and_then_rises() {
        let origin = Point3::new(1.0, 0.0, 0.5);
        let motion = Motion { yaw_rad: FRAC_PI_2, height_m: 0.1, ..Motion::default() };
        let moved = about(&motion, &origin) * Point3::new(3.0, 0.0, 0.5);
        assert!((moved - Point3::new(1.0, 2.0, 0.6)).norm() < 1e-12);
    }

    #[test]
    fn pitch_is_nose_down_and_roll_left_side_up() {
        let moved =
            |motion: Motion, x, y| about(&motion, &Point3::origin()) * Point3::new(x, y, 0.0);
        assert!(moved(Motion { pitch_rad: 0.1, ..Motion::default() }, 1.0, 0.0).z < -0.09);
        assert!(moved(Motion { roll_rad: 0.1, ..Motion::default() }, 0.0, 1.0).z > 0.09);
    }
}
