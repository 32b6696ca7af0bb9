//! Average precision from judgements, with a weight for each recording.

use jrdb_types::score::{MatchMask, QuestionScore};

/// COCO's number of recall points less one: 0, 0.01 … 1.
const LAST_POINT: usize = 100;

/// Average precision at each of COCO's IoU thresholds.
pub(crate) type Precisions = [f64; MatchMask::THRESHOLDS];

/// Which candidates of an answer are pooled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum List {
    /// All, by their probabilities.
    Ranking,
    /// The selected ones, all equal.
    Selection,
}

/// The candidates of many questions, best first, sorted once for any weights.
pub(crate) struct Pool {
    /// Of each candidate, its question's recording.
    recordings: Vec<u32>,
    /// At each threshold, the places of the candidates that match.
    hits: [Vec<u32>; MatchMask::THRESHOLDS],
    /// Of each recording, how many true boxes there are.
    wanted: Vec<f64>,
}

impl Pool {
    /// Pools questions, each with the number of its recording; equal scores keep the order given.
    pub(crate) fn new(
        questions: &[(usize, &QuestionScore)],
        recordings: usize,
        list: List,
    ) -> Self {
        let about_boxes = || questions.iter().filter(|(_, one)| one.is_about_boxes());
        let mut all: Vec<(f64, u32, MatchMask)> = Vec::new();
        for (recording, one) in about_boxes() {
            let of = *recording as u32;
            match list {
                List::Ranking => all.extend(one.ranking.iter().map(|c| (c.score, of, c.matches))),
                List::Selection => all.extend(one.selection.iter().map(|&mask| (1.0, of, mask))),
            }
        }
        all.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut wanted = vec![0.0; recordings];
        about_boxes().for_each(|(of, one)| wanted[*of] += one.true_boxes() as f64);
        let hits = std::array::from_fn(|threshold| {
            let places = (0..).zip(&all).filter(|(_, one)| one.2.at(threshold));
            places.map(|(place, _)| place).collect()
        });
        Self { recordings: all.iter().map(|one| one.1).collect(), hits, wanted }
    }

    /// How many recordings have a true box.
    pub(crate) fn recordings_with_truth(&self) -> usize {
        self.wanted.iter().filter(|wanted| **wanted > 0.0).count()
    }

    /// Average precision when every recording counts as often as its weight says; `None` when there
    /// is nothing to be found.
    pub(crate) fn average_precision(&self, weights: &[f64]) -> Option<Precisions> {
        let wanted: f64 = weights.iter().zip(&self.wanted).map(|(w, wanted)| w * wanted).sum();
        if wanted <= 0.0 {
            return None;
        }
        let mut counted = 0.0;
        let claimed: Vec<f64> = self
            .recordings
            .iter()
            .map(|&of| {
                counted += weights[of as usize];
                counted
            })
            .collect();
        let mut curve = Vec::new();
        Some(std::array::from_fn(|threshold| {
            self.trace(threshold, weights, &claimed, wanted, &mut curve);
            interpolated_mean(&mut curve)
        }))
    }

    /// Recall and precision at each match, best candidate first: precision falls in between.
    fn trace(
        &self,
        threshold: usize,
        weights: &[f64],
        claimed: &[f64],
        wanted: f64,
        curve: &mut Vec<(f64, f64)>,
    ) {
        curve.clear();
        let mut right = 0.0;
        for &place in &self.hits[threshold] {
            let place = place as usize;
            right += weights[self.recordings[place] as usize];
            // The reference adds the spacing of doubles at 1, so that nothing is divided by zero.
            curve.push((right / wanted, right / (claimed[place] + f64::EPSILON)));
        }
    }
}

/// The mean over COCO's recall points of the best precision at this recall or beyond.
fn interpolated_mean(curve: &mut [(f64, f64)]) -> f64 {
    for i in (1..curve.len()).rev() {
        curve[i - 1].1 = curve[i - 1].1.max(curve[i].1);
    }
    let mut at = 0;
    let precisions = (0..=LAST_POINT).map(|point| {
        while at < curve.len() && curve[at].0 < point as f64 * 0.01 {
            at += 1;
        }
        curve.get(at).map_or(0.0, |point| point.1)
    });
    precisions.sum::<f64>() / (LAST_POINT + 1) as f64
}

