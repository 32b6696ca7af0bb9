//! How many labelled people a detector finds, at every threshold.

use jrdb_metrics::coco::{Config, Dataset, DetectionBox, GroundTruthBox, evaluate};
use jrdb_types::PixelBox;

/// IoU from which on a box shows a person, as in AP50.
const MIN_IOU: f64 = 0.5;

/// What a detector said of one frame, and what is labelled there.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Frame {
    /// Boxes of labelled people, pixels.
    pub truth: Vec<PixelBox>,
    /// Boxes of people with their confidence.
    pub found: Vec<(PixelBox, f64)>,
}

/// Counts at one threshold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Least confidence.
    pub min_score: f64,
    /// People found.
    pub right: usize,
    /// Boxes that show nobody, or somebody found already.
    pub wrong: usize,
}

/// How good a detector is on labelled frames.
#[derive(Debug, Clone, PartialEq)]
pub struct Quality {
    /// Labelled people.
    pub people: usize,
    /// Average precision at IoU 0.5, as COCO's evaluator computes it.
    pub ap50: f64,
    /// Thresholds from 0.1 to 0.9.
    pub rows: Vec<Row>,
}

/// Compares detections with labels; IoU is taken on the circle where a period (pixels) is given.
#[must_use]
pub fn quality(frames: &[Frame], period_px: Option<f64>) -> Quality {
    let config = Config { period_px, ..Config::default() };
    let ap50 = evaluate(&dataset(frames), &config).statistics().ap50;
    let judged: Vec<(f64, bool)> = frames.iter().flat_map(|f| judge(f, period_px)).collect();
    let row = |tenths: u32| {
        let min_score = f64::from(tenths) / 10.0;
        let sure = judged.iter().filter(|(score, _)| *score >= min_score);
        let right = sure.clone().filter(|(_, is_right)| *is_right).count();
        Row { min_score, right, wrong: sure.count() - right }
    };
    let people = frames.iter().map(|frame| frame.truth.len()).sum();
    Quality { people, ap50, rows: (1..10).map(row).collect() }
}

fn dataset(frames: &[Frame]) -> Dataset {
    let mut dataset = Dataset::default();
    for (frame, image) in frames.iter().zip(0..) {
        let category = 0;
        dataset.truth.extend(frame.truth.iter().map(|b| GroundTruthBox::new(image, category, *b)));
        let found = frame.found.iter();
        dataset.detections.extend(found.map(|&(bbox, score)| DetectionBox {
            image,
            category,
            bbox,
            score,
        }));
    }
    dataset
}

/// For each detection, most confident first, whether it shows a person not shown before.
fn judge(frame: &Frame, period_px: Option<f64>) -> Vec<(f64, bool)> {
    let mut ordered = frame.found.clone();
    ordered.sort_by(|a, b| b.1.total_cmp(&a.1));
    let mut unseen = frame.truth.clone();
    let mut shows_somebody = |bbox: &PixelBox| {
        let iou = |person: &PixelBox| bbox.iou(person, period_px);
        let best = (0..unseen.len()).max_by(|&a, &b| iou(&unseen[a]).total_cmp(&iou(&unseen[b])));
        let right = best.filter(|&at| iou(&unseen[at]) >= MIN_IOU);
        right.map(|at| unseen.remove(at)).is_some()
    };
    ordered.iter().map(|(bbox, score)| (*score, shows_somebody(bbox))).collect()
}

impl Quality {
    /// The table as text.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = format!(
            "{:>9} {:>6} {:>6} {:>7} {:>10}\n",
            "threshold", "true", "false", "recall", "precision"
        );
        for row in &self.rows {
            let recall = row.right as f64 / self.people.max(1) as f64;
            let precision = row.right as f64 / (row.right + row.wrong).max(1) as f64;
            let Row { min_score, right, wrong } = row;
            text += &format!(
                "{min_score:>9.1} {right:>6} {wrong:>6} {recall:>7.3} {precision:>10.3}\n"
            );
        }
        text + &format!("{} people, AP50 {:.3}\n", self.people, self.ap50)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_is_found_twice_is_found_once_and_wrong_once() {
        let person = PixelBox::from([95.0, 0.0, 10.0, 20.0]);
        let again = PixelBox { x: -4.0, ..person };
        let frame = Frame { truth: vec![person], found: vec![(again, 0.85), (person, 0.35)] };
        let quality = quality(&[frame], Some(100.0));
        assert!(quality.people == 1 && (quality.ap50 - 1.0).abs() < 1e-9);
        assert_eq!(quality.rows[0], Row { min_score: 0.1, right: 1, wrong: 1 });
        assert_eq!(quality.rows[7], Row { min_score: 0.8, right: 1, wrong: 0 });
        assert!(quality.text().contains("      0.8      1      0   1.000      1.000\n"));
    }
}
