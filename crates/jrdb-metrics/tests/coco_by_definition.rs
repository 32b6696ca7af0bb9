//! COCO's numbers against a slow evaluation that follows the definition word for word: every area
//! range, threshold and limit by itself.
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]

use jrdb_metrics::coco::{
    Area, Config, Curve, Dataset, DetectionBox, GroundTruthBox, evaluate, iou_thresholds,
};
use jrdb_types::PixelBox;
use proptest::prelude::*;

/// Images and categories have the numbers below these.
const IMAGES: u64 = 3;
const CATEGORIES: u64 = 2;
const PERIOD_PX: f64 = 300.0;

/// Boxes on a coarse grid, so that many overlaps are equal.
fn boxes() -> impl Strategy<Value = PixelBox> {
    (0..9_u8, 0..2_u8, 2..5_u8, 2..5_u8)
        .prop_map(|(x, y, w, h)| PixelBox::from([x, y, w, h].map(|cells| f64::from(cells) * 30.0)))
}

fn datasets() -> impl Strategy<Value = Dataset> {
    let place = || (0..IMAGES, 0..CATEGORIES, boxes());
    let areas = prop::option::of(prop::sample::select(vec![10.0, 1024.0, 5000.0, 9216.0, 1e6]));
    let truth = (place(), areas, prop::bool::weighted(0.15)).prop_map(|(at, area_px2, crowd)| {
        let truth = GroundTruthBox::new(at.0, at.1, at.2);
        GroundTruthBox { area_px2: area_px2.unwrap_or(truth.area_px2), crowd, ..truth }
    });
    // Few scores, so that many are equal.
    let found = (place(), 0..4_u8).prop_map(|((image, category, bbox), score)| DetectionBox {
        image,
        category,
        bbox,
        score: f64::from(score),
    });
    let (truth, found) = (prop::collection::vec(truth, 0..60), prop::collection::vec(found, 0..60));
    (truth, found).prop_map(|(truth, detections)| Dataset { truth, detections })
}

fn configs() -> impl Strategy<Value = Config> {
    let areas = prop::sample::subsequence(Area::ALL.to_vec(), 1..=4);
    let limits = prop::collection::vec(1..8_usize, 1..4);
    (areas, limits, any::<bool>()).prop_map(|(areas, max_detections, circular)| Config {
        period_px: circular.then_some(PERIOD_PX),
        max_detections,
        areas,
    })
}

fn overlap(d: &PixelBox, truth: &GroundTruthBox, period_px: Option<f64>) -> f64 {
    if !truth.crowd {
        return d.iou(&truth.bbox, period_px);
    }
    let shared = match period_px {
        Some(period_px) => d.circular_intersection_px2(&truth.bbox, period_px),
        None => d.intersection_px2(&truth.bbox),
    };
    shared / d.area_px2()
}

/// The scores of an image's best detections with what became of each (`None` is ignored), and how
/// many true boxes were to be found.
fn judge(
    dataset: &Dataset,
    (image, wanted): (u64, &Curve),
    period_px: Option<f64>,
) -> (Vec<(f64, Option<bool>)>, usize) {
    let (least, greatest) = wanted.area.bounds_px2();
    let outside = |area_px2: f64| area_px2 < least || area_px2 > greatest;
    let mut truth: Vec<_> = dataset
        .truth
        .iter()
        .filter(|t| (t.image, t.category) == (image, wanted.category))
        .map(|t| (t, t.crowd || outside(t.area_px2), false))
        .collect();
    let mut found: Vec<_> = dataset
        .detections
        .iter()
        .filter(|d| (d.image, d.category) == (image, wanted.category))
        .collect();
    found.sort_by(|a, b| b.score.total_cmp(&a.score));
    found.truncate(wanted.max_detections);
    let judged = found.iter().map(|d| {
        let reaches = |t: &GroundTruthBox| {
            Some(overlap(&d.bbox, t, period_px))
                .filter(|iou| *iou >= iou_thresholds()[wanted.threshold])
        };
        let free = truth.iter_mut().filter(|(t, _, taken)| t.crowd || !taken);
        let fitting = free.filter_map(|one| Some((reaches(one.0)?, one)));
        let best = fitting.max_by(|(a, one), (b, other)| {
            // What counts is better than what does not; then the greater overlap, then the last.
            other.1.cmp(&one.1).then(a.total_cmp(b))
        });
        let is_right = match best {
            Some((_, (_, ignored, taken))) => {
                *taken = true;
                (!*ignored).then_some(true)
            }
            None => (!outside(d.bbox.area_px2())).then_some(false),
        };
        (d.score, is_right)
    });
    let judged = judged.collect();
    (judged, truth.iter().filter(|(_, ignored, _)| !ignored).count())
}

/// The interpolated precision of a curve, and its recall; none where nothing is to be found.
fn by_definition(
    dataset: &Dataset,
    wanted: &Curve,
    period_px: Option<f64>,
) -> Option<(Vec<f64>, f64)> {
    let images = (0..IMAGES).map(|image| judge(dataset, (image, wanted), period_px));
    let (judged, positives): (Vec<_>, Vec<_>) = images.unzip();
    let positives: usize = positives.into_iter().sum();
    let mut judged = judged.concat();
    judged.sort_by(|a, b| b.0.total_cmp(&a.0));
    let count = |end: usize, right| judged[..=end].iter().filter(|j| j.1 == Some(right)).count();
    let points = (0..judged.len()).map(|i| {
        let (right, wrong) = (count(i, true) as f64, count(i, false) as f64);
        (right / positives as f64, if right == 0.0 { 0.0 } else { right / (right + wrong) })
    });
    let points: Vec<(f64, f64)> = points.collect();
    let at = |point: u8| {
        let reached = points.iter().filter(|(recall, _)| *recall >= f64::from(point) * 0.01);
        reached.map(|(_, precision)| *precision).fold(0.0, f64::max)
    };
    let recall = points.last().map_or(0.0, |(recall, _)| *recall);
    (positives > 0).then(|| ((0..=100).map(at).collect(), recall))
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_curve_is_what_the_definition_says(dataset in datasets(), config in configs()) {
        let found = evaluate(&dataset, &config);
        let mut curves = found.curves.iter();
        for category in 0..CATEGORIES {
            for &area in &config.areas {
                for threshold in 0..iou_thresholds().len() {
                    for &max_detections in &found.max_detections {
                        let (precision, recall) = (Vec::new(), 0.0);
                        let wanted =
                            Curve { category, threshold, area, max_detections, precision, recall };
                        let expected = by_definition(&dataset, &wanted, config.period_px);
                        let Some((precision, recall)) = expected else { continue };
                        let curve = curves.next().unwrap();
                        let key = |c: &Curve| (c.category, c.area, c.threshold, c.max_detections);
                        prop_assert_eq!(key(curve), key(&wanted));
                        prop_assert!((curve.recall - recall).abs() < 1e-12);
                        let mut pairs = curve.precision.iter().zip(&precision);
                        prop_assert!(pairs.all(|(a, b)| (a - b).abs() < 1e-12));
                    }
                }
            }
        }
        prop_assert!(curves.next().is_none());
    }
}
