//! How well the demo's models see drawings that they were never trained on.
//!
//! ```text
//! cargo run --release -p jrdb-pipeline --example demo_accuracy -- [--models DIR] [--seed N] [--scenes N] [--engine rten|ort]
//! ```
//!
//! Ten tiles of every scene, judged by COCO's evaluator, people who are hardly seen as its crowds; then the whole panoramas, and the
//! attributes of everybody who was found. The models were trained on seeds below 2,000.
#![allow(clippy::print_stdout, reason = "a program prints its table")]

use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::ValueEnum;
use jrdb_metrics::coco::{Area, Config, Dataset, DetectionBox, GroundTruthBox, evaluate};
use jrdb_pipeline::backbone::{Backbone, DetectorFiles, Opened};
use jrdb_pipeline::engine::{EngineChoice, EngineOptions};
use jrdb_pipeline::synth::{Practice, Seen, TILE_PX, practice};
use jrdb_types::detection::PERSON;
use jrdb_types::{Attributes, Detection, FrameId, PixelBox};
use rayon::prelude::*;

/// People of whom less is seen, or who are narrower, need not be found.
const VISIBLE_MIN: f64 = 0.3;
const WIDTH_MIN_PX: f64 = 12.0;
/// Of clear people at least this much is seen, and they are at least this tall.
const CLEAR_VISIBLE: f64 = 0.6;
const CLEAR_TALL_PX: f64 = 80.0;
/// Boxes that overlap by this IoU show the same person.
const SAME_IOU: f64 = 0.5;

fn main() -> Result<()> {
    let options = Options::parse(std::env::args().skip(1).collect())?;
    let backbone = Backbone::named("demo", &options.models)?;
    let whole = backbone.open("demo", &options.models, &options.engine)?;
    let tiles = one_tile(&backbone).open("demo", &options.models, &options.engine)?;
    whole.notes.iter().for_each(|note| println!("{note}"));
    let seeds = options.seed..options.seed + options.scenes;
    println!("drawn scenes of seeds {} to {}", seeds.start, seeds.end - 1);
    let scenes: Vec<Practice> = seeds.into_par_iter().map(practice).collect();
    let started = std::time::Instant::now();
    on_tiles(&scenes, &tiles)?;
    let per_tile = started.elapsed().as_secs_f64() * 1e3 / (10 * scenes.len()) as f64;
    println!("{per_tile:.0} ms per tile on {} threads\n", rayon::current_num_threads());
    on_panoramas(&scenes, &whole)
}

/// The same models, looking at a picture as one tile.
fn one_tile(backbone: &Backbone) -> Backbone {
    let mut backbone = backbone.clone();
    if let DetectorFiles::Florence2 { settings, .. } = &mut backbone.detector {
        (settings.tile_aspect, settings.wraps) = (0.0, false);
    }
    backbone
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

fn on_tiles(scenes: &[Practice], models: &Opened) -> Result<()> {
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
    println!(
        "{} tiles                          people    AP50    AP75  AP@[.50:.95]  recall at IoU 0.50",
        tiles.len()
    );
    table("all who count", &truth, &found, Truth::counts, None);
    table("clear people", &truth, &found, Truth::is_clear, None);
    Ok(())
}

fn on_panoramas(scenes: &[Practice], models: &Opened) -> Result<()> {
    let looks: Vec<_> = scenes
        .par_iter()
        .map(|scene| models.detector.detect(&scene.view.image, &FrameId::default()))
        .collect();
    let (mut truth, mut found, mut tally) = (Vec::new(), Vec::new(), Tally::default());
    let period_px = scenes.first().map(|scene| scene.view.image.width as f64);
    for (image, (scene, look)) in (0..).zip(scenes.iter().zip(looks)) {
        let detections = look?.detections;
        for seen in &scene.view.people {
            let visible = scene.view.visible(seen);
            let person = Truth { image, bbox: seen.bbox, visible };
            if person.counts()
                && let Some(detection) = same(&detections, seen, period_px)
                && let Some(model) = &models.attributes
            {
                tally.add(
                    &seen.attributes,
                    &model.describe(&scene.view.image, detection)?,
                    person.is_clear(),
                );
            }
            truth.push(person);
        }
        found.extend(detections.into_iter().map(|detection| (image, detection)));
    }
    println!(
        "{} panoramas                      people    AP50    AP75  AP@[.50:.95]  recall at IoU 0.50",
        scenes.len()
    );
    table("all who count", &truth, &found, Truth::counts, period_px);
    table("clear people", &truth, &found, Truth::is_clear, period_px);
    println!();
    tally.print();
    Ok(())
}

/// The detection that shows somebody best.
fn same<'d>(
    detections: &'d [Detection],
    seen: &Seen,
    period_px: Option<f64>,
) -> Option<&'d Detection> {
    let iou = |detection: &&Detection| detection.bbox.iou(&seen.bbox, period_px);
    let best = detections.iter().max_by(|a, b| iou(a).total_cmp(&iou(b)))?;
    (best.category == PERSON && iou(&best) >= SAME_IOU).then_some(best)
}

