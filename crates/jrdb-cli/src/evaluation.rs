//! How well models see drawn scenes, whose truth is known.

use std::fmt::Write as _;

use jrdb_metrics::coco::{Area, Config, Dataset, DetectionBox, GroundTruthBox, evaluate};
use jrdb_perception::Models;
use jrdb_types::detection::PERSON;
use jrdb_types::{Attributes, Detection, FrameId, PixelBox};
use rayon::prelude::*;

use crate::Error;
use jrdb_synth::{Practice, Seen, TILE_PX};

/// People of whom less is seen, or who are narrower, need not be found.
const VISIBLE_MIN: f64 = 0.3;
const WIDTH_MIN_PX: f64 = 12.0;
/// Of clear people at least this much is seen, and they are at least this tall.
const CLEAR_VISIBLE: f64 = 0.6;
const CLEAR_TALL_PX: f64 = 80.0;
/// Boxes that overlap by this IoU show the same person.
const SAME_IOU: f64 = 0.5;

/// Results on all people who count, and on the clear ones among them.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Both<T> {
    /// At least 30 % of them is seen, and they are at least 12 pixels wide.
    pub all: T,
    /// At least 60 % of them is seen, and they are at least 80 pixels tall.
    pub clear: T,
}

/// How people were found. People who do not count are COCO's crowds.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Finding {
    /// How many there are.
    pub people: usize,
    /// Average precision at IoU 0.50.
    pub ap50: f64,
    /// Average precision at IoU 0.75.
    pub ap75: f64,
    /// Mean average precision over the thresholds 0.50 to 0.95.
    pub ap: f64,
    /// Recall at IoU 0.50.
    pub recall: f64,
}

/// How people who were found were described.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Describing {
    /// How many were found.
    pub people: usize,
    /// Of how many gender, age, race, action and facing were right.
    pub right: [usize; 5],
}

impl Describing {
    /// The parts that were right, in `[0, 1]`.
    #[must_use]
    pub fn parts(&self) -> [f64; 5] {
        self.right.map(|right| right as f64 / self.people.max(1) as f64)
    }

    /// Their mean.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.parts().iter().sum::<f64>() / 5.0
    }

    fn add(&mut self, right: [bool; 5]) {
        self.people += 1;
        self.right.iter_mut().zip(right).for_each(|(sum, is_right)| *sum += usize::from(is_right));
    }
}

/// A person in a picture, and how well they are seen.
struct Truth {
    image: u64,
    bbox: PixelBox,
    visible: f64,
}

impl Truth {
    fn counts(&self) -> bool {
        self.visible >= VISIBLE_MIN && self.bbox.w >= WIDTH_MIN_PX
    }

    fn is_clear(&self) -> bool {
        self.counts() && self.visible >= CLEAR_VISIBLE && self.bbox.h >= CLEAR_TALL_PX
    }
}

/// Looks at ten tiles of every scene, each as a picture of its own. The models should take a picture as one tile.
///
/// # Errors
/// When a model fails.
pub fn on_tiles(scenes: &[Practice], models: &Models) -> Result<Both<Finding>, Error> {
    let cut = |scene: &Practice| {
        let mut scene = scene.clone();
        let starts = scene.tiles();
        let people = |x_px| {
            let shown = scene.view.in_tile(x_px, TILE_PX);
            shown.into_iter().map(|one| (one.bbox, one.visible)).collect::<Vec<_>>()
        };
        starts.into_iter().map(|x_px| (people(x_px), scene.tile(x_px))).collect::<Vec<_>>()
    };
    let tiles: Vec<_> = scenes.par_iter().flat_map_iter(cut).collect();
    let looks: Vec<_> = tiles
        .par_iter()
        .map(|(_, picture)| models.detector.detect(picture, &FrameId::default()))
        .collect();
    let (mut truth, mut found) = (Vec::new(), Vec::new());
    for (image, ((people, _), look)) in (0..).zip(tiles.iter().zip(looks)) {
        let one =
            |(bbox, visible): &(PixelBox, f64)| Truth { image, bbox: *bbox, visible: *visible };
        truth.extend(people.iter().map(one));
        found.extend(look?.detections.into_iter().map(|detection| (image, detection)));
    }
    Ok(judge(&truth, &found, None))
}

