//! Which way somebody faces, from whatever tells it: a label, motion, an attribute in the image, the shape
//! of the body in the cloud. Unknown stays unknown.

pub mod body_shape;
mod config;
pub mod facing;
pub mod motion;

use jrdb_types::vocab::HeadingSource;
use jrdb_types::{Detection, Heading};
use nalgebra::Point3;

use crate::BaseCloud;
use crate::relation::wrap_rad;
use body_shape::ShoulderLine;
pub use config::HeadingConfig;
use motion::Motion;

/// The heading of a detection by the most trusted source that tells one: the label, then motion, then the facing,
/// made finer by the line of the shoulders where the cloud shows it.
///
/// `center` is its position, metres, base frame, and `used` its own points. `None` when nothing tells.
#[must_use]
pub fn heading(
    detection: &Detection,
    center: Option<&Point3<f64>>,
    motion: Option<&Motion>,
    (cloud, used): (&BaseCloud, &[u32]),
    config: &HeadingConfig,
) -> Option<Heading> {
    let label = detection.heading_rad.filter(|angle| angle.is_finite()).map(|angle_rad| Heading {
        angle_rad: wrap_rad(angle_rad),
        std_rad: config.label_std_rad,
        source: HeadingSource::Label,
    });
    let by_motion = || motion.and_then(|motion| motion::heading(motion, config));
    let by_facing = || {
        let facing = facing::heading(&detection.attributes.facing, center?, config)?;
        let shoulders = body_shape::shoulder_line(cloud, used, config);
        Some(shoulders.map_or(facing, |line| with_shoulders(facing, &line)))
    };
    label.or_else(by_motion).or_else(by_facing)
}

/// A heading and a line at right angles to it, both uncertain, weighted by their inverse variances. The heading
/// tells front from back, which a line does not.
fn with_shoulders(heading: Heading, line: &ShoulderLine) -> Heading {
    let half_turn = std::f64::consts::PI;
    let off = wrap_rad(2.0 * (line.normal_rad - heading.angle_rad)) / 2.0;
    let [var, line_var] = [heading.std_rad.powi(2), line.std_rad.powi(2)];
    let weight = var / (var + line_var);
    let is_contradiction = off.abs() > half_turn / 3.0;
    if is_contradiction {
        return heading;
    }
    Heading {
        angle_rad: wrap_rad(heading.angle_rad + weight * off),
        std_rad: (var * line_var / (var + line_var)).sqrt(),
        source: HeadingSource::BodyShape,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn facing_at(angle_rad: f64) -> Heading {
        Heading { angle_rad, std_rad: 0.4, source: HeadingSource::Facing }
    }

    #[test]
    fn shoulders_make_a_facing_finer_whichever_way_their_line_is_written() {
        for normal_rad in [0.2, 0.2 + PI, 0.2 - PI] {
            let line = ShoulderLine { normal_rad, std_rad: 0.4 };
            let found = with_shoulders(facing_at(0.0), &line);
            assert!((found.angle_rad - 0.1).abs() < 1e-12, "{found:?}");
            assert!(found.std_rad < 0.3 && found.source == HeadingSource::BodyShape);
        }
    }

    #[test]
    fn shoulders_that_contradict_the_facing_are_not_used() {
        let line = ShoulderLine { normal_rad: PI / 2.0, std_rad: 0.4 };
        assert_eq!(with_shoulders(facing_at(0.0), &line), facing_at(0.0));
    }
}
