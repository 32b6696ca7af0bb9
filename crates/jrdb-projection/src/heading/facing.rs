//! A heading from the attribute "facing" in the image, with the bearing.

use std::f64::consts::{FRAC_PI_4, PI};

use jrdb_types::vocab::{Facing, HeadingSource};
use jrdb_types::{Belief, Heading};
use nalgebra::{Point3, Vector2};

use super::config::HeadingConfig;
use crate::relation::wrap_rad;

/// The angle that a person's front makes with the line of sight from the robot, radians counter-clockwise.
///
/// Away is 0; someone whose front points to our left has turned a quarter to the left of that.
#[must_use]
pub fn from_line_of_sight_rad(facing: Facing) -> f64 {
    let eighths = match facing {
        Facing::Away => 0.0,
        Facing::AwayLeft => 1.0,
        Facing::Left => 2.0,
        Facing::TowardsLeft => 3.0,
        Facing::Towards => 4.0,
        Facing::TowardsRight => -3.0,
        Facing::Right => -2.0,
        Facing::AwayRight => -1.0,
    };
    eighths * FRAC_PI_4
}

/// The heading that a belief in facings says, for somebody at `center`, metres, base frame.
///
/// The mean direction of the believed facings, each weighted by its probability; the deviation is the circular
/// one (`sqrt(-2 ln R)`) and the sector's own, `facing_std_rad`, together. `None` when nothing is believed, or
/// when the belief is so spread that it tells nothing (`facing_max_std_rad`).
#[must_use]
pub fn heading(
    belief: &Belief<Facing>,
    center: &Point3<f64>,
    config: &HeadingConfig,
) -> Option<Heading> {
    let total: f64 = belief.0.values().sum();
    let sum: Vector2<f64> = belief
        .0
        .iter()
        .map(|(&facing, &p)| {
            let (sin, cos) = from_line_of_sight_rad(facing).sin_cos();
            Vector2::new(cos, sin) * p
        })
        .sum();
    let tells_nothing = total.is_nan() || total <= 0.0;
    if tells_nothing {
        return None;
    }
    let resultant = (sum.norm() / total).min(1.0);
    let spread_rad = (-2.0 * resultant.ln()).max(0.0).sqrt();
    let std_rad = spread_rad.hypot(config.facing_std_rad);
    let tells = std_rad <= config.facing_max_std_rad;
    let bearing_rad = center.y.atan2(center.x);
    let angle_rad = wrap_rad(bearing_rad + sum.y.atan2(sum.x));
    tells.then_some(Heading { angle_rad, std_rad: std_rad.min(PI), source: HeadingSource::Facing })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    fn at(x: f64, y: f64, facings: &[(Facing, f64)]) -> Option<Heading> {
        let belief = Belief(facings.iter().copied().collect::<BTreeMap<_, _>>());
        heading(&belief, &Point3::new(x, y, 0.0), &HeadingConfig::default())
    }

    #[test]
    fn who_faces_us_from_the_left_looks_to_the_right() {
        let found = at(0.0, 3.0, &[(Facing::Towards, 1.0)]).unwrap();
        assert!((found.angle_rad + PI / 2.0).abs() < 1e-12);
        let found = at(3.0, 0.0, &[(Facing::Left, 1.0)]).unwrap();
        assert!((found.angle_rad - PI / 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_belief_in_two_neighbours_is_the_middle_and_less_certain() {
        let found = at(3.0, 0.0, &[(Facing::Away, 0.5), (Facing::AwayLeft, 0.5)]).unwrap();
        assert!((found.angle_rad - PI / 8.0).abs() < 1e-12);
        assert!(found.std_rad > HeadingConfig::default().facing_std_rad);
    }

    #[test]
    fn a_belief_in_opposites_or_in_nothing_tells_nothing() {
        assert_eq!(at(3.0, 0.0, &[(Facing::Away, 0.5), (Facing::Towards, 0.5)]), None);
        assert_eq!(at(3.0, 0.0, &[]), None);
    }
}
