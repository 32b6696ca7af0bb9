//! Gross errors of mounts: each is tried, and named when the cloud then fits the image.

use std::f64::consts::PI;

use jrdb_calibration::{Doubt, Finding, FitConfig, FitReport, LidarFit, check_fit};
use jrdb_projection::nalgebra::{
    Isometry3, Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3,
};
use jrdb_types::{Rig, Rotation};
use serde::Serialize;

use super::frame::{CalibFrame, Mounts, with_views};
use crate::Error;

/// Standard errors by which the columns must fit. Sound sweeps of real and drawn scenes reach 6.8 to 8.5, turned ones 4 once in 72
/// times; some forty mounts are tried.
const MIN_YAW_SIGNIFICANCE: f64 = 5.5;
/// Standard errors by which the rows must fit: sound sweeps reach 5.2 to 6.5.
const MIN_HEIGHT_SIGNIFICANCE: f64 = 4.0;
/// Turns that are tried: twice the range that each check searches on either side.
const YAW_STEP_DEG: f64 = 12.0;

/// A gross error that explains what the image shows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GrossError {
    /// The LiDAR.
    pub sensor: String,
    /// What is wrong with its mount, in words.
    pub error: String,
    /// Standard errors by which the columns fit without it.
    pub yaw_significance: f64,
    /// Standard errors by which the rows fit without it.
    pub height_significance: f64,
}

/// A mount as it would be without one error.
struct Hypothesis {
    error: What,
    mount: Isometry3<f64>,
}

/// An error of a mount.
enum What {
    /// One that has a name; without it the mount is right.
    Named(&'static str),
    /// A turn by about so many degrees.
    TurnedDeg(f64),
}

/// How far a mount may be off without an error that has a name, degrees and metres: more than the check's tolerances, as the rest
/// may have errors of its own.
const MAX_REST_DEG: f64 = 2.0;
const MAX_REST_M: f64 = 0.15;

/// Names the gross error of every LiDAR of which the check cannot tell anything: the one whose repair makes the cloud of the
/// first frame fit best. None where no repair does.
///
/// # Errors
/// Those of the check.
pub fn gross_errors(
    frames: &[CalibFrame],
    mounts: &[Mounts],
    report: &FitReport,
    config: &FitConfig,
) -> Result<Vec<GrossError>, Error> {
    let (Some(frame), Some(mounts)) = (frames.first(), mounts.first()) else {
        return Ok(Vec::new());
    };
    let unknown = report.lidars.iter().filter(|fit| is_lost(fit));
    let named = unknown.filter_map(|fit| mounts.get(&fit.sensor).map(|mount| (&fit.sensor, mount)));
    let mut found = Vec::new();
    for (sensor, mount) in named {
        let mut best: Option<GrossError> = None;
        for hypothesis in hypotheses(sensor, mount, frame.robot.rig()) {
            let tried = Mounts::from([(sensor.clone(), hypothesis.mount)]);
            let one = std::slice::from_ref(frame);
            let report = with_views(one, &[tried], |views| check_fit(views, config))?;
            let fits =
                report.lidars.first().and_then(|fit| explained(sensor, &hypothesis.error, fit));
            let strength = |one: &GrossError| one.yaw_significance + one.height_significance;
            if let Some(fits) = fits
                && best.as_ref().is_none_or(|best| strength(&fits) > strength(best))
            {
                best = Some(fits);
            }
        }
        found.extend(best);
    }
    Ok(found)
}

/// Whether nothing near the mount fits.
fn is_lost(fit: &LidarFit) -> bool {
    let lost = |finding| {
        matches!(finding, Finding::CannotTell(Doubt::NoMatch | Doubt::AtBorder | Doubt::FewEdges))
    };
    lost(fit.yaw) || lost(fit.height)
}

fn explained(sensor: &str, error: &What, fit: &LidarFit) -> Option<GrossError> {
    let (yaw, height) = (&fit.yaw_rad, &fit.height_m);
    let rest_deg = yaw.offset.to_degrees();
    let is_sure = yaw.significance >= MIN_YAW_SIGNIFICANCE
        && height.significance >= MIN_HEIGHT_SIGNIFICANCE
        && !is_lost(fit);
    let is_rest_small = rest_deg.abs() < MAX_REST_DEG && height.offset.abs() < MAX_REST_M;
    let words = match error {
        What::Named(words) => is_rest_small.then(|| (*words).to_string()),
        What::TurnedDeg(degrees) => {
            Some(format!("the mount is turned by about {:+.0}°", degrees + rest_deg))
        }
    };
    Some(GrossError {
        sensor: sensor.into(),
        error: words.filter(|_| is_sure)?,
        yaw_significance: yaw.significance,
        height_significance: height.significance,
    })
}

/// Every mount that one error may have been made of.
fn hypotheses(sensor: &str, mount: &Isometry3<f64>, rig: &Rig) -> Vec<Hypothesis> {
    let (t, r) = (mount.translation.vector, mount.rotation);
    let of = |rotation: UnitQuaternion<f64>, translation: Vector3<f64>| {
        Isometry3::from_parts(translation.into(), rotation)
    };
    let hypothesis = |error, mount| Hypothesis { error: What::Named(error), mount };
    let turned = |axis: Vector3<f64>, rad: f64| UnitQuaternion::from_scaled_axis(axis * rad);
    let upside_down = turned(Vector3::x(), PI);
    let mut all = vec![
        hypothesis(
            "the transform is inverted: it takes points of the base to the LiDAR",
            mount.inverse(),
        ),
        hypothesis("the rotation is transposed", of(r.inverse(), t)),
        hypothesis("the translation has the opposite sign", of(r, -t)),
        hypothesis(
            "rotation and sign of the translation are those of the inverse",
            of(r.inverse(), -t),
        ),
        hypothesis("the LiDAR is mounted upside down", of(r * upside_down, t)),
        hypothesis("the translation is in millimetres", of(r, t / 1000.0)),
        hypothesis("the translation is in centimetres", of(r, t / 100.0)),
        hypothesis(
            "the axes are those of a camera (x right, y down, z forward)",
            of(r * optical(), t),
        ),
        hypothesis(
            "the rotation lacks the turn from a camera's axes to the robot's",
            of(optical() * r, t),
        ),
        hypothesis(
            "the rotation has the turn from a camera's axes to the robot's once too often",
            of(optical().inverse() * r, t),
        ),
    ];
    all.extend(
        as_written(sensor, rig)
            .into_iter()
            .map(|(error, rotation)| hypothesis(error, of(rotation, t))),
    );
    let steps = (360.0 / YAW_STEP_DEG) as i32;
    all.extend((1..steps).map(|step| {
        let degrees = YAW_STEP_DEG * f64::from(step);
        let degrees = if degrees > 180.0 { degrees - 360.0 } else { degrees };
        let rotation = turned(Vector3::z(), -degrees.to_radians()) * r;
        Hypothesis { error: What::TurnedDeg(degrees), mount: of(rotation, t) }
    }));
    all.retain(|one| (one.mount.to_matrix() - mount.to_matrix()).norm() > 1e-6);
    all
}

/// The turn from a camera's axes (x right, y down, z forward) to a robot's (x forward, y left, z up).
fn optical() -> UnitQuaternion<f64> {
    let matrix = Matrix3::new(0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0);
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(matrix))
}

