//! Yaw and height of each LiDAR against the image.

use jrdb_types::calibration::{Doubt, Finding, FitReport, Freedom, LidarFit, Motion};

use super::evidence::{Edges, Evidence};
use super::score::Curve;
use super::verdict::{finding, verdict};
use super::{FitConfig, View};
use crate::Error;

/// Yaw and height are found in turn, so often: each is found again with the other in place.
const ROUNDS: usize = 3;
/// Share of [`FitConfig::min_significance`] at which one offset is put in place for the search of the other: the edges of
/// a cloud that is off in both are matched poorly at first.
const SETTLING_SHARE: f64 = 0.5;

/// What the curves of a LiDAR come to.
fn lidar_fit(sensor: &str, [yaw, height]: &[Curve; 2], config: &FitConfig) -> LidarFit {
    let (yaw_rad, mut height_m) = (yaw.measure(), height.measure());
    height_m.deviation = height_m.deviation.hypot(config.height_bias_m);
    let yaw = finding(&yaw_rad, config.yaw_tolerance_rad, config);
    // Where not even the columns match, matching rows are chance: floors and ceilings are level everywhere.
    let height = match yaw {
        Finding::CannotTell(doubt @ (Doubt::NoMatch | Doubt::AtBorder)) => {
            Finding::CannotTell(doubt)
        }
        _ => finding(&height_m, config.height_tolerance_m, config),
    };
    LidarFit { sensor: sensor.into(), yaw, height, yaw_rad, height_m }
}

