//! Where things are, seen from the robot and from each other: the paper's f_geo.

pub mod direction;
pub mod distance;

use jrdb_types::{LateralConvention, SpatialRelation};
use nalgebra::{Point3, Vector3};

/// Wraps an angle into (-π, π], radians.
#[must_use]
pub fn wrap_rad(angle: f64) -> f64 {
    let turned = angle.rem_euclid(std::f64::consts::TAU);
    if turned > std::f64::consts::PI { turned - std::f64::consts::TAU } else { turned }
}

/// Where a thing at `center` is, seen from the robot at the base frame's origin, facing +x.
#[must_use]
pub fn from_robot(center: &Point3<f64>, lateral: LateralConvention) -> SpatialRelation {
    let direction = direction::of_vector(&center.coords, lateral);
    SpatialRelation {
        direction: Some(direction),
        bearing_rad: Some(wrap_rad(center.y.atan2(center.x))),
        ..apart(&center.coords)
    }
}

/// Where a thing at `center` is, seen from a person at `reference` who faces `heading_rad`.
///
/// Without a heading there is no bearing and no direction. Under
/// [`LateralConvention::EngineHead`] up and down are exchanged, as in the benchmark's engine.
#[must_use]
pub fn from_person(
    reference: &Point3<f64>,
    heading_rad: Option<f64>,
    center: &Point3<f64>,
    lateral: LateralConvention,
) -> SpatialRelation {
    let offset = center - reference;
    let Some(heading_rad) = heading_rad else { return apart(&offset) };
    let (sin, cos) = heading_rad.sin_cos();
    let ahead = cos * offset.x + sin * offset.y;
    let left = cos * offset.y - sin * offset.x;
    let rise = match lateral {
        LateralConvention::Physical => offset.z,
        LateralConvention::EngineHead => -offset.z,
    };
    SpatialRelation {
        direction: Some(direction::of_vector(&Vector3::new(ahead, left, rise), lateral)),
        bearing_rad: Some(wrap_rad(left.atan2(ahead))),
        ..apart(&offset)
    }
}

/// What does not depend on a heading: distance and height difference.
fn apart(offset: &Vector3<f64>) -> SpatialRelation {
    let distance_m = offset.norm();
    SpatialRelation {
        distance: distance::word(distance_m),
        distance_m: Some(distance_m),
        rise_m: Some(offset.z),
        ..SpatialRelation::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn points() -> impl Strategy<Value = Point3<f64>> {
        (-9.0..9.0, -9.0..9.0, -1.0..1.0).prop_map(|(x, y, z)| Point3::new(x, y, z))
    }

    proptest! {
        #[test]
        fn distance_is_symmetric(a in points(), b in points()) {
            let there = from_person(&a, None, &b, LateralConvention::Physical);
            let back = from_person(&b, None, &a, LateralConvention::Physical);
            prop_assert_eq!(there.distance_m, back.distance_m);
            prop_assert_eq!(there.direction, None);
        }

        #[test]
        fn turning_and_moving_the_whole_scene_changes_no_bearing(
            a in points(), b in points(), heading in -3.0..3.0, turn in -3.0..3.0, shift in points(),
        ) {
            prop_assume!((a - b).xy().norm() > 0.1);
            let rotation = nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), turn);
            let moved = |p: &Point3<f64>| rotation * p + shift.coords;
            let before = from_person(&a, Some(heading), &b, LateralConvention::Physical);
            let after =
                from_person(&moved(&a), Some(heading + turn), &moved(&b), LateralConvention::Physical);
            let change = wrap_rad(before.bearing_rad.unwrap() - after.bearing_rad.unwrap());
            prop_assert!(change.abs() < 1e-9);
        }

        #[test]
        fn facing_the_other_way_exchanges_front_and_back(a in points(), b in points(), heading in -3.0..3.0) {
            let seen = |heading| from_person(&a, Some(heading), &b, LateralConvention::Physical);
            let there = seen(heading).bearing_rad.unwrap();
            let turned = seen(heading + std::f64::consts::PI).bearing_rad.unwrap();
            prop_assert!((wrap_rad(there - turned).abs() - std::f64::consts::PI).abs() < 1e-9);
        }

        #[test]
        fn wrapped_angles_lie_in_one_turn(angle in -100.0..100.0) {
            let wrapped = wrap_rad(angle);
            prop_assert!(wrapped > -std::f64::consts::PI && wrapped <= std::f64::consts::PI);
            prop_assert!((wrapped.sin() - f64::sin(angle)).abs() < 1e-9);
        }
    }
}
