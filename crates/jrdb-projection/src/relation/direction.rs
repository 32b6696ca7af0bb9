//! Direction in words.

use jrdb_types::vocab::{Elevation, Sector};
use jrdb_types::{Direction, LateralConvention};
use nalgebra::Vector3;

/// Something farther up or down than this is not level any more, metres (JRDB-Reasoning
/// `Position_relative_to_Ref`).
pub const LEVEL_RISE_MAX_M: f64 = 1.5;

/// The words for where a vector points to, in a frame of x ahead, y left, z up.
///
/// The sector depends on the angle `atan2(y, x)` in degrees, counter-clockwise, with the benchmark's
/// bounds (JRDB-Reasoning `Position_relative_to_Ref` as it was before left and right were exchanged):
/// `[-30, 30]` front, `(30, 45]` front left, `(45, 135]` left, `(135, 145]` back left, `(-45, -30)` front
/// right, `(-135, -45]` right, `(-145, -135]` back right, else back.
/// [`LateralConvention::EngineHead`] gives the mirrored name.
#[must_use]
pub fn of_vector(vector: &Vector3<f64>, lateral: LateralConvention) -> Direction {
    let physical = sector_of_degrees(vector.y.atan2(vector.x).to_degrees());
    let sector = match lateral {
        LateralConvention::Physical => physical,
        LateralConvention::EngineHead => physical.mirrored(),
    };
    Direction { sector, elevation: elevation(vector.z) }
}

fn sector_of_degrees(angle: f64) -> Sector {
    match angle {
        a if (-30.0..=30.0).contains(&a) => Sector::Front,
        a if a > 30.0 && a <= 45.0 => Sector::FrontLeft,
        a if a > 45.0 && a <= 135.0 => Sector::Left,
        a if a > 135.0 && a <= 145.0 => Sector::BackLeft,
        a if a > -45.0 && a < -30.0 => Sector::FrontRight,
        a if a > -135.0 && a <= -45.0 => Sector::Right,
        a if a > -145.0 && a <= -135.0 => Sector::BackRight,
        _ => Sector::Back,
    }
}

/// The word for a height difference, metres: up or down beyond [`LEVEL_RISE_MAX_M`].
#[must_use]
pub fn elevation(rise_m: f64) -> Elevation {
    match rise_m {
        rise if rise > LEVEL_RISE_MAX_M => Elevation::Up,
        rise if rise < -LEVEL_RISE_MAX_M => Elevation::Down,
        _ => Elevation::Level,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn name(angle_deg: f64, z: f64, lateral: LateralConvention) -> String {
        let (sin, cos) = angle_deg.to_radians().sin_cos();
        of_vector(&Vector3::new(cos, sin, z), lateral).to_string()
    }

    #[test]
    fn left_is_left_and_the_engine_mirrors_it() {
        assert_eq!(name(90.0, 0.0, LateralConvention::Physical), "left");
        assert_eq!(name(90.0, 0.0, LateralConvention::EngineHead), "right");
        assert_eq!(name(-40.0, 0.0, LateralConvention::Physical), "front right");
    }

    #[test]
    fn height_is_told_beyond_a_metre_and_a_half() {
        assert_eq!(name(0.0, 1.5, LateralConvention::Physical), "front");
        assert_eq!(name(0.0, 1.6, LateralConvention::Physical), "up front");
        assert_eq!(name(180.0, -1.6, LateralConvention::Physical), "down back");
    }

    #[test]
    fn every_sector_is_where_its_bounds_say() {
        for sector in Sector::ALL {
            let (from, to) = sector.bounds_deg();
            for angle in [from + 0.1, f64::midpoint(from, to), to - 0.1] {
                assert_eq!(name(angle, 0.0, LateralConvention::Physical), sector.word(), "{angle}");
            }
        }
    }

    #[test]
    fn shared_bounds_belong_to_the_benchmark_s_sector() {
        let exact = |degrees: f64| sector_of_degrees(degrees).word();
        assert_eq!(
            [exact(30.0), exact(45.0), exact(135.0), exact(145.0)],
            ["front", "front left", "left", "back left"]
        );
        assert_eq!(
            [exact(-30.0), exact(-45.0), exact(-135.0), exact(-145.0)],
            ["front", "right", "back right", "back"]
        );
    }
}
