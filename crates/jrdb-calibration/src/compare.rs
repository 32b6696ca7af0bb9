//! Do several LiDARs, brought into the base frame by their calibration, see one floor?

use jrdb_types::calibration::{FloorAgreement, FloorDifference, SensorFloor};
use nalgebra::Point3;

use crate::{Error, FloorConfig, fit_floor};

/// Finds the floor of every LiDAR and compares each pair: a first check of their mounts.
///
/// `clouds` are names with points in the base frame (x forward, y left, z up; metres). A wrong height, roll
/// or pitch of a mount shows; a wrong yaw or shift along the floor cannot.
///
/// ```
/// use jrdb_calibration::{FloorConfig, compare_floors, nalgebra::Point3};
/// let at = |i: i32| f64::from(i) * 0.25;
/// let floor = |z: f64| -> Vec<Point3<f64>> {
///     (-20..20).flat_map(|i| (-20..20).map(move |j| Point3::new(at(i), at(j), z))).collect()
/// };
/// let (upper, lower) = (floor(-0.90), floor(-0.93));
/// let found = compare_floors(&[("upper", &upper), ("lower", &lower)], &FloorConfig::default())?;
/// assert!((found.differences[0].height_m + 0.03).abs() < 1e-9);
/// # Ok::<(), jrdb_calibration::Error>(())
/// ```
///
/// # Errors
/// [`Error::Sensor`] names the first LiDAR that has no floor, with the reason.
pub fn compare_floors(
    clouds: &[(&str, &[Point3<f64>])],
    config: &FloorConfig,
) -> Result<FloorAgreement, Error> {
    let floors = clouds
        .iter()
        .map(|(sensor, points)| match fit_floor(points, config) {
            Ok(floor) => Ok(SensorFloor { sensor: (*sensor).into(), floor }),
            Err(source) => Err(Error::Sensor { sensor: (*sensor).into(), source: source.into() }),
        })
        .collect::<Result<Vec<_>, _>>()?;
    let pairs = (0..floors.len()).flat_map(|i| (i + 1..floors.len()).map(move |j| (i, j)));
    let differences = pairs.map(|(i, j)| difference(&floors[i], &floors[j])).collect();
    Ok(FloorAgreement { floors, differences })
}

fn difference(first: &SensorFloor, second: &SensorFloor) -> FloorDifference {
    FloorDifference {
        first: first.sensor.clone(),
        second: second.sensor.clone(),
        height_m: second.floor.height_m - first.floor.height_m,
        tilt_rad: first.floor.angle_to_rad(&second.floor),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene;
    use nalgebra::{Rotation3, Vector3};
    use std::error::Error as _;

    #[test]
    fn a_mount_that_is_too_high_and_pitched_shows() {
        let upper = scene::cluttered();
        let pitch = Rotation3::from_axis_angle(&Vector3::y_axis(), 0.02);
        let lower: Vec<_> = upper.iter().map(|p| pitch * p + Vector3::z() * 0.04).collect();
        let clouds: [(&str, &[Point3<f64>]); 2] = [("upper", &upper), ("lower", &lower)];
        let found = compare_floors(&clouds, &FloorConfig::default()).unwrap();
        let FloorDifference { first, second, height_m, tilt_rad } = &found.differences[0];
        assert_eq!((first.as_str(), second.as_str()), ("upper", "lower"));
        assert!((height_m - 0.04).abs() < 0.002, "{height_m} m");
        assert!((tilt_rad - 0.02).abs() < 0.001, "{tilt_rad} rad");
    }

    #[test]
    fn three_lidars_are_three_pairs_and_equal_ones_agree() {
        let points = scene::cluttered();
        let clouds: Vec<(&str, &[Point3<f64>])> = ["a", "b", "c"].map(|n| (n, &*points)).into();
        let found = compare_floors(&clouds, &FloorConfig::default()).unwrap();
        let pairs: Vec<_> =
            found.differences.iter().map(|d| (d.first.as_str(), d.second.as_str())).collect();
        assert_eq!(pairs, [("a", "b"), ("a", "c"), ("b", "c")]);
        assert!(found.differences.iter().all(|d| d.height_m == 0.0 && d.tilt_rad < 1e-12));
    }

    #[test]
    fn the_lidar_without_a_floor_is_named_with_the_reason() {
        let points = scene::cluttered();
        let error = compare_floors(&[("upper", &points), ("lower", &[])], &FloorConfig::default())
            .unwrap_err();
        assert_eq!(error.to_string(), r#"no floor in the cloud of "lower""#);
        assert!(error.source().unwrap().to_string().starts_with("expected at least 50 points"));
    }
}