fn table(
    name: &str,
    truth: &[Truth],
    found: &[(u64, Detection)],
    counts: fn(&Truth) -> bool,
    period_px: Option<f64>,
) {
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
    let recall = evaluation
        .mean_recall(|c| c.threshold == 0 && c.area == Area::All && c.max_detections == 100);
    let people = truth.iter().filter(|person| counts(person)).count();
    let (ap, ap50, ap75) = (statistics.ap, statistics.ap50, statistics.ap75);
    println!(
        "  {name:<28} {people:>12}   {ap50:.3}   {ap75:.3}         {ap:.3}               {recall:.3}"
    );
}

/// How many attributes were right.
#[derive(Default)]
struct Tally {
    right: [[usize; 5]; 2],
    asked: [usize; 2],
}

impl Tally {
    fn add(&mut self, truth: &Attributes, found: &Attributes, is_clear: bool) {
        let right = [
            truth.gender.best() == found.gender.best(),
            truth.age.best() == found.age.best(),
            truth.race.best() == found.race.best(),
            truth.action.best() == found.action.best(),
            truth.facing.best() == found.facing.best(),
        ];
        for row in 0..=usize::from(is_clear) {
            self.asked[row] += 1;
            (0..5).for_each(|topic| self.right[row][topic] += usize::from(right[topic]));
        }
    }

    fn print(&self) {
        println!(
            "attributes of people found     people  gender     age    race  action  facing    mean"
        );
        for (name, row) in [("all", 0), ("clear people", 1)] {
            let part = |right: usize| right as f64 / self.asked[row].max(1) as f64;
            let parts = self.right[row].map(part);
            let mean = parts.iter().sum::<f64>() / 5.0;
            let shown: Vec<String> =
                parts.iter().chain([&mean]).map(|p| format!("{p:>8.3}")).collect();
            println!("  {name:<28} {:>6}{}", self.asked[row], shown.concat());
        }
    }
}

struct Options {
    models: PathBuf,
    seed: u64,
    scenes: u64,
    engine: EngineOptions,
}

impl Options {
    fn parse(arguments: Vec<String>) -> Result<Self> {
        let (models, engine) = (PathBuf::from("models"), EngineOptions::default());
        let mut options = Self { models, seed: 5_000_000, scenes: 60, engine };
        for flag in arguments.chunks(2) {
            match flag {
                [name, value] if name == "--models" => options.models = value.into(),
                [name, value] if name == "--seed" => options.seed = value.parse()?,
                [name, value] if name == "--scenes" => options.scenes = value.parse()?,
                [name, value] if name == "--engine" => {
                    options.engine.choice =
                        EngineChoice::from_str(value, true).map_err(anyhow::Error::msg)?;
                }
                other => bail!(
                    "expected --models, --seed, --scenes or --engine and a value, found {other:?}"
                ),
            }
        }
        options.engine.models.clone_from(&options.models);
        Ok(options)
    }
}
