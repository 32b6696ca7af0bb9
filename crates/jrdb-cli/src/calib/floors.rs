//! The floors under a frame's LiDARs.

use jrdb_calibration::{FloorConfig, FloorDifference, compare_floors, fit_floor};
use jrdb_projection::nalgebra::Point3;
use jrdb_render::calibration as words;

use super::frame::BaseSweep;
use jrdb_types::with_causes;

/// Floors of one frame farther apart than this are not one floor, metres: on the real frame they are 0.02 m apart.
const APART_M: f64 = 0.1;
/// The same for their tilts, degrees.
const APART_DEG: f64 = 3.0;

/// A floor's tilt that grows by less is no sign of anything, degrees: the floors that two well mounted LiDARs see in
/// one real frame differ by as much.
const TILT_MARGIN_DEG: f64 = 0.3;

/// The floors of a frame's LiDARs in words, one line each.
#[must_use]
pub fn floor_lines(sweeps: &[BaseSweep]) -> Vec<String> {
    let config = FloorConfig::default();
    let named: Vec<(&str, &[Point3<f64>])> =
        sweeps.iter().map(|s| (s.sensor.as_str(), s.points.as_slice())).collect();
    let line = |cloud: &(&str, &[Point3<f64>])| match compare_floors(&[*cloud], &config) {
        Ok(found) => words::floor(cloud.0, &found.floors[0].floor),
        Err(error) => format!("floor {}: {}", cloud.0, with_causes(&error)),
    };
    let mut lines: Vec<String> = named.iter().map(line).collect();
    if let Ok(found) = compare_floors(&named, &config) {
        lines.extend(found.differences.iter().map(words::floor_difference));
        let is_apart = |d: &&FloorDifference| {
            d.height_m.abs() > APART_M || d.tilt_rad.abs() > APART_DEG.to_radians()
        };
        lines.extend(found.differences.iter().filter(is_apart).map(|difference| {
            let FloorDifference { first, second, .. } = difference;
            format!(
                "floors of {first} and {second} lie apart: at least one of their mounts is wrong"
            )
        }));
    }
    lines
}

/// LiDARs whose floor is tilted more after a change than before, in words: a refined pitch or roll that is the
/// panorama's error shows here.
#[must_use]
pub fn tilted_more(before: &[BaseSweep], after: &[BaseSweep]) -> Vec<String> {
    let tilt_deg = |sweep: &BaseSweep| {
        let floor = fit_floor(&sweep.points, &FloorConfig::default()).ok()?;
        Some(floor.tilt_rad().to_degrees())
    };
    let line = |(before, after): (&BaseSweep, &BaseSweep)| {
        let [was, is] = [tilt_deg(before)?, tilt_deg(after)?];
        let is_more = is > was + TILT_MARGIN_DEG;
        is_more.then(|| words::tilted_more(&before.sensor, was, is))
    };
    before.iter().zip(after).filter_map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::slice::from_ref;

    #[test]
    fn a_floor_that_is_tilted_more_is_named() {
        let floor = |slope: f64| {
            let at = |i: i32| f64::from(i) * 0.25;
            let point = |i, j| Point3::new(at(i), at(j), -0.9 + slope * at(i));
            let points = (-20..20).flat_map(|i| (-20..20).map(move |j| point(i, j))).collect();
            BaseSweep { sensor: "a".into(), origin: Point3::origin(), points }
        };
        let [level, tilted] = [0.0, 0.02].map(floor);
        assert_eq!(tilted_more(from_ref(&tilted), from_ref(&level)), Vec::<String>::new());
        let found = tilted_more(&[level], &[tilted]);
        assert!(found[0].starts_with("a: the floor's tilt goes from 0.00° to 1.15°"), "{found:?}");
    }
}