/// The mean over COCO's thresholds: mAP@[.50:.95].
pub(crate) fn mean(precisions: &Precisions) -> f64 {
    precisions.iter().fold(0.0, |sum, one| sum + one) / precisions.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::candidates::judged;
    use crate::coco::{self, Area, Config, Dataset, DetectionBox, GroundTruthBox};
    use crate::example::judgement;
    use jrdb_types::PixelBox;
    use proptest::prelude::*;

    type Case = (Vec<PixelBox>, Vec<(PixelBox, f64)>);

    fn boxes() -> impl Strategy<Value = PixelBox> {
        (0.0..60.0, 20.0..60.0).prop_map(|(x, w)| PixelBox::from([x, 0.0, w, 10.0]))
    }

    /// Scores are few, so that many are equal.
    fn cases() -> impl Strategy<Value = Vec<Case>> {
        let found = (boxes(), 0..4_u8).prop_map(|(bbox, score)| (bbox, f64::from(score) / 4.0));
        let found = proptest::collection::vec(found, 0..8);
        proptest::collection::vec((proptest::collection::vec(boxes(), 0..4), found), 1..8)
    }

    fn by_boxes(cases: &[Case]) -> (f64, f64) {
        let mut dataset = Dataset::default();
        for (image, (truth, found)) in (0..).zip(cases) {
            dataset.truth.extend(truth.iter().map(|&bbox| GroundTruthBox::new(image, 1, bbox)));
            dataset.detections.extend(found.iter().map(|&(bbox, score)| DetectionBox {
                image,
                category: 1,
                bbox,
                score,
            }));
        }
        let areas = vec![Area::All];
        let config = Config { max_detections: vec![100], areas, ..Config::default() };
        let statistics = coco::evaluate(&dataset, &config).statistics();
        (statistics.ap, statistics.ap50)
    }

    fn by_judgements(cases: &[Case]) -> (f64, f64) {
        let judge = |(truth, found): &Case| {
            let mut one = judgement("a", 0, &[], truth.len());
            one.ranking = judged(truth, found.clone(), None);
            one
        };
        let judgements: Vec<_> = cases.iter().map(judge).collect();
        let questions: Vec<_> = judgements.iter().map(|one| (0, one)).collect();
        let pool = Pool::new(&questions, 1, List::Ranking);
        pool.average_precision(&[1.0]).map_or((-1.0, -1.0), |all| (mean(&all), all[0]))
    }

    fn pool(copies: &[usize]) -> Vec<(usize, QuestionScore)> {
        let all = [
            judgement("a", 0, &[(0.9, 8), (0.4, 0), (0.3, 5)], 1),
            judgement("b", 0, &[(0.8, 0), (0.5, 10)], 0),
            judgement("c", 0, &[(0.6, 3), (0.2, 0)], 2),
        ];
        let copied = |(of, &copies): (usize, &usize)| vec![(of, all[of].clone()); copies];
        copies.iter().enumerate().flat_map(copied).collect()
    }

    #[test]
    fn a_weight_counts_as_so_many_copies() {
        let of = |copies: &[usize], weights: &[f64]| {
            let pool = pool(copies);
            let questions: Vec<_> = pool.iter().map(|(of, one)| (*of, one)).collect();
            Pool::new(&questions, 3, List::Ranking).average_precision(weights).unwrap()
        };
        let (copied, weighted) = (of(&[2, 0, 3], &[1.0; 3]), of(&[1, 1, 1], &[2.0, 0.0, 3.0]));
        assert!(copied.iter().zip(&weighted).all(|(a, b)| (a - b).abs() < 1e-12), "{copied:?}");
        assert!(copied[0] > copied[9]);
    }

    proptest! {
        #[test]
        fn judgements_give_the_average_precision_that_boxes_give(cases in cases()) {
            let (by_boxes, by_judgements) = (by_boxes(&cases), by_judgements(&cases));
            prop_assert!((by_boxes.0 - by_judgements.0).abs() < 1e-12);
            prop_assert!((by_boxes.1 - by_judgements.1).abs() < 1e-12);
        }
    }
}
