//! COCO statistics of whole data sets.

use std::fs;
use std::hint::black_box;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use jrdb_metrics::coco::{Config, Dataset, DetectionBox, GroundTruthBox, evaluate};
use jrdb_types::PixelBox;
use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::{Value, row};

/// How many images the data sets have.
const IMAGES: [usize; 2] = [100, 10_000];

/// A file of ground truth, as far as it is evaluated.
#[derive(Deserialize)]
struct GroundTruth {
    annotations: Vec<Annotation>,
}

#[derive(Deserialize)]
struct Annotation {
    image_id: u64,
    category_id: u64,
    bbox: [f64; 4],
    area: f64,
    iscrowd: u8,
}

#[derive(Deserialize)]
struct Found {
    image_id: u64,
    category_id: u64,
    bbox: [f64; 4],
    score: f64,
}

/// From boxes in memory, as they stand in the files, to the twelve statistics. The table compares
/// these with the reference evaluator's.
pub(super) fn evaluations(data: &Path) -> Result<Vec<Value>> {
    IMAGES.iter().map(|images| evaluation(data, *images)).collect()
}

fn evaluation(data: &Path, images: usize) -> Result<Value> {
    let dataset = dataset(data, images)?;
    let config = Config::default();
    let statistics = || evaluate(&dataset, &config).statistics().to_vec();
    let first = statistics();
    ensure!(first.iter().all(|share| (0.0..=1.0).contains(share)), "found {first:?}");
    let mut row = row(&format!("images={images}"), || drop(black_box(statistics())));
    row["statistics"] = first.into();
    Ok(row)
}

fn dataset(data: &Path, images: usize) -> Result<Dataset> {
    let truth: GroundTruth = read(&data.join(format!("gt_{images}.json")))?;
    let found: Vec<Found> = read(&data.join(format!("dt_{images}.json")))?;
    let truth = truth.annotations.into_iter().map(|a| GroundTruthBox {
        image: a.image_id,
        category: a.category_id,
        bbox: PixelBox::from(a.bbox),
        area_px2: a.area,
        crowd: a.iscrowd == 1,
    });
    let detections = found.into_iter().map(|d| DetectionBox {
        image: d.image_id,
        category: d.category_id,
        bbox: PixelBox::from(d.bbox),
        score: d.score,
    });
    Ok(Dataset { truth: truth.collect(), detections: detections.collect() })
}

fn read<T: DeserializeOwned>(path: &Path) -> Result<T> {
    let bytes = fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    serde_json::from_slice(&bytes).with_context(|| format!("{} is not COCO", path.display()))
}
