//! Non-maximum suppression on the circle: of boxes that show the same object, the best is kept.

use jrdb_types::PixelBox;

/// A box and how sure the detector is of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScoredBox {
    /// Where, pixels.
    pub bbox: PixelBox,
    /// Confidence in `[0, 1]`.
    pub score: f64,
}

/// Keeps the best of every group of boxes that overlap by more than `max_iou`; best first.
///
/// IoU is taken on the circle when a period (pixels) is given, else on the plane. Scores that
/// differ by less than about 1e-4 count as equal and the larger box wins, so that the rounding of
/// different engines does not decide: confident scores crowd together just below 1.
///
/// ```
/// use jrdb_perception::tiling::{ScoredBox, nms};
/// use jrdb_types::PixelBox;
/// let one = ScoredBox { bbox: PixelBox::from([95.0, 0.0, 10.0, 10.0]), score: 0.9 };
/// let same = ScoredBox { bbox: PixelBox::from([-4.0, 0.0, 10.0, 10.0]), score: 0.8 };
/// assert_eq!(nms(&[same, one], 0.5, Some(100.0)), [one]);
/// ```
#[must_use]
pub fn nms(boxes: &[ScoredBox], max_iou: f64, period_px: Option<f64>) -> Vec<ScoredBox> {
    let mut ordered = boxes.to_vec();
    ordered.sort_by(|a, b| {
        let (better, larger) = (
            binned(b.score).cmp(&binned(a.score)),
            b.bbox.area_px2().total_cmp(&a.bbox.area_px2()),
        );
        better.then(larger).then(a.bbox.x.total_cmp(&b.bbox.x)).then(a.bbox.y.total_cmp(&b.bbox.y))
    });
    let mut kept: Vec<ScoredBox> = Vec::new();
    for candidate in ordered {
        if kept.iter().all(|k| k.bbox.iou(&candidate.bbox, period_px) <= max_iou) {
            kept.push(candidate);
        }
    }
    kept
}

fn binned(score: f64) -> i64 {
    const BINS: f64 = 1e4;
    (score * BINS).round() as i64
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const PERIOD_PX: f64 = 500.0;

    /// Boxes whose scores differ by more than a bin, in random order.
    fn boxes() -> impl Strategy<Value = Vec<ScoredBox>> {
        let one = (0.0..500.0, 0.0..50.0, 5.0..120.0, 5.0..120.0);
        proptest::collection::vec(one, 0..25).prop_map(|all| {
            let scored = |(i, (x, y, w, h)): (usize, (f64, f64, f64, f64))| {
                let score = (i * 7 % 25) as f64 / 25.0;
                ScoredBox { bbox: PixelBox { x, y, w, h }, score }
            };
            all.into_iter().enumerate().map(scored).collect()
        })
    }

    fn kept(boxes: &[ScoredBox]) -> Vec<ScoredBox> {
        nms(boxes, 0.3, Some(PERIOD_PX))
    }

    #[test]
    fn nearly_equal_scores_leave_the_larger_box_whichever_is_ahead() {
        let at = |w, score| ScoredBox { bbox: PixelBox::from([0.0, 0.0, w, 10.0]), score };
        for (small, large) in [(0.999_991, 0.999_992), (0.999_992, 0.999_991)] {
            let kept = nms(&[at(9.0, small), at(10.0, large)], 0.5, None);
            assert_eq!(kept, [at(10.0, large)]);
        }
    }

    #[test]
    fn boxes_on_both_sides_of_the_seam_are_the_same_only_on_the_circle() {
        let at = |x, score| ScoredBox { bbox: PixelBox::from([x, 0.0, 40.0, 40.0]), score };
        let pair = [at(490.0, 0.9), at(-5.0, 0.8)];
        assert_eq!(nms(&pair, 0.5, Some(PERIOD_PX)).len(), 1);
        assert_eq!(nms(&pair, 0.5, None).len(), 2);
    }

    proptest! {
        #[test]
        fn what_is_kept_is_kept_again(boxes in boxes()) {
            let once = kept(&boxes);
            prop_assert_eq!(&kept(&once), &once);
        }

        #[test]
        fn the_order_of_the_boxes_does_not_matter(boxes in boxes()) {
            let mut turned = boxes.clone();
            turned.reverse();
            prop_assert_eq!(kept(&turned), kept(&boxes));
        }

        #[test]
        fn nothing_kept_overlaps_and_everything_dropped_overlaps_a_better_one(boxes in boxes()) {
            let kept = kept(&boxes);
            let iou = |a: &ScoredBox, b: &ScoredBox| a.bbox.iou(&b.bbox, Some(PERIOD_PX));
            for (i, a) in kept.iter().enumerate() {
                prop_assert!(kept[..i].iter().all(|b| iou(a, b) <= 0.3));
            }
            for b in boxes.iter().filter(|b| !kept.contains(b)) {
                prop_assert!(kept.iter().any(|k| k.score > b.score && iou(k, b) > 0.3));
            }
        }

        #[test]
        fn a_turn_of_the_panorama_keeps_the_same_boxes(boxes in boxes(), turn in 0.0..500.0) {
            let turned: Vec<ScoredBox> = boxes.iter().map(|b| {
                let moved = PixelBox { x: b.bbox.x + turn, ..b.bbox };
                ScoredBox { bbox: moved.wrapped(PERIOD_PX), ..*b }
            }).collect();
            let scores = |kept: Vec<ScoredBox>| kept.iter().map(|k| k.score).collect::<Vec<_>>();
            prop_assert_eq!(scores(kept(&turned)), scores(kept(&boxes)));
        }
    }
}
