//! Boxes in a sequence of tokens, each with its confidence.

use super::location::BINS;
use crate::detector::PerceptionError;
use crate::generation::Sequence;

/// A box that the model wrote.
#[derive(Debug, Clone, PartialEq)]
pub struct DecodedBox {
    /// The words before it.
    pub label: String,
    /// Its corners x0, y0, x1, y1, pixels of the picture; perhaps inverted.
    pub corners: [f64; 4],
    /// Geometric mean of the probabilities of its label's tokens and its four locations, in `[0,
    /// 1]`.
    pub score: f64,
}

/// A box with the tokens of its label.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TokenBox {
    label: Vec<u32>,
    corners: [f64; 4],
    score: f64,
}

impl TokenBox {
    pub(super) fn labelled(
        self,
        read: impl Fn(&[u32]) -> Result<String, PerceptionError>,
    ) -> Result<DecodedBox, PerceptionError> {
        Ok(DecodedBox { label: read(&self.label)?, corners: self.corners, score: self.score })
    }
}

/// The boxes of a sequence: words, then four locations for each of one or several boxes. Fewer than
/// four locations are skipped.
pub(super) fn decoded_boxes(
    sequence: &Sequence,
    first_location: u32,
    size_px: [f64; 2],
) -> Vec<TokenBox> {
    let bin = |id: u32| id.checked_sub(first_location).filter(|bin| f64::from(*bin) < BINS);
    let tokens: Vec<(u32, f64)> =
        sequence.ids.iter().copied().skip(1).zip(sequence.log_probs.iter().copied()).collect();
    let (mut label, mut found) = (Vec::new(), Vec::new());
    for run in tokens.chunk_by(|a, b| bin(a.0).is_some() == bin(b.0).is_some()) {
        if bin(run[0].0).is_none() {
            label = run.to_vec();
            continue;
        }
        for place in run.chunks_exact(4) {
            let px = |axis: usize| {
                let bin = bin(place[axis].0).map_or(0.0, f64::from);
                (bin + 0.5) * size_px[axis % 2] / BINS
            };
            let logs = label.iter().chain(place).map(|(_, log)| log);
            let score = (logs.sum::<f64>() / (label.len() + 4) as f64).exp();
            let label = label.iter().map(|(id, _)| *id).collect();
            found.push(TokenBox { label, corners: [px(0), px(1), px(2), px(3)], score });
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_four_locations_are_a_box_of_the_words_before() {
        let ids = vec![2, 0, 7, 100, 101, 102, 103, 104, 105, 106, 107, 8, 110, 111, 2];
        let log_probs = vec![-0.1; ids.len() - 1];
        let found = decoded_boxes(&Sequence { ids, log_probs, score: 0.0 }, 100, [1000.0, 500.0]);
        assert_eq!(found.len(), 2);
        assert_eq!(found[1].label, [0, 7]);
        assert_eq!(found[0].corners, [0.5, 0.75, 2.5, 1.75]);
        assert!((found[0].score - (-0.1_f64).exp()).abs() < 1e-12);
    }
}
