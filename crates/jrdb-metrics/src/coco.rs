//! COCO box evaluation: average precision and recall as the reference evaluator computes them
//! (<https://cocodataset.org/#detection-eval>), on the plane or on the circle.

use std::collections::{BTreeMap, BTreeSet};

use jrdb_types::PixelBox;

mod curve;

use curve::{Judged, Verdict, curve};

/// A box that is there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GroundTruthBox {
    /// Which image it is in.
    pub image: u64,
    /// Its category.
    pub category: u64,
    /// Where, pixels.
    pub bbox: PixelBox,
    /// Area by which it is small, medium or large, square pixels; may differ from the box's.
    pub area_px2: f64,
    /// Stands for many: neither to be found nor missed, and any number of detections may lie in it.
    pub crowd: bool,
}

impl GroundTruthBox {
    /// A single thing whose area is its box's.
    #[must_use]
    pub fn new(image: u64, category: u64, bbox: PixelBox) -> Self {
        Self { image, category, bbox, area_px2: bbox.area_px2(), crowd: false }
    }
}

/// A box that is claimed to be there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DetectionBox {
    /// Which image it is in.
    pub image: u64,
    /// Its category.
    pub category: u64,
    /// Where, pixels.
    pub bbox: PixelBox,
    /// Confidence; only the order counts.
    pub score: f64,
}

/// What is evaluated. Images and categories are those that occur.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Dataset {
    /// What is there.
    pub truth: Vec<GroundTruthBox>,
    /// What is claimed. Equal scores keep their order within an image; images go by number.
    pub detections: Vec<DetectionBox>,
}

/// Which true boxes count, by area; bounds inclusive, in square pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Area {
    /// Up to 1e5² (practically all).
    All,
    /// Up to 32².
    Small,
    /// From 32² to 96².
    Medium,
    /// From 96².
    Large,
}

impl Area {
    /// Every range.
    pub const ALL: [Self; 4] = [Self::All, Self::Small, Self::Medium, Self::Large];

    /// Least and greatest area, square pixels, both inclusive.
    #[must_use]
    pub const fn bounds_px2(self) -> (f64, f64) {
        const SMALL: f64 = 32.0 * 32.0;
        const LARGE: f64 = 96.0 * 96.0;
        const END: f64 = 1e10;
        match self {
            Self::All => (0.0, END),
            Self::Small => (0.0, SMALL),
            Self::Medium => (SMALL, LARGE),
            Self::Large => (LARGE, END),
        }
    }

    fn excludes(self, area_px2: f64) -> bool {
        let (least, greatest) = self.bounds_px2();
        area_px2 < least || area_px2 > greatest
    }
}

/// How to evaluate.
#[derive(Debug, Clone, PartialEq)]
pub struct Config {
    /// Circumference of the panorama, pixels, for IoU on the circle; on the plane when absent.
    pub period_px: Option<f64>,
    /// How many detections per image and category may count: one evaluation for each limit.
    pub max_detections: Vec<usize>,
    /// Which ranges of area to evaluate.
    pub areas: Vec<Area>,
}

impl Default for Config {
    /// COCO's: on the plane, at most 1, 10 and 100 detections, all four ranges of area.
    fn default() -> Self {
        Self { period_px: None, max_detections: vec![1, 10, 100], areas: Area::ALL.to_vec() }
    }
}

/// COCO's IoU thresholds 0.50, 0.55 … 0.95, to the last bit those of the reference evaluator.
#[must_use]
pub fn iou_thresholds() -> [f64; 10] {
    let step = (0.95 - 0.5) / 9.0;
    let mut thresholds = std::array::from_fn(|i| i as f64 * step + 0.5);
    thresholds[9] = 0.95;
    thresholds
}

/// Precision and recall of one category at one IoU threshold, range of area and limit of detections.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// The category.
    pub category: u64,
    /// Index into [`iou_thresholds`].
    pub threshold: usize,
    /// The range of area.
    pub area: Area,
    /// The limit of detections per image.
    pub max_detections: usize,
    /// Interpolated precision at recall 0, 0.01 … 1.
    pub precision: Vec<f64>,
    /// Recall with all detections.
    pub recall: f64,
}

