//! Which way a face looks, from where its nose lies between its eyes.

use std::collections::BTreeMap;

use jrdb_types::Belief;
use jrdb_types::vocab::Facing;

use super::face::Face;

/// Up to this shift of the nose, in distances between the eyes, a face looks at us.
pub(crate) const FRONTAL_MAX_SHIFT: f64 = 0.3;
/// Up to this shift both cheeks are seen; beyond, it is a profile.
pub(crate) const HALF_MAX_SHIFT: f64 = 1.0;
/// A face with both eyes seen has them this part of its width apart, at least.
const BOTH_EYES_MIN: f64 = 0.25;

/// How a face is turned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Turn {
    /// How far right of the middle of the eyes the nose lies in the picture, in distances between
    /// the eyes.
    pub(crate) shift: f64,
    /// Distance of the eyes in widths of the face.
    pub(crate) eyes: f64,
}

impl Turn {
    /// Of a face; not a number where its landmarks lie in one place.
    pub(crate) fn of(face: &Face) -> Self {
        let [right, left, nose, ..] = face.landmarks;
        let apart_px = left[0] - right[0];
        let shift = (nose[0] - (left[0] + right[0]) / 2.0) / apart_px;
        Self { shift, eyes: apart_px / face.bbox.w }
    }

    /// Whether the whole face is seen.
    pub(crate) fn is_frontal(self) -> bool {
        self.shift.abs() <= FRONTAL_MAX_SHIFT && self.eyes >= BOTH_EYES_MIN
    }
}

/// Belief about which way a person's front points. A head turns more than a body does, so that
/// neighbouring directions are possible, too. Nothing where the landmarks contradict each other.
pub(crate) fn facing(turn: Turn) -> Belief<Facing> {
    let is_left = turn.shift < 0.0;
    let side = |left: Facing, right: Facing| if is_left { left } else { right };
    let (half, profile, away) = (
        side(Facing::TowardsLeft, Facing::TowardsRight),
        side(Facing::Left, Facing::Right),
        side(Facing::AwayLeft, Facing::AwayRight),
    );
    let both_eyes = turn.eyes >= BOTH_EYES_MIN;
    let belief: &[(Facing, f64)] = match turn.shift.abs() {
        _ if turn.is_frontal() => {
            &[(Facing::Towards, 0.6), (Facing::TowardsLeft, 0.2), (Facing::TowardsRight, 0.2)]
        }
        shift if shift <= HALF_MAX_SHIFT && both_eyes => {
            &[(half, 0.5), (Facing::Towards, 0.25), (profile, 0.25)]
        }
        shift if shift > HALF_MAX_SHIFT && !both_eyes => {
            &[(profile, 0.5), (half, 0.25), (away, 0.25)]
        }
        _ => &[],
    };
    Belief(BTreeMap::from_iter(belief.iter().copied()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nose_tells_which_way_a_face_looks() {
        let best = |shift, eyes| facing(Turn { shift, eyes }).best();
        assert_eq!(best(0.02, 0.44), Some(Facing::Towards));
        assert_eq!(best(0.5, 0.33), Some(Facing::TowardsRight));
        assert_eq!(best(-0.5, 0.33), Some(Facing::TowardsLeft));
        assert_eq!(best(3.3, 0.09), Some(Facing::Right));
        assert_eq!(best(-1.5, 0.12), Some(Facing::Left));
        assert_eq!(best(0.28, 0.17), None);
        assert_eq!(best(f64::NAN, 0.4), None);
    }
}
