//! Which selected box answers which true box of one question.

use jrdb_types::PixelBox;

/// Result of matching one question's boxes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Matches {
    /// Number of true boxes that found a selected box.
    pub count: usize,
    /// Sum of the IoU of the matched pairs.
    pub iou_sum: f64,
}

/// Matches greedily, as the JRDB-Reasoning evaluator does: true boxes in their order, each takes the
/// remaining selected box of highest IoU (the first on ties), if that IoU is at least `min_iou`.
///
/// IoU is taken on the circle when a period (pixels) is given, else on the plane.
///
/// ```
/// use jrdb_metrics::match_boxes;
/// use jrdb_types::PixelBox;
/// let truth = [PixelBox::from([0.0, 0.0, 10.0, 10.0])];
/// let selected = [PixelBox::from([0.0, 0.0, 10.0, 8.0])];
/// assert_eq!(match_boxes(&truth, &selected, 0.5, None).iou_sum, 0.8);
/// ```
#[must_use]
pub fn match_boxes(
    truth: &[PixelBox],
    selected: &[PixelBox],
    min_iou: f64,
    period_px: Option<f64>,
) -> Matches {
    let mut remaining: Vec<&PixelBox> = selected.iter().collect();
    let mut matches = Matches::default();
    for true_box in truth {
        let Some((at, iou)) = best(true_box, &remaining, period_px) else { break };
        if iou >= min_iou {
            remaining.remove(at);
            matches.count += 1;
            matches.iou_sum += iou;
        }
    }
    matches
}

fn best(wanted: &PixelBox, boxes: &[&PixelBox], period_px: Option<f64>) -> Option<(usize, f64)> {
    let ious = boxes.iter().map(|b| b.iou(wanted, period_px)).enumerate();
    ious.reduce(|best, next| if next.1 > best.1 { next } else { best })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn bar(x: f64, w: f64) -> PixelBox {
        PixelBox::from([x, 0.0, w, 10.0])
    }

    #[test]
    fn the_first_true_box_chooses_first_even_where_the_second_fits_better() {
        let matches = match_boxes(&[bar(0.0, 10.0), bar(2.0, 10.0)], &[bar(2.0, 10.0)], 0.5, None);
        assert_eq!(matches, Matches { count: 1, iou_sum: 8.0 / 12.0 });
    }

    #[test]
    fn half_is_enough_and_less_is_not() {
        let truth = [bar(0.0, 10.0)];
        assert_eq!(match_boxes(&truth, &[bar(0.0, 5.0)], 0.5, None).count, 1);
        assert_eq!(match_boxes(&truth, &[bar(0.0, 4.9)], 0.5, None).count, 0);
    }

    #[test]
    fn a_refused_box_stays_for_the_next_true_box() {
        let truth = [bar(0.0, 10.0), bar(6.0, 10.0)];
        assert_eq!(match_boxes(&truth, &[bar(6.0, 10.0)], 0.5, None).count, 1);
    }

    #[test]
    fn the_seam_matters_only_on_the_plane() {
        let (truth, selected) = ([bar(95.0, 10.0)], [bar(-5.0, 10.0)]);
        assert_eq!(match_boxes(&truth, &selected, 0.5, None).count, 0);
        assert_eq!(match_boxes(&truth, &selected, 0.5, Some(100.0)).iou_sum, 1.0);
    }

    fn bars() -> impl Strategy<Value = Vec<PixelBox>> {
        proptest::collection::vec((0.0..100.0, 1.0..60.0).prop_map(|(x, w)| bar(x, w)), 0..8)
    }

    proptest! {
        #[test]
        fn every_box_matches_itself(boxes in bars()) {
            let matches = match_boxes(&boxes, &boxes, 0.5, Some(200.0));
            prop_assert_eq!(matches.count, boxes.len());
            prop_assert!((matches.iou_sum - boxes.len() as f64).abs() < 1e-9);
        }

        #[test]
        fn a_turn_of_the_panorama_changes_nothing(truth in bars(), selected in bars(), turn in 0.0..200.0) {
            let turned = |boxes: &[PixelBox]| -> Vec<PixelBox> {
                boxes.iter().map(|b| PixelBox { x: b.x + turn, ..*b }.wrapped(200.0)).collect()
            };
            // A threshold that no pair of random boxes meets exactly.
            let min_iou = 0.500_000_123;
            let before = match_boxes(&truth, &selected, min_iou, Some(200.0));
            let after = match_boxes(&turned(&truth), &turned(&selected), min_iou, Some(200.0));
            prop_assert_eq!(before.count, after.count);
            prop_assert!((before.iou_sum - after.iou_sum).abs() < 1e-9);
        }
    }
}
