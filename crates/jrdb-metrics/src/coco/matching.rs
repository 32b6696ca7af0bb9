//! Which detections are right, for all area ranges and IoU thresholds at once.

use super::candidates::{Candidate, find_candidates};
use super::cells::{ALL_CELLS, Cells, cells_of_area};
use super::dataset::{DetectionBox, GroundTruthBox};
use super::groups::Group;

/// What a detection turned out to be; in the cells of neither set it is ignored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Verdict {
    /// The cells in which it is a true positive.
    pub(super) true_positive: Cells,
    /// The cells in which it is a false positive.
    pub(super) false_positive: Cells,
}

/// Matches the boxes of one image after the other, in memory that is used again.
pub(super) struct Matcher {
    period_px: Option<f64>,
    /// For each true box of the image, the cells in which it is to be found.
    counted: Vec<Cells>,
    /// For each true box of the image, the cells in which a detection has taken it.
    taken: Vec<Cells>,
    /// The true boxes that the detection may take.
    candidates: Vec<Candidate>,
}

impl Matcher {
    /// On the circle when a period is given, else on the plane.
    pub(super) fn new(period_px: Option<f64>) -> Self {
        Self { period_px, counted: Vec::new(), taken: Vec::new(), candidates: Vec::new() }
    }

    /// Goes to the next image and returns the cells in which each of its true boxes is to be found.
    pub(super) fn enter(&mut self, group: &Group<'_>) -> &[Cells] {
        let counted = |t: &&GroundTruthBox| if t.crowd { 0 } else { cells_of_area(t.area_px2) };
        self.counted.clear();
        self.counted.extend(group.truth.iter().map(counted));
        self.taken.clear();
        self.taken.resize(group.truth.len(), 0);
        &self.counted
    }

    /// Judges the next detection of the image; the best come first.
    pub(super) fn judge(&mut self, detection: &DetectionBox, group: &Group<'_>) -> Verdict {
        find_candidates(detection, group.truth, self.period_px, &mut self.candidates);
        let true_positive = self.take(group.truth, ALL_CELLS, |counted| counted);
        let ignored = self.take(group.truth, !true_positive, |counted| !counted);
        let matched = true_positive | ignored;
        let false_positive = cells_of_area(detection.bbox.area_px2()) & !matched;
        Verdict { true_positive, false_positive }
    }

    /// Takes in each open cell the first free candidate that is eligible there, and returns the
    /// cells in which there was one.
    fn take(
        &mut self,
        truth: &[&GroundTruthBox],
        mut open: Cells,
        eligible: impl Fn(Cells) -> Cells,
    ) -> Cells {
        let before = open;
        for &Candidate { truth: at, reached, .. } in &self.candidates {
            let free = if truth[at].crowd { ALL_CELLS } else { !self.taken[at] };
            let takes = open & reached & free & eligible(self.counted[at]);
            self.taken[at] |= takes;
            open &= !takes;
        }
        before & !open
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::coco::cells::cell;
    use crate::coco::config::Area;
    use jrdb_types::PixelBox;

    fn at(x: f64) -> PixelBox {
        PixelBox { x, y: 0.0, w: 50.0, h: 40.0 }
    }

    fn verdicts(truth: &[GroundTruthBox], detections: &[f64]) -> Vec<Verdict> {
        let detections: Vec<_> = detections
            .iter()
            .map(|&x| DetectionBox { image: 1, category: 1, bbox: at(x), score: 1.0 })
            .collect();
        let truth: Vec<_> = truth.iter().collect();
        let detections: Vec<_> = detections.iter().collect();
        let group = Group { truth: &truth, detections: &detections };
        let mut matcher = Matcher::new(None);
        matcher.enter(&group);
        detections.iter().map(|d| matcher.judge(d, &group)).collect()
    }

    #[test]
    fn a_box_is_taken_only_at_the_thresholds_that_the_better_detection_does_not_reach() {
        let truth = [GroundTruthBox::new(1, 1, at(0.0))];
        let [first, second] = verdicts(&truth, &[10.0, 0.0])[..] else { unreachable!() };
        let is_right =
            |verdict: Verdict, threshold| verdict.true_positive & cell(Area::All, threshold) != 0;
        // The first has an IoU of 2/3 and so reaches 0.65 and no more.
        assert_eq!([2, 3, 4].map(|threshold| is_right(first, threshold)), [true, true, false]);
        assert_eq!([2, 3, 4].map(|threshold| is_right(second, threshold)), [false, false, true]);
        assert_eq!(first.true_positive & first.false_positive, 0);
    }

    #[test]
    fn what_takes_a_box_of_another_area_range_is_ignored_there() {
        let truth = [GroundTruthBox { area_px2: 10.0, ..GroundTruthBox::new(1, 1, at(0.0)) }];
        let verdict = verdicts(&truth, &[0.0])[0];
        let bits = |area| {
            [verdict.true_positive, verdict.false_positive].map(|cells| cells & cell(area, 0) != 0)
        };
        assert_eq!(Area::ALL.map(bits), [[true, false], [true, false], [false; 2], [false; 2]]);
    }

    #[test]
    fn of_equal_overlaps_the_last_box_is_taken() {
        let small = GroundTruthBox { area_px2: 10.0, ..GroundTruthBox::new(1, 1, at(0.0)) };
        let large = GroundTruthBox { area_px2: 1e5, ..small };
        let verdict = verdicts(&[large, small], &[0.0])[0];
        assert_ne!(verdict.true_positive & cell(Area::All, 0), 0);
        let again = verdicts(&[large, small], &[0.0, 0.0]);
        // The small one is gone, and the large one is left for the second.
        assert_eq!(again[1].true_positive & cell(Area::All, 0), cell(Area::All, 0));
        assert_eq!(again[1].true_positive & cell(Area::Small, 0), 0);
    }

    #[test]
    fn a_crowd_takes_any_number_of_detections_and_none_is_right() {
        let crowd = GroundTruthBox { crowd: true, ..GroundTruthBox::new(1, 1, at(0.0)) };
        let neither = Verdict { true_positive: 0, false_positive: 0 };
        assert_eq!(verdicts(&[crowd], &[0.0, 0.0]), [neither; 2]);
    }
}