/// Looks at the whole panoramas, and describes everybody who was found.
///
/// # Errors
/// When a model fails.
pub fn on_panoramas(
    scenes: &[Practice],
    models: &Models,
) -> Result<(Both<Finding>, Both<Describing>), Error> {
    let looks: Vec<_> = scenes
        .par_iter()
        .map(|scene| models.detector.detect(&scene.view.image, &FrameId::default()))
        .collect();
    let (mut truth, mut found) = (Vec::new(), Vec::new());
    let mut described: Both<Describing> = Both::default();
    let period_px = scenes.first().map(|scene| scene.view.image.width as f64);
    for (image, (scene, look)) in (0..).zip(scenes.iter().zip(looks)) {
        let detections = look?.detections;
        for seen in &scene.view.people {
            let person = Truth { image, bbox: seen.bbox, visible: scene.view.visible(seen) };
            if person.counts()
                && let Some(detection) = same(&detections, seen, period_px)
                && let Some(model) = &models.attributes
            {
                let told = model.describe(&scene.view.image, detection)?;
                let right = right(&seen.attributes, &told);
                described.all.add(right);
                if person.is_clear() {
                    described.clear.add(right);
                }
            }
            truth.push(person);
        }
        found.extend(detections.into_iter().map(|detection| (image, detection)));
    }
    Ok((judge(&truth, &found, period_px), described))
}

/// Whether somebody is seen well enough to count.
pub(crate) fn counts(scene: &Practice, seen: &Seen) -> bool {
    Truth { image: 0, bbox: seen.bbox, visible: scene.view.visible(seen) }.counts()
}

/// The detection that shows somebody best.
pub(crate) fn same<'d>(
    detections: &'d [Detection],
    seen: &Seen,
    period_px: Option<f64>,
) -> Option<&'d Detection> {
    let iou = |detection: &&Detection| detection.bbox.iou(&seen.bbox, period_px);
    let best = detections.iter().max_by(|a, b| iou(a).total_cmp(&iou(b)))?;
    (best.category == PERSON && iou(&best) >= SAME_IOU).then_some(best)
}

fn right(truth: &Attributes, told: &Attributes) -> [bool; 5] {
    [
        truth.gender().best() == told.gender().best(),
        truth.age().best() == told.age().best(),
        truth.race().best() == told.race().best(),
        truth.action().best() == told.action().best(),
        truth.facing.best() == told.facing.best(),
    ]
}

fn judge(truth: &[Truth], found: &[(u64, Detection)], period_px: Option<f64>) -> Both<Finding> {
    let of = |counts: fn(&Truth) -> bool| finding(truth, found, counts, period_px);
    Both { all: of(Truth::counts), clear: of(Truth::is_clear) }
}

fn finding(
    truth: &[Truth],
    found: &[(u64, Detection)],
    counts: fn(&Truth) -> bool,
    period_px: Option<f64>,
) -> Finding {
    let there = |person: &Truth| GroundTruthBox {
        crowd: !counts(person),
        ..GroundTruthBox::new(person.image, 1, person.bbox)
    };
    let claimed = |(image, detection): &(u64, Detection)| DetectionBox {
        image: *image,
        category: 1,
        bbox: detection.bbox,
        score: detection.score,
    };
    let dataset = Dataset {
        truth: truth.iter().map(there).collect(),
        detections: found.iter().filter(|one| one.1.category == PERSON).map(claimed).collect(),
    };
    let evaluation = evaluate(&dataset, &Config { period_px, ..Config::default() });
    let statistics = evaluation.statistics();
    let most = evaluation.max_detections.last().copied();
    let recall = evaluation.mean_recall(|curve| {
        curve.threshold == 0 && curve.area == Area::All && Some(curve.max_detections) == most
    });
    Finding {
        people: truth.iter().filter(|person| counts(person)).count(),
        ap50: statistics.ap50,
        ap75: statistics.ap75,
        ap: statistics.ap,
        recall,
    }
}

/// A table of how people were found.
#[must_use]
pub fn found_table(title: &str, found: &Both<Finding>) -> String {
    let head = ["people", "AP50", "AP75", "AP", "recall"].map(|name| format!("{name:>8}"));
    let mut text = format!("{title:<30}{}\n", head.concat());
    for (name, of) in [("all who count", found.all), ("clear people", found.clear)] {
        let numbers = [of.ap50, of.ap75, of.ap, of.recall].map(|number| format!("{number:>8.3}"));
        let _ = writeln!(text, "  {name:<28}{:>8}{}", of.people, numbers.concat());
    }
    text
}

/// A table of how people were described.
#[must_use]
pub fn described_table(described: &Both<Describing>) -> String {
    let names = ["people", "gender", "age", "race", "action", "facing", "mean"];
    let head = names.map(|name| format!("{name:>8}"));
    let mut text = format!("{:<30}{}\n", "attributes of people found", head.concat());
    for (name, of) in [("all who count", described.all), ("clear people", described.clear)] {
        let parts = of.parts().map(|part| format!("{part:>8.3}"));
        let _ = writeln!(text, "  {name:<28}{:>8}{}{:>8.3}", of.people, parts.concat(), of.mean());
    }
    text
}
