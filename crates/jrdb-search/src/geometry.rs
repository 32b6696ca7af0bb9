//! Places that the graph has no edge for: seen from the robot, or with the robot as partner.

use jrdb_types::vocab::{Elevation, Sector};
use jrdb_types::{Direction, DistanceWord, LateralConvention, SpatialRelation};

/// An angle within half a turn of another, degrees.
pub(crate) fn near_deg(angle: f64, middle: f64) -> f64 {
    middle + (angle - middle + 180.0).rem_euclid(360.0) - 180.0
}

/// Numbers and words for something so far ahead, to the physical left and up, metres.
fn relation(ahead: f64, left: f64, up: f64, lateral: LateralConvention) -> SpatialRelation {
    let distance_m = ahead.hypot(left).hypot(up);
    let bearing_rad = left.atan2(ahead);
    let sector = Sector::of_degrees(bearing_rad.to_degrees()).named(lateral);
    SpatialRelation {
        distance: DistanceWord::of_metres(distance_m),
        direction: Some(Direction { sector, elevation: Elevation::of_rise(up) }),
        distance_m: Some(distance_m),
        bearing_rad: Some(bearing_rad),
        rise_m: Some(up),
        direction_probability: None,
    }
}

/// Where the robot (the origin of the base frame) is, in the frame of somebody at `center` who faces `heading_rad`.
pub(crate) fn robot_seen_by(
    center: [f64; 3],
    heading_rad: f64,
    lateral: LateralConvention,
) -> SpatialRelation {
    let (sin, cos) = heading_rad.sin_cos();
    let [x, y, z] = center.map(|c| -c);
    relation(cos * x + sin * y, cos * y - sin * x, z, lateral)
}

/// Where a subject is beside a partner as the robot sees both: in front is nearer to the robot, left what the robot
/// has on its left when it looks at the partner.
pub(crate) fn beside(
    subject: [f64; 3],
    partner: [f64; 3],
    lateral: LateralConvention,
) -> SpatialRelation {
    let range = partner[0].hypot(partner[1]);
    let away = if range > 0.0 { [partner[0] / range, partner[1] / range] } else { [1.0, 0.0] };
    let [x, y, z] = [0, 1, 2].map(|axis| subject[axis] - partner[axis]);
    relation(-(x * away[0] + y * away[1]), y * away[0] - x * away[1], z, lateral)
}

/// Distance of `middle` from the straight line between two points, horizontally, and where along it from 0 to 1; `None` unless
/// its foot is strictly between them and so far inside, metres.
pub(crate) fn along(
    middle: [f64; 3],
    ends: [[f64; 3]; 2],
    min_inside_m: f64,
) -> Option<(f64, f64)> {
    let [line, to_middle] = [ends[1], middle].map(|p| [p[0] - ends[0][0], p[1] - ends[0][1]]);
    let length_m = line[0].hypot(line[1]);
    let along_m = (to_middle[0] * line[0] + to_middle[1] * line[1]) / length_m;
    let offset_m = (to_middle[1] * line[0] - to_middle[0] * line[1]).abs() / length_m;
    let is_inside = along_m > 0.0 && along_m < length_m;
    let is_clear = along_m >= min_inside_m && length_m - along_m >= min_inside_m;
    (is_inside && is_clear).then_some((offset_m, along_m / length_m))
}

/// Distance between two points, metres.
pub(crate) fn apart_m(a: [f64; 3], b: [f64; 3]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1]).hypot(a[2] - b[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    const PHYSICAL: LateralConvention = LateralConvention::Physical;

    fn sector(relation: &SpatialRelation) -> &'static str {
        relation.direction.map_or("", |direction| direction.sector.word())
    }

    #[test]
    fn nearer_to_the_robot_is_in_front_and_its_left_is_left() {
        let partner = [4.0, 0.0, 0.0];
        let seen = |subject| beside(subject, partner, PHYSICAL);
        assert_eq!(sector(&seen([3.0, 0.0, 0.0])), "front");
        assert_eq!(sector(&seen([5.0, 0.0, 0.0])), "back");
        assert_eq!(sector(&seen([4.0, 1.0, 0.0])), "left");
        assert_eq!(sector(&seen([4.0, -1.0, 0.0])), "right");
        let behind_the_robot = beside([-4.0, -1.0, 0.0], [-4.0, 0.0, 0.0], PHYSICAL);
        assert_eq!(sector(&behind_the_robot), "left");
        assert_eq!(
            sector(&beside([4.0, 1.0, 0.0], partner, LateralConvention::BenchmarkMirrored)),
            "right"
        );
    }

    #[test]
    fn somebody_who_turns_sees_the_robot_elsewhere() {
        let seen = |heading| robot_seen_by([2.0, 0.0, 0.0], heading, PHYSICAL);
        assert_eq!(sector(&seen(std::f64::consts::PI)), "front");
        assert_eq!(sector(&seen(0.0)), "back");
        assert_eq!(sector(&seen(std::f64::consts::FRAC_PI_2)), "left");
    }

    #[test]
    fn between_needs_a_foot_inside_the_line() {
        let ends = [[0.0; 3], [4.0, 0.0, 0.0]];
        assert_eq!(along([1.0, 0.4, 0.0], ends, 0.3), Some((0.4, 0.25)));
        assert_eq!(along([0.2, 0.0, 0.0], ends, 0.3), None);
        assert_eq!(along([5.0, 0.0, 0.0], ends, 0.3), None);
        assert_eq!(along([1.0, 0.0, 0.0], [[0.0; 3], [0.0; 3]], 0.3), None);
    }
}
