//! Whether the probabilities of rankings are what they say.

use jrdb_types::score::{QuestionScore, Reliability, ReliabilityBin};

/// As in Guo and others, 2017.
const BINS: usize = 15;

/// The expected calibration error of ranked probabilities, with its 15 bins of equal width (Guo et
/// al., "On Calibration of Modern Neural Networks", 2017).
///
/// A candidate is right when it matches a true box at IoU 0.5. Probabilities outside of `[0, 1]`
/// count as 0 or 1. Questions whose truth has no boxes to be matched are left out.
///
/// ```
/// let nothing = jrdb_metrics::reliability(&[]);
/// assert_eq!((nothing.calibration_error, nothing.bins.len()), (0.0, 15));
/// ```
#[must_use]
pub fn reliability(questions: &[QuestionScore]) -> Reliability {
    let mut sums = [(0_usize, 0.0, 0_usize); BINS];
    let asked = questions.iter().filter(|one| one.is_about_boxes());
    for candidate in asked.flat_map(|one| &one.ranking) {
        let probability = candidate.score.clamp(0.0, 1.0);
        let (count, sum, right) = &mut sums[bin(probability)];
        *count += 1;
        *sum += probability;
        *right += usize::from(candidate.matches.at(0));
    }
    let bins: Vec<ReliabilityBin> =
        sums.iter().enumerate().map(|(at, of)| closed(at, *of)).collect();
    let count: usize = bins.iter().map(|bin| bin.count).sum();
    let error = |bin: &ReliabilityBin| bin.count as f64 * (bin.right - bin.probability).abs();
    let sum: f64 = bins.iter().map(error).sum();
    Reliability { calibration_error: sum / count.max(1) as f64, bins }
}

/// The bin of a probability: open below, closed above.
fn bin(probability: f64) -> usize {
    ((probability * BINS as f64).ceil() as usize).clamp(1, BINS) - 1
}

fn closed(at: usize, (count, sum, right): (usize, f64, usize)) -> ReliabilityBin {
    let [from, to] = [at, at + 1].map(|edge| edge as f64 / BINS as f64);
    let mean = |sum: f64| if count == 0 { 0.0 } else { sum / count as f64 };
    ReliabilityBin { from, to, count, probability: mean(sum), right: mean(right as f64) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::example::judgement;

    #[test]
    fn the_error_is_the_gap_of_each_bin_by_its_candidates() {
        let questions = [
            judgement("a", 0, &[(0.9, 10), (0.9, 0), (0.1, 0)], 1),
            judgement("a", 1, &[(0.9, 3), (0.9, 1)], 0),
        ];
        let found = reliability(&questions);
        let last = found.bins.iter().rfind(|bin| bin.count > 0).unwrap();
        assert_eq!((last.count, last.right), (4, 0.75));
        assert!((last.probability - 0.9).abs() < 1e-12);
        assert!((found.calibration_error - (4.0 * 0.15 + 0.1) / 5.0).abs() < 1e-12);
    }

    #[test]
    fn bins_are_closed_above() {
        assert_eq!([0.0, 1.0 / 15.0, 0.07, 1.0].map(bin), [0, 0, 1, 14]);
    }
}
