//! The calibration check's report in words.

use jrdb_calibration::{
    Doubt, Finding, FitReport, FloorConfig, LidarFit, Refinement, Verdict, compare_floors,
    fit_floor,
};
use jrdb_projection::nalgebra::Point3;

use super::BaseSweep;
use jrdb_types::with_causes;

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
        Ok(found) => {
            let floor = &found.floors[0].floor;
            let (height, tilt) = (floor.height_m, floor.tilt_rad().to_degrees());
            format!("floor {}: {height:+.3} m, tilt {tilt:.2}°, rms {:.3} m", cloud.0, floor.rms_m)
        }
        Err(error) => format!("floor {}: {}", cloud.0, with_causes(&error)),
    };
    let mut lines: Vec<String> = named.iter().map(line).collect();
    if let Ok(found) = compare_floors(&named, &config) {
        lines.extend(found.differences.iter().map(|d| {
            let tilt = d.tilt_rad.to_degrees();
            format!("floor {} less {}: {:+.3} m, tilt {tilt:.2}°", d.second, d.first, d.height_m)
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
        let name = &before.sensor;
        let words = format!(
            "{name}: the floor's tilt goes from {was:.2}° to {is:.2}°: do not trust this pitch and roll"
        );
        (is > was + TILT_MARGIN_DEG).then_some(words)
    };
    before.iter().zip(after).filter_map(line).collect()
}

fn doubt_words(doubt: Doubt) -> &'static str {
    match doubt {
        Doubt::FewEdges => "cannot tell: the cloud shows too few edges",
        Doubt::NoMatch => "cannot tell: no offset fits better than chance",
        Doubt::AtBorder => "cannot tell: beyond the range searched",
        Doubt::Uncertain => "cannot tell: too uncertain",
    }
}

fn finding_words(finding: Finding) -> &'static str {
    match finding {
        Finding::Consistent => "consistent",
        Finding::Off => "OFF",
        Finding::CannotTell(doubt) => doubt_words(doubt),
    }
}

fn fit_lines(fit: &LidarFit) -> [String; 2] {
    let (yaw, height) = (&fit.yaw_rad, &fit.height_m);
    let [degrees, deviation] = [yaw.offset, yaw.deviation].map(f64::to_degrees);
    let name = &fit.sensor;
    let tail = |m: &jrdb_calibration::Measure, finding| {
        let words = finding_words(finding);
        format!("{:5} edges {:5.1} sigma  {words}", m.edges, m.significance)
    };
    [
        format!("{name:16} yaw    {degrees:+7.2}° ± {deviation:.2}°   {}", tail(yaw, fit.yaw)),
        format!(
            "{name:16} height {:+7.3} m ± {:.3} m {}",
            height.offset,
            height.deviation,
            tail(height, fit.height)
        ),
    ]
}

/// The whole report, a line per LiDAR and offset.
#[must_use]
pub fn fit_text(report: &FitReport) -> String {
    let all = report.lidars.iter().chain([&report.rig]);
    all.flat_map(fit_lines).map(|line| line + "\n").collect()
}

/// What the report comes to, in one sentence.
#[must_use]
pub fn verdict_words(report: &FitReport) -> String {
    let mut parts = Vec::new();
    for fit in &report.lidars {
        let name = &fit.sensor;
        if fit.yaw == Finding::Off {
            parts.push(format!("{name}: yaw off by {:+.2}°", fit.yaw_rad.offset.to_degrees()));
        }
        if fit.height == Finding::Off {
            parts.push(format!("{name}: height off by {:+.3} m", fit.height_m.offset));
        }
    }
    let doubts = report.lidars.iter().flat_map(|fit| {
        [("yaw", fit.yaw), ("height", fit.height)].map(|(what, f)| (fit.sensor.as_str(), what, f))
    });
    for (name, what, finding) in doubts {
        if let Finding::CannotTell(doubt) = finding {
            parts.push(format!("{name}: {what} {}", doubt_words(doubt)));
        }
    }
    match report.verdict {
        Verdict::Consistent => "consistent".into(),
        Verdict::Off | Verdict::CannotTell => parts.join("; "),
    }
}

/// The refined mounts in words.
#[must_use]
pub fn refinement_text(refinement: &Refinement) -> String {
    let mut text = String::new();
    for lidar in &refinement.lidars {
        let [before, after] = [lidar.score_before, lidar.score_after];
        text += &format!("{}: score {before:.3} -> {after:.3}\n", lidar.sensor);
        for found in &lidar.freedoms {
            let name = format!("{:?}", found.freedom).to_lowercase();
            let is_length = found.freedom == jrdb_calibration::Freedom::Height;
            let show = |value: f64| {
                if is_length {
                    format!("{value:.3} m")
                } else {
                    format!("{:.2}°", value.to_degrees())
                }
            };
            let sign = if found.correction < 0.0 { '-' } else { '+' };
            let deviation = found.deviation.map_or("no top".into(), |d| format!("± {}", show(d)));
            let value = show(found.correction.abs());
            text += &if found.is_determined {
                format!("  {name:6} {sign}{value} {deviation}\n")
            } else {
                format!("  {name:6} left alone: the data do not determine it ({deviation})\n")
            };
        }
    }
    text
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