impl Curve {
    /// Mean of the interpolated precision over the 101 recall points, in `[0, 1]`.
    #[must_use]
    pub fn average_precision(&self) -> f64 {
        self.precision.iter().sum::<f64>() / self.precision.len() as f64
    }
}

/// The statistics of the reference evaluator; -1 where there is no ground truth.
#[derive(Debug, Clone, PartialEq)]
pub struct Statistics {
    /// Average precision over the ten thresholds, with the greatest limit of detections: mAP@[.50:.95].
    pub ap: f64,
    /// Average precision at IoU 0.50.
    pub ap50: f64,
    /// Average precision at IoU 0.75.
    pub ap75: f64,
    /// As `ap`, of [`Area::Small`], [`Area::Medium`] and [`Area::Large`].
    pub ap_by_area: [f64; 3],
    /// Average recall over the ten thresholds, for each limit of detections in ascending order.
    pub ar: Vec<f64>,
    /// As the last of `ar`, of [`Area::Small`], [`Area::Medium`] and [`Area::Large`].
    pub ar_by_area: [f64; 3],
}

impl Statistics {
    /// The numbers in the reference evaluator's order; twelve with three limits of detections.
    #[must_use]
    pub fn to_vec(&self) -> Vec<f64> {
        let mut all = vec![self.ap, self.ap50, self.ap75];
        all.extend(self.ap_by_area);
        all.extend(&self.ar);
        all.extend(self.ar_by_area);
        all
    }
}

/// Everything that was computed.
#[derive(Debug, Clone, PartialEq)]
pub struct Evaluation {
    /// A curve for each combination that has ground truth.
    pub curves: Vec<Curve>,
    /// The limits of detections, ascending.
    pub max_detections: Vec<usize>,
}

impl Evaluation {
    /// Mean average precision of the chosen curves; -1 if none is chosen.
    pub fn mean_ap(&self, chosen: impl Fn(&Curve) -> bool) -> f64 {
        mean(self.curves.iter().filter(|c| chosen(c)).map(Curve::average_precision))
    }

    /// Mean recall of the chosen curves; -1 if none is chosen.
    pub fn mean_recall(&self, chosen: impl Fn(&Curve) -> bool) -> f64 {
        mean(self.curves.iter().filter(|c| chosen(c)).map(|c| c.recall))
    }

    /// mAP@[.50:.95] of one category; -1 where it has no ground truth.
    #[must_use]
    pub fn category_ap(&self, category: u64) -> f64 {
        self.mean_ap(|c| {
            c.category == category && c.area == Area::All && Some(c.max_detections) == self.most()
        })
    }

    /// The reference evaluator's summary.
    #[must_use]
    pub fn statistics(&self) -> Statistics {
        const AT_75: usize = 5;
        let most = self.most();
        let whole = |c: &Curve, area| c.area == area && Some(c.max_detections) == most;
        let by_area = [Area::Small, Area::Medium, Area::Large];
        let limits = self.max_detections.iter();
        Statistics {
            ap: self.mean_ap(|c| whole(c, Area::All)),
            ap50: self.mean_ap(|c| whole(c, Area::All) && c.threshold == 0),
            ap75: self.mean_ap(|c| whole(c, Area::All) && c.threshold == AT_75),
            ap_by_area: by_area.map(|area| self.mean_ap(|c| whole(c, area))),
            ar: limits
                .map(|&n| self.mean_recall(|c| c.area == Area::All && c.max_detections == n))
                .collect(),
            ar_by_area: by_area.map(|area| self.mean_recall(|c| whole(c, area))),
        }
    }

    fn most(&self) -> Option<usize> {
        self.max_detections.last().copied()
    }
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0_usize), |(sum, count), v| (sum + v, count + 1));
    if count == 0 { -1.0 } else { sum / count as f64 }
}

