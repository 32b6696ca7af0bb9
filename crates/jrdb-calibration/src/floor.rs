//! The floor of one cloud: a vote finds it, least squares make it exact.

use jrdb_types::calibration::Floor;
use nalgebra::{Point3, Vector3};

use crate::plane::{self, Fit, Plane};
use crate::{Error, FloorConfig, vote};

/// Rounds of least squares, should the points on the plane not settle before; real clouds need 3 to 15.
const MAX_ROUNDS: usize = 50;

/// Finds the floor in a cloud in the base frame (x forward, y left, z up; metres).
///
/// Three steps, none of which depends on the order of the points:
///
/// 1. Of every square of the ground only the lowest point is kept, so that area counts and not how many
///    points the LiDAR put there.
/// 2. These vote for planes over a grid of all tilts and heights allowed (a Hough transform). The floor is the
///    *lowest* strong plane, so that neither a table nor a ceiling is taken for it.
/// 3. Total least squares over all points near that plane, repeated until the same points remain.
///
/// ```
/// use jrdb_calibration::{FloorConfig, fit_floor, nalgebra::Point3};
/// let at = |i: i32| f64::from(i) * 0.25;
/// let points: Vec<_> =
///     (-20..20).flat_map(|i| (-20..20).map(move |j| Point3::new(at(i), at(j), -0.9))).collect();
/// let floor = fit_floor(&points, &FloorConfig::default())?;
/// assert!((floor.height_m + 0.9).abs() < 1e-9 && floor.tilt_rad() < 1e-9);
/// assert_eq!(floor.inliers, 1600);
/// # Ok::<(), jrdb_calibration::Error>(())
/// ```
///
/// # Errors
/// [`Error::BadConfig`]; [`Error::NonFinite`] and [`Error::TooFewPoints`] for the points; and
/// [`Error::NoFloor`], [`Error::TooNarrow`], [`Error::TooTilted`] and [`Error::NotFlat`] when the lowest strong
/// plane is no floor.
pub fn fit_floor(points: &[Point3<f64>], config: &FloorConfig) -> Result<Floor, Error> {
    config.check()?;
    let points = near_points(points, config)?;
    let voters = vote::lowest_of_cells(&points, config.cell_m);
    let start = vote::lowest_strong_plane(&voters, config)
        .ok_or(Error::NoFloor { expected: config.min_inliers, found: 0 })?;
    let (fit, inliers) = refine(&points, start, config)?;
    check(&fit, config)?;
    Ok(Floor {
        normal: fit.plane.normal.into(),
        height_m: fit.plane.height_m(),
        inliers,
        rms_m: fit.rms_m,
    })
}

/// The points in range, sorted: equal sets of points give equal sums to the last bit.
fn near_points(points: &[Point3<f64>], config: &FloorConfig) -> Result<Vec<Point3<f64>>, Error> {
    let finite = |point: &Point3<f64>| point.iter().all(|v| v.is_finite());
    if let Some(index) = points.iter().position(|point| !finite(point)) {
        return Err(Error::NonFinite { index, found: points[index] });
    }
    let near = |point: &&Point3<f64>| point.x.hypot(point.y) <= config.range_m;
    let mut points: Vec<Point3<f64>> = points.iter().filter(near).copied().collect();
    let (expected, found, range_m) = (config.min_inliers, points.len(), config.range_m);
    if found < expected {
        return Err(Error::TooFewPoints { expected, found, range_m });
    }
    points.sort_by(|p, q| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)).then(p.z.total_cmp(&q.z)));
    Ok(points)
}

