//! Which boxes of two views of a frame show the same thing.

use std::collections::{BTreeMap, BTreeSet};

use jrdb_types::PixelBox;

/// Boxes that overlap by this IoU show the same thing.
const SAME_IOU: f64 = 0.5;

/// Which box of another view each box is, by place: pairs of greatest overlap first, each box in at
/// most one pair. `period_px` is the width of an image that wraps, pixels.
pub(crate) fn pairs(
    base: &[PixelBox],
    other: &[PixelBox],
    period_px: Option<f64>,
) -> BTreeMap<usize, usize> {
    let mut overlaps = Vec::new();
    for (a, one) in base.iter().enumerate() {
        for (b, two) in other.iter().enumerate() {
            let iou = one.iou(two, period_px);
            if iou >= SAME_IOU {
                overlaps.push((iou, a, b));
            }
        }
    }
    overlaps.sort_by(|a, b| b.0.total_cmp(&a.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let (mut pairs, mut taken) = (BTreeMap::new(), BTreeSet::new());
    for (_, a, b) in overlaps {
        if !pairs.contains_key(&a) && taken.insert(b) {
            pairs.insert(a, b);
        }
    }
    pairs
}