/// Finds how far yaw and height of each LiDAR are off, by the edges of the images.
///
/// An offset that is found is the mount less the truth. The result does not depend on the order of the points
/// or of the sweeps.
///
/// # Errors
/// When there is no sweep, an image is not of its camera's size, a coordinate is not finite, or a threshold is
/// out of its range. Images or clouds that tell nothing are no error but a [`Finding::CannotTell`].
pub fn check_fit(views: &[View<'_>], config: &FitConfig) -> Result<FitReport, Error> {
    let evidence = Evidence::new(views, config)?;
    let (mut lidars, mut pooled) = (Vec::new(), None::<[Curve; 2]>);
    for sensor in evidence.sensors() {
        let curves = curves(&evidence, sensor, config);
        lidars.push(lidar_fit(sensor, &curves, config));
        pooled = Some(match pooled {
            None => curves,
            Some([yaw, height]) => [yaw.plus(&curves[0]), height.plus(&curves[1])],
        });
    }
    let rig = lidar_fit("rig", &pooled.ok_or(Error::NoSweep)?, config);
    let all = verdict(lidars.iter().flat_map(|fit| [fit.yaw, fit.height]));
    Ok(FitReport { lidars, rig, verdict: all })
}

/// Yaw and height curves of one LiDAR, each with the other at its best.
fn curves(evidence: &Evidence<'_>, sensor: &str, config: &FitConfig) -> [Curve; 2] {
    let search = |motion: &Motion, freedom| {
        let (range, step, edges) = match freedom {
            Freedom::Height => (config.height_range_m, config.height_step_m, Edges::Level),
            _ => (config.yaw_range_rad, config.yaw_step_rad, Edges::Upright),
        };
        let steps = (step, (range / step).round() as i32);
        evidence.curve(sensor, (motion, freedom), steps, edges)
    };
    // A best position that is no better than chance must not mislead the other search.
    let settle = |motion: Motion, freedom, curve: &Curve| {
        let measure = curve.measure();
        let likely = measure.significance >= SETTLING_SHARE * config.min_significance;
        let trusted = likely && !measure.at_border;
        motion.with(freedom, if trusted { -measure.offset } else { 0.0 })
    };
    let mut motion = Motion::default();
    let mut curves = None;
    for _ in 0..ROUNDS {
        let yaw = search(&motion, Freedom::Yaw);
        motion = settle(motion, Freedom::Yaw, &yaw);
        let height = search(&motion, Freedom::Height);
        motion = settle(motion, Freedom::Height, &height);
        curves = Some([yaw, height]);
    }
    curves.expect("there is at least one round")
}

#[cfg(test)]
mod tests {
    use super::super::motion::about;
    use super::super::{Sweep, world};
    use super::*;
    use jrdb_types::Image;
    use jrdb_types::calibration::Verdict;
    use nalgebra::Point3;

    /// The world's report, its LiDAR mounted with an error.
    fn report(error: Motion, image: &Image) -> FitReport {
        let (origin, points) = world::sweep(0.1);
        let moved = about(&error, &origin);
        let points: Vec<Point3<f64>> = points.iter().map(|point| moved * point).collect();
        let sweep = Sweep { sensor: "lidar", origin: moved * origin, points: &points };
        let view = View { camera: &world::camera(), image, sweeps: &[sweep] };
        check_fit(&[view], &FitConfig::default()).unwrap()
    }

    #[test]
    fn planted_errors_are_found_and_none_where_none_is() {
        let picture = world::picture();
        for (yaw_deg, height_m) in [(0.0, 0.0), (2.0, 0.0), (-2.0, -0.1), (0.0, 0.1)] {
            let yaw_rad = f64::to_radians(yaw_deg);
            let found = report(Motion { yaw_rad, height_m, ..Motion::default() }, &picture);
            let fit = &found.lidars[0];
            let seen = format!("planted {yaw_deg}°, {height_m} m: {fit:?}");
            assert!((fit.yaw_rad.offset - yaw_rad).abs() < 0.1_f64.to_radians(), "{seen}");
            assert!((fit.height_m.offset - height_m).abs() < 0.02, "{seen}");
            let is_off = yaw_deg != 0.0 || height_m != 0.0;
            let expected = if is_off { Verdict::Off } else { Verdict::Consistent };
            assert_eq!(found.verdict, expected, "{seen}");
            assert_eq!(fit.correction().yaw_rad, -fit.yaw_rad.offset);
        }
    }

    #[test]
    fn an_image_without_edges_or_of_elsewhere_tells_nothing() {
        let gray = Image::filled(1880, 240, [128; 3]);
        let doubt = Finding::CannotTell(Doubt::NoMatch);
        let found = report(Motion::default(), &gray);
        assert_eq!((found.lidars[0].yaw, found.lidars[0].height), (doubt, doubt));
        assert_eq!(found.verdict, Verdict::CannotTell);
        assert_eq!(found.lidars[0].correction(), Motion::default());
        let elsewhere = Motion { yaw_rad: 1.9, ..Motion::default() };
        assert_eq!(report(elsewhere, &world::picture()).verdict, Verdict::CannotTell);
    }

    #[test]
    fn the_order_of_points_and_sweeps_does_not_change_a_bit() {
        let picture = world::picture();
        let (high, low) = (world::sweep(0.3), world::sweep(-0.1));
        let mut backwards = high.1.clone();
        backwards.reverse();
        let sweep = |sensor, origin, points| Sweep { sensor, origin, points };
        let run = |sweeps: &[Sweep<'_>]| {
            let view = View { camera: &world::camera(), image: &picture, sweeps };
            check_fit(&[view], &FitConfig::default()).unwrap()
        };
        let there = run(&[sweep("a", high.0, &high.1), sweep("b", low.0, &low.1)]);
        let back = run(&[sweep("b", low.0, &low.1), sweep("a", high.0, &backwards)]);
        assert_eq!(there, back);
        assert_eq!(there.verdict, Verdict::Consistent);
    }

    #[test]
    fn what_cannot_be_compared_is_an_error() {
        let small = Image::filled(10, 10, [0; 3]);
        let (origin, points) = world::sweep(0.0);
        let check = |image: &Image, points: &[Point3<f64>]| {
            let sweep = Sweep { sensor: "lidar", origin, points };
            let view = View { camera: &world::camera(), image, sweeps: &[sweep] };
            check_fit(&[view], &FitConfig::default()).unwrap_err().to_string()
        };
        let size = "expected an image of [1880, 240] pixels, found [10, 10] in 300 bytes";
        assert_eq!(check(&small, &points), size);
        let bad = [Point3::new(f64::NAN, 0.0, 0.0)];
        let full = Image::filled(1880, 240, [0; 3]);
        assert_eq!(check(&full, &bad), "cannot use the sweep of \"lidar\"");
        let none = check_fit(&[], &FitConfig::default()).unwrap_err();
        assert_eq!(none, Error::NoSweep);
    }

    #[test]
    fn an_empty_sweep_has_too_few_edges() {
        let picture = world::picture();
        let sweep = Sweep { sensor: "lidar", origin: Point3::origin(), points: &[] };
        let view = View { camera: &world::camera(), image: &picture, sweeps: &[sweep] };
        let found = check_fit(&[view], &FitConfig::default()).unwrap();
        assert_eq!(found.lidars[0].yaw, Finding::CannotTell(Doubt::FewEdges));
    }
}