/// A LiDAR's rotation as it would be if the numbers of the rig file meant something else.
fn as_written(sensor: &str, rig: &Rig) -> Option<(&'static str, UnitQuaternion<f64>)> {
    let frame = &rig.lidars.iter().find(|lidar| lidar.name == sensor)?.frame;
    let transform = rig.transforms.iter().find(|t| t.child == *frame && t.parent == rig.base)?;
    match transform.rotation {
        Rotation::RpyRad(angles) => {
            let [roll, pitch, yaw] = angles.map(f64::to_radians);
            Some(("the angles are in degrees", UnitQuaternion::from_euler_angles(roll, pitch, yaw)))
        }
        Rotation::QuaternionWxyz([x, y, z, w]) => {
            let q = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
            Some(("the quaternion is in the order x y z w", q))
        }
        Rotation::Matrix(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_error_has_another_mount() {
        let rig: Rig = serde_json::from_str(
            r#"{"base": "b", "cameras": [], "lidars": [{"name": "top", "frame": "top"}], "transforms": [
            {"parent": "b", "child": "top", "translation_m": [0, 0, 0.3], "rotation": {"rpy_rad": [0, 0, 2]}}]}"#,
        )
        .unwrap();
        let mount = Isometry3::from_parts(
            Vector3::new(0.0, 0.0, 0.3).into(),
            UnitQuaternion::from_euler_angles(0.0, 0.0, 2.0),
        );
        let all = hypotheses("top", &mount, &rig);
        assert!(all.iter().all(|one| (one.mount.to_matrix() - mount.to_matrix()).norm() > 1e-6));
        let is_it = |one: &&Hypothesis| matches!(one.error, What::Named(error) if error.contains("degrees"));
        let degrees = all.iter().find(is_it).unwrap();
        assert!((degrees.mount.rotation.euler_angles().2 - 2_f64.to_radians()).abs() < 1e-12);
    }
}