/// Trimmed least squares: fits the points near the plane, then those near the fitted plane, until they
/// stay the same. Returns the fit and how many points it rests on.
fn refine(
    points: &[Point3<f64>],
    start: Plane,
    config: &FloorConfig,
) -> Result<(Fit, usize), Error> {
    // The vote is only exact to one tolerance, so the first round looks twice as far.
    let mut inside = points_near(points, &start, 2.0 * config.tolerance_m, config)?;
    let mut fit = plane::fit(&inside);
    for _ in 0..MAX_ROUNDS {
        let next = points_near(points, &fit.plane, config.tolerance_m, config)?;
        if next == inside {
            break;
        }
        inside = next;
        fit = plane::fit(&inside);
    }
    Ok((fit, inside.len()))
}

fn points_near(
    points: &[Point3<f64>],
    plane: &Plane,
    reach_m: f64,
    config: &FloorConfig,
) -> Result<Vec<Point3<f64>>, Error> {
    let near = |point: &&Point3<f64>| plane.distance_m(point) <= reach_m;
    let inside: Vec<Point3<f64>> = points.iter().filter(near).copied().collect();
    let (expected, found) = (config.min_inliers, inside.len());
    if found < expected { Err(Error::NoFloor { expected, found }) } else { Ok(inside) }
}

