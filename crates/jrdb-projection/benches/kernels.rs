//! How fast points are placed and things related: `cargo bench -p jrdb-projection`.
#![allow(missing_docs, reason = "criterion's macros write functions without")]
#![allow(clippy::unwrap_used, reason = "a failing benchmark should panic")]

mod inputs;

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use jrdb_projection::box_view::BoxView;
use jrdb_projection::localize::densest_range::{Target, densest_range};
use jrdb_projection::nalgebra::Point3;
use jrdb_projection::relation::{adjacency, overlap, pairwise::pairwise};
use jrdb_projection::select::points_in_boxes;
use jrdb_projection::{BaseCloud, CameraModel, ProjectionConfig, Scan, Sensors, localize, project};
use jrdb_types::LateralConvention;

/// Points of each of the two sweeps of a frame.
const POINTS_PER_SWEEP: usize = 65_536;

/// People in a busy real frame.
const PEOPLE: usize = 20;

fn placing(criterion: &mut Criterion) {
    let (rig, config) = (inputs::rig(), ProjectionConfig::default());
    let sensors = Sensors::new(&rig, None).unwrap();
    let clouds = [inputs::cloud(POINTS_PER_SWEEP)];
    let cloud = BaseCloud::merge(&clouds, &sensors, &mut Vec::new());
    let image = sensors.camera.image();
    let mut group = criterion.benchmark_group("131072 points");
    group.bench_function("merge", |b| {
        b.iter(|| BaseCloud::merge(&clouds, &sensors, &mut Vec::new()));
    });
    group.bench_function("refill", |b| {
        let mut again = cloud.clone();
        b.iter(|| again.refill(&clouds, &sensors, &mut Vec::new()));
    });
    for count in [10, 50, 100] {
        let boxes = inputs::boxes(count);
        group.bench_function(BenchmarkId::new("points_in_boxes", count), |b| {
            b.iter(|| points_in_boxes(&cloud, &boxes, image));
        });
    }
    let boxes = inputs::boxes(PEOPLE);
    let inside = points_in_boxes(&cloud, &boxes, image);
    group.bench_function(BenchmarkId::new("mean", PEOPLE), |b| {
        b.iter(|| {
            inside.iter().for_each(|inside| drop(black_box(localize::mean(&cloud, inside))));
        });
    });
    group.bench_function(BenchmarkId::new("densest_range", PEOPLE), |b| {
        b.iter(|| {
            for (bbox, inside) in boxes.iter().zip(&inside) {
                let view = BoxView::new(bbox, &sensors.camera);
                let target = Target { bbox, image, view, is_person: true };
                black_box(densest_range(&cloud, inside, &target, &config));
            }
        });
    });
    let detections = inputs::detections(PEOPLE);
    group.bench_function(BenchmarkId::new("project", PEOPLE), |b| {
        b.iter(|| project(&detections, &Scan::new(&clouds, &rig), &config).unwrap());
    });
    group.finish();
}

fn relating(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("all pairs");
    for count in [50, 100, 500] {
        let boxes = inputs::boxes3d(count);
        let centers: Vec<Point3<f64>> = boxes.iter().map(|b| b.center.into()).collect();
        let headings: Vec<f64> = boxes.iter().map(|b| b.heading_rad).collect();
        group.bench_function(BenchmarkId::new("pairwise", count), |b| {
            b.iter(|| pairwise(&centers, &headings, LateralConvention::default()));
        });
        group.bench_function(BenchmarkId::new("overlap", count), |b| {
            b.iter(|| inputs::over_pairs(&boxes, overlap::iou));
        });
        group.bench_function(BenchmarkId::new("gap", count), |b| {
            b.iter(|| inputs::over_pairs(&boxes, adjacency::gap_m));
        });
    }
    group.finish();
}

criterion_group!(benches, placing, relating);
criterion_main!(benches);
