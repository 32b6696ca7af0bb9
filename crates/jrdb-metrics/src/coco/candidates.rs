//! Which true boxes a detection may take.

use super::cells::{Cells, cells_of_iou};
use super::config::LOWEST_IOU;
use super::dataset::{DetectionBox, GroundTruthBox};

/// A true box whose IoU with a detection reaches the lowest threshold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Candidate {
    /// Index among the true boxes of the image.
    pub(super) truth: usize,
    /// The cells whose threshold is reached.
    pub(super) reached: Cells,
    iou: f64,
}

/// Replaces a list by the candidates of a detection: the highest IoU first, and the last of equals
/// first, as in the reference evaluator.
pub(super) fn find_candidates(
    detection: &DetectionBox,
    truth: &[&GroundTruthBox],
    period_px: Option<f64>,
    candidates: &mut Vec<Candidate>,
) {
    candidates.clear();
    for (truth, one) in truth.iter().enumerate() {
        let iou = overlap(detection, one, period_px);
        // Most pairs do not share a pixel.
        if iou >= LOWEST_IOU {
            candidates.push(Candidate { truth, reached: cells_of_iou(iou), iou });
        }
    }
    candidates.sort_by(|a, b| b.iou.total_cmp(&a.iou).then(b.truth.cmp(&a.truth)));
}

/// IoU; with a crowd, the part of the detection that lies in it.
fn overlap(detection: &DetectionBox, truth: &GroundTruthBox, period_px: Option<f64>) -> f64 {
    let (d, t) = (&detection.bbox, &truth.bbox);
    if !truth.crowd {
        return d.iou(t, period_px);
    }
    let shared = match period_px {
        Some(period_px) => d.circular_intersection_px2(t, period_px),
        None => d.intersection_px2(t),
    };
    if shared > 0.0 { shared / d.area_px2() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use jrdb_types::PixelBox;
    use proptest::prelude::*;

    fn boxes() -> impl Strategy<Value = PixelBox> {
        (0.0..500.0, 0.0..100.0, 1.0..200.0, 1.0..200.0)
            .prop_map(|(x, y, w, h)| PixelBox::from([x, y, w, h]))
    }

    fn found(bbox: PixelBox) -> DetectionBox {
        DetectionBox { image: 1, category: 1, bbox, score: 1.0 }
    }

    #[test]
    fn the_highest_overlap_comes_first_and_of_equals_the_last_box() {
        let at = |x| PixelBox { x, y: 0.0, w: 50.0, h: 40.0 };
        let truth = [5.0, 0.0, 200.0, 5.0].map(|x| GroundTruthBox::new(1, 1, at(x)));
        let mut candidates = Vec::new();
        find_candidates(&found(at(0.0)), &truth.each_ref(), None, &mut candidates);
        assert_eq!(candidates.iter().map(|c| c.truth).collect::<Vec<_>>(), [1, 3, 0]);
    }

    proptest! {
        #[test]
        fn overlap_is_bounded_and_without_crowds_symmetric(a in boxes(), b in boxes(), crowd: bool) {
            for period_px in [None, Some(900.0)] {
                let of = |detection: PixelBox, truth: PixelBox| {
                    let truth = GroundTruthBox { crowd, ..GroundTruthBox::new(1, 1, truth) };
                    overlap(&found(detection), &truth, period_px)
                };
                prop_assert!((0.0..=1.0 + 1e-12).contains(&of(a, b)));
                prop_assert!(crowd || (of(a, b) - of(b, a)).abs() < 1e-12);
            }
        }
    }
}
