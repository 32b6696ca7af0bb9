//! Which candidates of one question match its true boxes, at each of COCO's IoU thresholds.

use jrdb_types::PixelBox;
use jrdb_types::score::{Candidate, MatchMask};

use crate::coco::iou_thresholds;

/// So many candidates of a question count, as in COCO.
const COCO_LIMIT: usize = 100;

/// The best candidates, best first, with their matches. Each, best first, takes the free true box
/// of highest IoU (the last on ties, as COCO's evaluator does) if that reaches the threshold.
pub(crate) fn judged(
    truth: &[PixelBox],
    mut found: Vec<(PixelBox, f64)>,
    period_px: Option<f64>,
) -> Vec<Candidate> {
    found.iter_mut().for_each(|(_, score)| *score = finite(*score));
    found.sort_by(|a, b| b.1.total_cmp(&a.1));
    found.truncate(COCO_LIMIT);
    let row = |bbox: &PixelBox| truth.iter().map(|there| bbox.iou(there, period_px)).collect();
    let ious: Vec<Vec<f64>> = found.iter().map(|(bbox, _)| row(bbox)).collect();
    let matched = iou_thresholds().map(|min_iou| matches(&ious, truth.len(), min_iou));
    let mask = |at: usize| MatchMask::of((0..matched.len()).filter(|&index| matched[index][at]));
    let candidate = |(at, (_, score)): (usize, &(PixelBox, f64))| Candidate {
        score: *score,
        matches: mask(at),
    };
    found.iter().enumerate().map(candidate).collect()
}

/// Which candidates match at one threshold, given their IoU with each true box.
fn matches(ious: &[Vec<f64>], truths: usize, min_iou: f64) -> Vec<bool> {
    let mut is_free = vec![true; truths];
    let take = |row: &Vec<f64>| {
        let fits = |&there: &usize| is_free[there] && row[there] >= min_iou;
        let best = (0..truths).filter(fits).max_by(|&a, &b| row[a].total_cmp(&row[b]));
        best.map(|there| is_free[there] = false).is_some()
    };
    ious.iter().map(take).collect()
}

/// A score that JSON can hold, in the same order: what is not a number comes last, and the two
/// zeros are equal.
fn finite(score: f64) -> f64 {
    if score.is_nan() { f64::MIN } else { score.clamp(f64::MIN, f64::MAX) + 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bar(x: f64, w: f64) -> PixelBox {
        PixelBox::from([x, 0.0, w, 10.0])
    }

    #[test]
    fn the_better_candidate_takes_the_box_at_every_threshold_it_reaches() {
        let found = vec![(bar(0.0, 10.0), 0.4), (bar(0.0, 7.0), 0.9)];
        let judged = judged(&[bar(0.0, 10.0)], found, None);
        assert_eq!(judged[0], Candidate { score: 0.9, matches: MatchMask::of(0..5) });
        assert_eq!(judged[1], Candidate { score: 0.4, matches: MatchMask::of(5..10) });
    }

    #[test]
    fn a_hundred_candidates_count_and_what_is_not_a_number_comes_last() {
        let mut found = vec![(bar(0.0, 10.0), f64::NAN)];
        found.extend((0..120).map(|n| (bar(50.0, 10.0), f64::from(n))));
        let judged = judged(&[bar(0.0, 10.0)], found.clone(), None);
        assert_eq!((judged.len(), judged[0].score), (100, 119.0));
        found.truncate(3);
        let last = super::judged(&[bar(0.0, 10.0)], found, None)[2];
        assert_eq!(last, Candidate { score: f64::MIN, matches: MatchMask::of(0..10) });
    }
}
