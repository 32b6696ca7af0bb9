//! Posture from the shape of the box: upright or not.

use std::collections::BTreeMap;

use jrdb_types::vocab::Action;
use jrdb_types::{Belief, PixelBox};

/// From this ratio of height to width a person is upright: on a labelled frame of JRDB, standing
/// people have 2.0 to 3.3.
pub(crate) const UPRIGHT_MIN_RATIO: f64 = 2.4;
/// Up to this ratio of height to width a person is not upright, or only the upper half is visible:
/// seated people have 1.3 to 1.9.
pub(crate) const SEATED_MAX_RATIO: f64 = 1.7;
/// A box this near to the upper or lower border of the image is cut by it, pixels.
const BORDER_PX: f64 = 2.0;

/// Belief about an action from the shape of a box in an image of this height, pixels. A single
/// picture does not separate standing from walking, nor sitting from occlusion below the waist; the
/// probabilities reflect this. Unknown between the two ratios, and for a box that the border of the
/// image cuts.
pub(crate) fn posture(bbox: &PixelBox, image_height_px: f64) -> Belief<Action> {
    let is_cut = bbox.y < BORDER_PX || bbox.y + bbox.h > image_height_px - BORDER_PX;
    match bbox.h / bbox.w {
        ratio if ratio >= UPRIGHT_MIN_RATIO => Belief(BTreeMap::from([
            (Action::Standing, 0.55),
            (Action::Walking, 0.4),
            (Action::Sitting, 0.05),
        ])),
        ratio if ratio <= SEATED_MAX_RATIO && !is_cut => Belief(BTreeMap::from([
            (Action::Sitting, 0.65),
            (Action::Standing, 0.2),
            (Action::Bending, 0.1),
        ])),
        _ => Belief::default(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tall_boxes_stand_and_broad_ones_sit_unless_the_image_cuts_them() {
        let best = |bbox: [f64; 4]| posture(&PixelBox::from(bbox), 480.0).best();
        assert_eq!(best([0.0, 60.0, 100.0, 300.0]), Some(Action::Standing));
        assert_eq!(best([0.0, 60.0, 200.0, 300.0]), Some(Action::Sitting));
        assert_eq!(best([0.0, 60.0, 150.0, 300.0]), None);
        assert_eq!(best([0.0, 180.0, 200.0, 300.0]), None);
        assert_eq!(best([0.0, 60.0, 0.0, 0.0]), None);
    }
}
