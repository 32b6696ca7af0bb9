//! COCO box evaluation: average precision and recall as the reference evaluator computes them
//! (<https://cocodataset.org/#detection-eval>), on the plane or on the circle.

mod candidates;
mod cells;
mod config;
mod curve;
mod dataset;
mod evaluation;
mod groups;
mod matching;

pub use config::{Area, Config, iou_thresholds};
pub use dataset::{Dataset, DetectionBox, GroundTruthBox};
pub use evaluation::{Curve, Evaluation, Statistics};

use curve::Pool;
use groups::Grouped;
use matching::Matcher;

/// Evaluates detections against ground truth.
///
/// Each detection, best first, takes the free true box of highest IoU (the last on ties, as the
/// reference does) if that reaches the threshold. True boxes that do not count (crowds, other
/// areas) are taken only when no other fits, and what takes them does not count either.
///
/// One thread. Boxes are grouped with one sort, each pair of boxes in an image is compared once,
/// and each detection is matched once for all thresholds and area ranges.
#[must_use]
pub fn evaluate(dataset: &Dataset, config: &Config) -> Evaluation {
    let mut max_detections = config.max_detections.clone();
    max_detections.sort_unstable();
    max_detections.dedup();
    let most = max_detections.last().copied().unwrap_or(0);
    let mut matcher = Matcher::new(config.period_px);
    let mut curves = Vec::new();
    for category in Grouped::new(dataset).categories() {
        let pool = Pool::new(category, most, &mut matcher);
        curves.extend(pool.curves(&config.areas, &max_detections));
    }
    Evaluation { curves, max_detections }
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

    fn datasets() -> impl Strategy<Value = Dataset> {
        let truth =
            (0..3_u64, boxes(), proptest::bool::weighted(0.1)).prop_map(|(image, bbox, crowd)| {
                GroundTruthBox { crowd, ..GroundTruthBox::new(image, 1, bbox) }
            });
        let truths = proptest::collection::vec(truth, 0..12);
        let wrong = proptest::collection::vec((0..3_u64, boxes(), 0.0..1.0), 0..8);
        let near = proptest::collection::vec((0.0..1.0, 0.0..40.0), 12);
        (truths, wrong, near).prop_map(|(truth, wrong, near)| {
            let moved = truth.iter().zip(near).map(|(t, (score, shift))| DetectionBox {
                image: t.image,
                category: 1,
                bbox: PixelBox { x: t.bbox.x + shift, ..t.bbox },
                score,
            });
            let wrong = wrong.into_iter().map(|(image, bbox, score)| DetectionBox {
                image,
                category: 1,
                bbox,
                score,
            });
            Dataset { detections: moved.chain(wrong).collect(), truth }
        })
    }

    fn numbers(dataset: &Dataset, config: &Config) -> Vec<f64> {
        evaluate(dataset, config).statistics().to_vec()
    }

    fn close(a: &[f64], b: &[f64]) -> bool {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9)
    }

    #[test]
    fn thresholds_are_the_references_to_the_last_bit() {
        let expected = [0.5, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8, 0.85, 0.8999999999999999, 0.95];
        assert_eq!(iou_thresholds(), expected);
    }

    #[test]
    fn without_ground_truth_every_number_is_minus_one() {
        let bbox = PixelBox::from([0.0, 0.0, 1.0, 1.0]);
        let detections = vec![DetectionBox { image: 1, category: 1, bbox, score: 1.0 }];
        let dataset = Dataset { truth: vec![], detections };
        assert_eq!(numbers(&dataset, &Config::default()), vec![-1.0; 12]);
    }

    #[test]
    fn a_detection_inside_a_crowd_costs_nothing() {
        let at = |x, w| PixelBox::from([x, 0.0, w, 40.0]);
        let crowd = GroundTruthBox { crowd: true, ..GroundTruthBox::new(1, 1, at(100.0, 200.0)) };
        let found = |x, score| DetectionBox { image: 1, category: 1, bbox: at(x, 40.0), score };
        let dataset = Dataset {
            truth: vec![crowd, GroundTruthBox::new(1, 1, at(0.0, 40.0))],
            detections: vec![found(120.0, 0.9), found(200.0, 0.8), found(0.0, 0.7)],
        };
        assert!(evaluate(&dataset, &Config::default()).statistics().ap > 1.0 - 1e-12);
    }

    #[test]
    fn the_limit_of_detections_cuts_each_image() {
        let bbox = PixelBox::from([0.0, 0.0, 40.0, 40.0]);
        let images = || [1, 2].into_iter();
        let wrong = PixelBox { x: 100.0, ..bbox };
        let found = |image, bbox, score| DetectionBox { image, category: 1, bbox, score };
        let dataset = Dataset {
            truth: images().map(|image| GroundTruthBox::new(image, 1, bbox)).collect(),
            detections: images()
                .flat_map(|image| [found(image, wrong, 0.9), found(image, bbox, 0.8)])
                .collect(),
        };
        let config = Config { max_detections: vec![2, 1], ..Config::default() };
        assert_eq!(evaluate(&dataset, &config).statistics().ar, [0.0, 1.0]);
    }

    #[test]
    fn curves_are_in_the_order_of_category_area_threshold_and_limit() {
        let bbox = PixelBox::from([0.0, 0.0, 40.0, 40.0]);
        let truth = vec![GroundTruthBox::new(1, 7, bbox), GroundTruthBox::new(1, 3, bbox)];
        let config = Config { areas: vec![Area::Medium, Area::All], ..Config::default() };
        let curves = evaluate(&Dataset { truth, detections: vec![] }, &config).curves;
        let areas = |area| config.areas.iter().position(|&one| one == area);
        let keys: Vec<_> = curves
            .iter()
            .map(|c| (c.category, areas(c.area), c.threshold, c.max_detections))
            .collect();
        assert_eq!(curves.len(), 2 * 2 * 10 * 3);
        assert!(keys.is_sorted());
    }

    proptest! {
        #[test]
        fn every_number_is_minus_one_or_between_zero_and_one(dataset in datasets()) {
            for n in numbers(&dataset, &Config::default()) {
                prop_assert!(n == -1.0 || (0.0..=1.0 + 1e-12).contains(&n));
            }
        }

        #[test]
        fn the_order_of_the_inputs_does_not_matter(dataset in datasets()) {
            let mut turned = dataset.clone();
            turned.truth.reverse();
            turned.detections.reverse();
            let config = Config::default();
            prop_assert!(close(&numbers(&dataset, &config), &numbers(&turned, &config)));
        }

        #[test]
        fn a_turn_of_the_panorama_changes_nothing(dataset in datasets(), turn in 0.0..900.0) {
            let config = Config { period_px: Some(900.0), ..Config::default() };
            let mut turned = dataset.clone();
            let shift = |b: &mut PixelBox| *b = PixelBox { x: b.x + turn, ..*b }.wrapped(900.0);
            turned.truth.iter_mut().for_each(|t| shift(&mut t.bbox));
            turned.detections.iter_mut().for_each(|d| shift(&mut d.bbox));
            prop_assert!(close(&numbers(&dataset, &config), &numbers(&turned, &config)));
        }

        #[test]
        fn perfect_detections_score_one(mut dataset in datasets()) {
            dataset.truth.iter_mut().for_each(|t| t.crowd = false);
            prop_assume!(!dataset.truth.is_empty());
            let perfect = |t: &GroundTruthBox| DetectionBox { image: t.image, category: 1, bbox: t.bbox, score: 0.5 };
            dataset.detections = dataset.truth.iter().map(perfect).collect();
            let statistics = evaluate(&dataset, &Config::default()).statistics();
            prop_assert!((statistics.ap - 1.0).abs() < 1e-12);
            prop_assert!((statistics.ar[2] - 1.0).abs() < 1e-12);
        }
    }
}