fn check(fit: &Fit, config: &FloorConfig) -> Result<(), Error> {
    let (expected_m, found_m) = (config.min_spread_m, fit.spread_m);
    if found_m < expected_m {
        return Err(Error::TooNarrow { expected_m, found_m });
    }
    let expected_rad = config.max_tilt_rad;
    let found_rad = plane::angle_rad(&fit.plane.normal, &Vector3::z());
    if found_rad > expected_rad {
        return Err(Error::TooTilted { expected_rad, found_rad });
    }
    let (expected_m, found_m) = (config.max_rms_m, fit.rms_m);
    if found_m > expected_m { Err(Error::NotFlat { expected_m, found_m }) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene;
    use nalgebra::Rotation3;
    use proptest::prelude::*;

    fn fit(points: &[Point3<f64>]) -> Result<Floor, Error> {
        fit_floor(points, &FloorConfig::default())
    }

    fn error(points: &[Point3<f64>]) -> String {
        fit(points).unwrap_err().to_string()
    }

    #[test]
    fn an_exact_plane_is_recovered() {
        let floor = fit(&scene::floor(2000, [0.03, -0.02], -0.93)).unwrap();
        let expected = Vector3::new(-0.03, 0.02, 1.0).normalize();
        assert!((Vector3::from(floor.normal) - expected).norm() < 1e-12);
        assert!((floor.height_m + 0.93).abs() < 1e-12 && floor.rms_m < 1e-7);
        assert_eq!(floor.inliers, 2000);
    }

    #[test]
    fn a_noisy_tilted_floor_is_found_within_a_tenth_of_a_degree() {
        for slopes in [[0.0, 0.0], [0.05, 0.0], [0.0, -0.08], [-0.05, 0.05]] {
            let points = scene::noisy(&scene::floor(3000, slopes, -0.9), 0.02);
            let floor = fit(&points).unwrap();
            let expected = Plane::from_slopes(slopes, -0.9);
            let angle = plane::angle_rad(&floor.normal.into(), &expected.normal);
            assert!(angle.to_degrees() < 0.1, "{slopes:?}: {:.3} degrees", angle.to_degrees());
            assert!((floor.height_m + 0.9).abs() < 0.005, "{slopes:?}: {} m", floor.height_m);
            assert!((floor.rms_m - 0.02 / 3.0_f64.sqrt()).abs() < 0.001, "{}", floor.rms_m);
        }
    }

    #[test]
    fn sixty_percent_of_people_walls_and_a_big_table_do_not_lift_the_floor() {
        let points = scene::cluttered();
        let floor = fit(&points).unwrap();
        let expected = Plane::from_slopes(scene::SLOPES, scene::HEIGHT_M);
        let angle = plane::angle_rad(&floor.normal.into(), &expected.normal);
        assert!(angle.to_degrees() < 0.1, "{:.3} degrees", angle.to_degrees());
        assert!((floor.height_m - scene::HEIGHT_M).abs() < 0.01, "{}", floor.height_m);
        assert!(floor.inliers < points.len() / 2);
    }

    #[test]
    fn a_table_without_its_floor_is_all_that_there_is() {
        let table = scene::floor(1000, [0.0, 0.0], -0.15);
        assert!((fit(&table).unwrap().height_m + 0.15).abs() < 1e-9);
    }

    #[test]
    fn points_that_are_few_far_or_not_finite_are_errors() {
        let few = "expected at least 50 points within 8 m of the robot, found 0";
        assert_eq!(error(&[]), few);
        let far: Vec<_> =
            scene::floor(100, [0.0, 0.0], -0.9).iter().map(|p| p + Vector3::x() * 1e300).collect();
        assert_eq!(error(&far), few);
        let mut points = scene::floor(100, [0.0, 0.0], -0.9);
        points[7] = Point3::new(1.0, f64::NAN, 0.0);
        assert_eq!(error(&points), "expected finite coordinates, found {1, NaN, 0} at index 7");
    }

    #[test]
    fn a_ramp_is_too_tilted() {
        let ramp = scene::noisy(&scene::floor(3000, [0.0, 0.2], -0.9), 0.01);
        let expected = "expected a floor tilted by at most 5.00 degrees, found 11.3";
        assert!(error(&ramp).starts_with(expected), "{}", error(&ramp));
    }

    #[test]
    fn a_wall_is_too_tilted() {
        let expected = "expected a floor tilted by at most 5.00 degrees, found 90.00 degrees";
        assert_eq!(error(&scene::wall(4000, 3.0)), expected);
    }

    #[test]
    fn a_narrow_ledge_is_no_floor() {
        let floor = scene::floor(20_000, [0.0, 0.0], -0.9);
        let ledge: Vec<_> = floor.into_iter().filter(|p| (p.x - 3.0).abs() < 0.2).collect();
        let expected = "expected floor points that spread at least 0.25 m both ways, found 0.11";
        assert!(error(&ledge).starts_with(expected), "{}", error(&ledge));
    }

    #[test]
    fn a_ceiling_is_no_floor() {
        let ceiling = scene::floor(1000, [0.0, 0.0], 2.3);
        assert_eq!(
            error(&ceiling),
            "expected a floor of at least 50 points, found a best plane of 0"
        );
    }

    #[test]
    fn points_everywhere_are_not_flat() {
        let cloud = scene::noisy(&scene::floor(20_000, [0.0, 0.0], -0.5), 1.5);
        assert!(matches!(fit(&cloud), Err(Error::NotFlat { .. })), "{:?}", fit(&cloud));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        #[test]
        fn the_order_of_the_points_does_not_matter(
            points in Just(scene::cluttered()).prop_shuffle()
        ) {
            prop_assert_eq!(fit(&points), fit(&scene::cluttered()));
        }

        #[test]
        fn turning_the_robot_turns_the_normal_and_keeps_the_height(yaw_rad in -3.2..3.2) {
            let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), yaw_rad);
            let before = fit(&scene::cluttered()).unwrap();
            let turned: Vec<_> = scene::cluttered().iter().map(|point| turn * point).collect();
            let after = fit(&turned).unwrap();
            let expected = turn * Vector3::from(before.normal);
            prop_assert!((Vector3::from(after.normal) - expected).norm() < 1e-9);
            prop_assert!((after.height_m - before.height_m).abs() < 1e-9);
        }

        #[test]
        fn lifting_the_cloud_lifts_the_floor(lift_m in -1.0..1.0_f64) {
            let before = fit(&scene::cluttered()).unwrap();
            let lifted: Vec<_> =
                scene::cluttered().iter().map(|p| p + Vector3::z() * lift_m).collect();
            let after = fit(&lifted).unwrap();
            prop_assert!((after.height_m - before.height_m - lift_m).abs() < 1e-9);
        }
    }
}
