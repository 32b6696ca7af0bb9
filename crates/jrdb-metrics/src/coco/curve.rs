//! From judged detections to interpolated precision at 101 recall points.

use std::cmp::Ordering;

/// What a detection turned out to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Verdict {
    Right,
    Wrong,
    /// Counts neither way.
    Ignored,
}

/// One image's detections, best first, and how many true boxes were to be found in it.
pub(super) struct Judged {
    pub(super) wanted: usize,
    pub(super) detections: Vec<(f64, Verdict)>,
}

/// Descending order of scores; what is not a number comes last, and the two zeros are equal.
pub(super) fn best_first(a: f64, b: f64) -> Ordering {
    let key = |score: f64| if score.is_nan() { f64::NEG_INFINITY } else { score + 0.0 };
    key(b).total_cmp(&key(a))
}

/// Interpolated precision at recall 0, 0.01 … 1, and the final recall; `None` if nothing was to be
/// found.
pub(super) fn curve(images: &[Judged], max_detections: usize) -> Option<(Vec<f64>, f64)> {
    let wanted: usize = images.iter().map(|image| image.wanted).sum();
    if wanted == 0 {
        return None;
    }
    let counted = |image: &'_ Judged| image.detections.len().min(max_detections);
    let mut pooled: Vec<(f64, Verdict)> =
        images.iter().flat_map(|i| i.detections[..counted(i)].iter().copied()).collect();
    pooled.sort_by(|a, b| best_first(a.0, b.0));

    let (mut right, mut wrong) = (0.0, 0.0);
    let (mut recall, mut precision) = (Vec::new(), Vec::new());
    for (_, verdict) in pooled {
        match verdict {
            Verdict::Right => right += 1.0,
            Verdict::Wrong => wrong += 1.0,
            Verdict::Ignored => {}
        }
        recall.push(right / wanted as f64);
        // The reference adds the spacing of doubles at 1, so that nothing is divided by zero.
        precision.push(right / (wrong + right + f64::EPSILON));
    }
    for i in (1..precision.len()).rev() {
        precision[i - 1] = precision[i - 1].max(precision[i]);
    }
    let at_recall = |point: usize| {
        let reached = recall.partition_point(|&r| r < point as f64 * 0.01);
        precision.get(reached).copied().unwrap_or(0.0)
    };
    Some(((0..=100).map(at_recall).collect(), recall.last().copied().unwrap_or(0.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn precision_is_the_best_at_this_recall_or_beyond() {
        let detections = vec![
            (0.9, Verdict::Right),
            (0.8, Verdict::Wrong),
            (0.7, Verdict::Ignored),
            (0.6, Verdict::Right),
        ];
        let (precision, recall) = curve(&[Judged { wanted: 4, detections }], 100).unwrap();
        assert_eq!(recall, 0.5);
        assert!((precision[25] - 1.0).abs() < 1e-12);
        assert!((precision[26] - 2.0 / 3.0).abs() < 1e-12);
        assert!((precision[50] - 2.0 / 3.0).abs() < 1e-12);
        assert_eq!(precision[51], 0.0);
    }

    #[test]
    fn the_limit_cuts_each_image() {
        let image =
            || Judged { wanted: 1, detections: vec![(0.9, Verdict::Wrong), (0.8, Verdict::Right)] };
        assert_eq!(curve(&[image(), image()], 1).unwrap().1, 0.0);
        assert_eq!(curve(&[image(), image()], 2).unwrap().1, 1.0);
    }

    #[test]
    fn what_is_not_a_number_comes_last() {
        let mut scores = [f64::NAN, 0.1, f64::INFINITY, -0.0, 0.0];
        scores.sort_by(|a, b| best_first(*a, *b));
        assert_eq!(scores[..2], [f64::INFINITY, 0.1]);
        assert!(scores[4].is_nan());
    }
}
