//! From the judged detections of a category to interpolated precision at 101 recall points.

use std::cmp::Reverse;

use super::cells::{Cells, cell};
use super::config::{Area, iou_thresholds};
use super::evaluation::Curve;
use super::groups::{Category, rank};
use super::matching::{Matcher, Verdict};

/// Recall points.
const POINTS: usize = 101;
/// Between two recall points.
const STEP: f64 = 0.01;

/// The judged detections of a category, from all its images.
pub(super) struct Pool {
    category: u64,
    /// For each area range the true boxes that are to be found.
    positives: [usize; Area::ALL.len()],
    /// Best first.
    judged: Vec<Judged>,
}

#[derive(Clone, Copy)]
struct Judged {
    rank: Reverse<i64>,
    /// How many detections of the same image are better.
    better: usize,
    verdict: Verdict,
}

impl Pool {
    /// Judges at most so many detections of each image.
    pub(super) fn new(category: Category<'_>, most: usize, matcher: &mut Matcher) -> Self {
        let mut positives = [0; Area::ALL.len()];
        let mut judged = Vec::new();
        for group in category.images() {
            for cells in matcher.enter(&group) {
                for (area, count) in Area::ALL.into_iter().zip(&mut positives) {
                    *count += usize::from(cells & cell(area, 0) != 0);
                }
            }
            judged.extend(group.detections.iter().take(most).enumerate().map(|(better, d)| {
                Judged { rank: rank(d.score), better, verdict: matcher.judge(d, &group) }
            }));
        }
        // Stable: among equal scores, images go by number.
        judged.sort_by_key(|one| one.rank);
        Self { category: category.id, positives, judged }
    }

    /// The curves of the area ranges that have positives, for every threshold and limit.
    pub(super) fn curves(&self, areas: &[Area], limits: &[usize]) -> Vec<Curve> {
        let limited: Vec<Vec<Verdict>> = limits.iter().map(|&limit| self.best(limit)).collect();
        let mut curves = Vec::new();
        for &area in areas.iter().filter(|&&area| self.positives[area as usize] > 0) {
            let recall_points = RecallPoints::new(self.positives[area as usize]);
            for threshold in 0..iou_thresholds().len() {
                let cell = cell(area, threshold);
                for (&max_detections, verdicts) in limits.iter().zip(&limited) {
                    let (precision, recall) = recall_points.precision(verdicts, cell);
                    let category = self.category;
                    curves.push(Curve {
                        category,
                        threshold,
                        area,
                        max_detections,
                        precision,
                        recall,
                    });
                }
            }
        }
        curves
    }

    /// The verdicts on the best detections of each image, at most `limit` of each.
    fn best(&self, limit: usize) -> Vec<Verdict> {
        self.judged.iter().filter(|one| one.better < limit).map(|one| one.verdict).collect()
    }
}

/// How many true positives reach each recall point.
struct RecallPoints {
    positives: usize,
    needed: Vec<usize>,
}

impl RecallPoints {
    fn new(positives: usize) -> Self {
        let needed = |point: usize| {
            let recall = point as f64 * STEP;
            // One less than what rounding may have made too many.
            let least = ((recall * positives as f64) as usize).saturating_sub(1);
            let reaches = |count: &usize| *count as f64 / positives as f64 >= recall;
            (least..=positives).find(reaches).unwrap_or(positives)
        };
        Self { positives, needed: (0..POINTS).map(needed).collect() }
    }

    /// Interpolated precision at every point, and the final recall, in one cell.
    ///
    /// Only a true positive raises the recall, and no other detection has a higher precision than
    /// the true positive before it: the rest is only counted.
    fn precision(&self, verdicts: &[Verdict], cell: Cells) -> (Vec<f64>, f64) {
        let mut precision = vec![0.0; POINTS];
        let (mut true_positives, mut false_positives, mut reached) = (0, 0, 0);
        for verdict in verdicts {
            if verdict.true_positive & cell != 0 {
                true_positives += 1;
                reached += self.needed[reached..]
                    .iter()
                    .take_while(|&&needed| needed <= true_positives)
                    .count();
                // The reference adds the spacing of doubles at 1, lest it divide by zero.
                let all = false_positives as f64 + true_positives as f64 + f64::EPSILON;
                let best: &mut f64 = &mut precision[reached - 1];
                *best = best.max(true_positives as f64 / all);
            } else {
                false_positives += usize::from(verdict.false_positive & cell != 0);
            }
        }
        for point in (1..POINTS).rev() {
            precision[point - 1] = precision[point - 1].max(precision[point]);
        }
        (precision, true_positives as f64 / self.positives as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CELL: Cells = 1;

    fn verdicts(text: &str) -> Vec<Verdict> {
        let of = |letter| Verdict {
            true_positive: u64::from(letter == 't') * CELL,
            false_positive: u64::from(letter == 'f') * CELL,
        };
        text.chars().map(of).collect()
    }

    #[test]
    fn precision_is_the_best_at_this_recall_or_beyond() {
        let (precision, recall) = RecallPoints::new(4).precision(&verdicts("tfit"), CELL);
        assert_eq!(recall, 0.5);
        assert!((precision[25] - 1.0).abs() < 1e-12);
        assert!((precision[26] - 2.0 / 3.0).abs() < 1e-12);
        assert!((precision[50] - 2.0 / 3.0).abs() < 1e-12);
        assert_eq!(precision[51], 0.0);
    }

    #[test]
    fn without_a_true_positive_precision_and_recall_are_zero() {
        let (precision, recall) = RecallPoints::new(3).precision(&verdicts("fif"), CELL);
        assert_eq!((precision, recall), (vec![0.0; 101], 0.0));
    }

    #[test]
    fn the_count_that_a_recall_point_needs_is_the_least_that_reaches_it() {
        for positives in [1, 3, 7, 100, 4321] {
            for (point, needed) in RecallPoints::new(positives).needed.into_iter().enumerate() {
                let reaches = |count: usize| count as f64 / positives as f64 >= point as f64 * 0.01;
                assert!(reaches(needed), "{point} of {positives}");
                assert!(needed == 0 || !reaches(needed - 1), "{point} of {positives}");
            }
        }
    }
}
