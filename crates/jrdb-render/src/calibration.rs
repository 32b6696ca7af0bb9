//! Results of calibration, in words.

use jrdb_types::calibration::{
    Doubt, Finding, FitReport, Floor, FloorDifference, Freedom, LidarFit, Measure, Refinement,
    Verdict,
};

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
    let tail = |m: &Measure, finding| {
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
pub fn fit(report: &FitReport) -> String {
    let all = report.lidars.iter().chain([&report.rig]);
    all.flat_map(fit_lines).map(|line| line + "\n").collect()
}

/// What the report comes to, in one sentence.
#[must_use]
pub fn verdict(report: &FitReport) -> String {
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
pub fn refinement(found: &Refinement) -> String {
    let mut text = String::new();
    for lidar in &found.lidars {
        let [before, after] = [lidar.score_before, lidar.score_after];
        text += &format!("{}: score {before:.3} -> {after:.3}\n", lidar.sensor);
        for found in &lidar.freedoms {
            let name = format!("{:?}", found.freedom).to_lowercase();
            let is_length = found.freedom == Freedom::Height;
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

/// A floor of one LiDAR, on one line.
#[must_use]
pub fn floor(sensor: &str, floor: &Floor) -> String {
    let (height, tilt) = (floor.height_m, floor.tilt_rad().to_degrees());
    format!("floor {sensor}: {height:+.3} m, tilt {tilt:.2}°, rms {:.3} m", floor.rms_m)
}

/// How far two floors lie apart, on one line.
#[must_use]
pub fn floor_difference(difference: &FloorDifference) -> String {
    let FloorDifference { first, second, height_m, tilt_rad } = difference;
    format!("floor {second} less {first}: {height_m:+.3} m, tilt {:.2}°", tilt_rad.to_degrees())
}

/// That a change tilts a LiDAR's floor more than before, degrees.
#[must_use]
pub fn tilted_more(sensor: &str, was: f64, is: f64) -> String {
    format!(
        "{sensor}: the floor's tilt goes from {was:.2}° to {is:.2}°: do not trust this pitch and roll"
    )
}