/// Evaluates detections against ground truth.
///
/// Each detection, best first, takes the free true box of highest IoU (the last on ties, as the
/// reference does) if that reaches the threshold; true boxes that do not count (crowds, other areas)
/// are taken only when no other fits, and what takes them does not count either.
#[must_use]
pub fn evaluate(dataset: &Dataset, config: &Config) -> Evaluation {
    let mut max_detections = config.max_detections.clone();
    max_detections.sort_unstable();
    max_detections.dedup();
    let most = max_detections.last().copied().unwrap_or(0);
    let categories: BTreeSet<u64> = dataset.truth.iter().map(|t| t.category).collect();

    let mut curves = Vec::new();
    for &category in &categories {
        let images = pictures(dataset, category, most, config.period_px);
        for &area in &config.areas {
            for (threshold, &min_iou) in iou_thresholds().iter().enumerate() {
                let judged: Vec<Judged> = images.iter().map(|p| p.judge(area, min_iou)).collect();
                for &max_detections in &max_detections {
                    let Some((precision, recall)) = curve(&judged, max_detections) else {
                        continue;
                    };
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
    }
    Evaluation { curves, max_detections }
}

/// One image's boxes of one category.
#[derive(Default)]
struct Picture<'a> {
    truth: Vec<&'a GroundTruthBox>,
    /// Best first.
    detections: Vec<&'a DetectionBox>,
    /// By detection, then true box.
    ious: Vec<Vec<f64>>,
}

fn pictures(
    dataset: &Dataset,
    category: u64,
    most: usize,
    period_px: Option<f64>,
) -> Vec<Picture<'_>> {
    let mut images: BTreeMap<u64, Picture<'_>> = BTreeMap::new();
    for truth in dataset.truth.iter().filter(|t| t.category == category) {
        images.entry(truth.image).or_default().truth.push(truth);
    }
    for detection in dataset.detections.iter().filter(|d| d.category == category) {
        images.entry(detection.image).or_default().detections.push(detection);
    }
    for image in images.values_mut() {
        image.detections.sort_by(|a, b| curve::best_first(a.score, b.score));
        image.detections.truncate(most);
        let row =
            |d: &&DetectionBox| image.truth.iter().map(|t| overlap(d, t, period_px)).collect();
        image.ious = image.detections.iter().map(row).collect();
    }
    images.into_values().collect()
}

/// IoU; with a crowd, the part of the detection that lies in it.
fn overlap(detection: &DetectionBox, truth: &GroundTruthBox, period_px: Option<f64>) -> f64 {
    let (d, t) = (&detection.bbox, &truth.bbox);
    if !truth.crowd {
        return d.iou(t, period_px);
    }
    let shared = match period_px {
        Some(period_px) => d.circular_intersection_px2(t, period_px),
        None => d.intersection_px2(t),
    };
    if shared > 0.0 { shared / d.area_px2() } else { 0.0 }
}

impl Picture<'_> {
    fn judge(&self, area: Area, min_iou: f64) -> Judged {
        let ignored: Vec<bool> =
            self.truth.iter().map(|t| t.crowd || area.excludes(t.area_px2)).collect();
        let mut free = vec![true; self.truth.len()];
        let judge_one = |(detection, ious): (&&DetectionBox, &Vec<f64>)| {
            let best_of = |wanted_ignored: bool| {
                let fits = |&t: &usize| {
                    ignored[t] == wanted_ignored
                        && (free[t] || self.truth[t].crowd)
                        && ious[t] >= min_iou
                };
                (0..ious.len()).filter(fits).max_by(|&a, &b| ious[a].total_cmp(&ious[b]))
            };
            let verdict = if let Some(t) = best_of(false) {
                free[t] = false;
                Verdict::Right
            } else if let Some(t) = best_of(true) {
                free[t] = false;
                Verdict::Ignored
            } else if area.excludes(detection.bbox.area_px2()) {
                Verdict::Ignored
            } else {
                Verdict::Wrong
            };
            (detection.score, verdict)
        };
        let detections = self.detections.iter().zip(&self.ious).map(judge_one).collect();
        Judged { wanted: ignored.iter().filter(|ignored| !**ignored).count(), detections }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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

    proptest! {
        #[test]
        fn overlap_is_bounded_and_without_crowds_symmetric(a in boxes(), b in boxes(), crowd: bool) {
            for period_px in [None, Some(900.0)] {
                let of = |detection: PixelBox, truth: PixelBox| {
                    let detection = DetectionBox { image: 1, category: 1, bbox: detection, score: 1.0 };
                    let truth = GroundTruthBox { crowd, ..GroundTruthBox::new(1, 1, truth) };
                    overlap(&detection, &truth, period_px)
                };
                prop_assert!((0.0..=1.0 + 1e-12).contains(&of(a, b)));
                prop_assert!(crowd || (of(a, b) - of(b, a)).abs() < 1e-12);
            }
        }

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
