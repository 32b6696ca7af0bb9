//! Direction in words.

use jrdb_types::vocab::{Elevation, Sector};
use jrdb_types::{Direction, LateralConvention};
use nalgebra::Vector3;

/// The words for where a vector points to, in a frame of x ahead, y left, z up.
///
/// The sector is that of the angle `atan2(y, x)` in degrees ([`Sector::of_degrees`]), the elevation that of z
/// ([`Elevation::of_rise`]). What points nowhere is in front. [`LateralConvention::BenchmarkMirrored`] gives the mirrored name.
#[must_use]
pub fn of_vector(vector: &Vector3<f64>, lateral: LateralConvention) -> Direction {
    // The signs of two zeros would choose front or back: the sum of -0.0 and 0.0 is 0.0.
    let angle_rad = (vector.y + 0.0).atan2(vector.x + 0.0);
    let sector = Sector::of_degrees(angle_rad.to_degrees()).named(lateral);
    Direction { sector, elevation: Elevation::of_rise(vector.z) }
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
        assert_eq!(name(90.0, 0.0, LateralConvention::BenchmarkMirrored), "right");
        assert_eq!(name(-40.0, 0.0, LateralConvention::Physical), "front right");
    }

    #[test]
    fn what_points_nowhere_is_in_front() {
        for vector in [[0.0, 0.0], [-0.0, 0.0], [0.0, -0.0], [-0.0, -0.0]] {
            let vector = Vector3::new(vector[0], vector[1], 0.0);
            assert_eq!(of_vector(&vector, LateralConvention::Physical).to_string(), "front");
        }
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
}
