//! Runs every kernel once, for `cargo xtask budget` to count its instructions.
//!
//! Prints the widest vector registers that the kernels find, then the kernels' names in the order in which
//! [`measured`] runs them. It lives in this crate because no cheaper one to build can see all of the kernels.
#![allow(clippy::print_stdout, reason = "its result is what it prints")]
#![allow(clippy::unwrap_used, reason = "a failing kernel should panic")]

#[path = "../../jrdb-projection/benches/inputs/mod.rs"]
mod inputs;

use std::fmt::Write;
use std::hint::black_box;

use jrdb_calibration::{FloorConfig, fit_floor};
use jrdb_dataset::pcd::{self, Encoding};
use jrdb_graph::{GraphConfig, GraphIndex, build};
use jrdb_parser::parse;
use jrdb_projection::box_view::BoxView;
use jrdb_projection::localize::densest_range::{Target, densest_range};
use jrdb_projection::nalgebra::Point3;
use jrdb_projection::relation::{adjacency, overlap, pairwise::pairwise, wrap_rad};
use jrdb_projection::select::points_in_boxes;
use jrdb_projection::{BaseCloud, ProjectionConfig, Scan, Sensors, project};
use jrdb_search::{SearchConfig, search};
use jrdb_types::vocab::Color;
use jrdb_types::{
    Action, Age, AttributeValue, Attributes, Box3d, Entities, Gender, LateralConvention, Localizer,
    PointCloud, Query, Race,
};

/// Points of each of the two sweeps: half a real frame, as valgrind is slow.
const POINTS_PER_SWEEP: usize = 16_384;
/// People with image boxes, as in a busy real frame.
const PEOPLE: usize = 20;
/// People in space, for the relations of all pairs.
const CROWD: usize = 50;

/// A name, and work that says how much it did.
type Kernel = (&'static str, Box<dyn FnMut() -> usize>);

fn main() {
    println!("{}", registers());
    let cloud = inputs::cloud(POINTS_PER_SWEEP);
    let kernels = projection(&cloud).into_iter().chain(relations()).chain(files(&cloud));
    for (name, mut kernel) in kernels.chain(questions()).chain([floor(&cloud)]) {
        // The first run binds symbols and looks for the machine's instructions.
        let expected = kernel();
        assert!(
            expected > 0 && measured(&mut *kernel) == expected,
            "{name} does not repeat itself"
        );
        println!("{name}");
    }
}

/// What `xtask` counts the instructions of, by this name.
#[inline(never)]
fn measured(kernel: &mut dyn FnMut() -> usize) -> usize {
    black_box(kernel())
}

#[cfg(target_arch = "x86_64")]
fn registers() -> &'static str {
    let has_avx2 = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
    match (is_x86_feature_detected!("avx512f"), has_avx2) {
        (true, _) => "x86-64, AVX-512",
        (false, true) => "x86-64, AVX2",
        (false, false) => "x86-64, SSE",
    }
}

#[cfg(not(target_arch = "x86_64"))]
fn registers() -> &'static str {
    std::env::consts::ARCH
}

fn projection(cloud: &PointCloud) -> Vec<Kernel> {
    let (rig, config) = (inputs::rig(), ProjectionConfig::default());
    let sensors = || Sensors::new(&inputs::rig(), None).unwrap();
    let merge = |clouds: &[PointCloud], sensors: &Sensors| {
        BaseCloud::merge(clouds, sensors, &mut Vec::new())
    };
    let clouds = [cloud.clone()];
    let merged = merge(&clouds, &sensors());
    let (detections, boxes) = (inputs::detections(PEOPLE), inputs::boxes(PEOPLE));
    let image = detections.image;
    let inside = points_in_boxes(&merged, &boxes, image);
    let (selecting, locating) = (merged.clone(), merged);
    let (sensors, scanned, targets) = (sensors(), clouds.clone(), boxes.clone());
    let views: Vec<_> = boxes.iter().map(|bbox| BoxView::new(bbox, &sensors.camera)).collect();
    vec![
        ("merge", Box::new(move || black_box(merge(&clouds, &sensors)).len())),
        (
            "points_in_boxes",
            Box::new(move || points_in_boxes(&selecting, &boxes, image).iter().map(Vec::len).sum()),
        ),
        (
            "densest_range",
            Box::new(move || {
                let all = targets.iter().zip(&views).zip(&inside);
                let located = all.filter_map(|((bbox, &view), inside)| {
                    let target = Target { bbox, image, view, is_person: true };
                    densest_range(&locating, inside, &target, &config)
                });
                located.map(|located| located.used.len()).sum()
            }),
        ),
        (
            "project",
            Box::new(move || {
                let scan = Scan::new(&scanned, &rig);
                project(&detections, &scan, &config).unwrap().relations.len()
            }),
        ),
    ]
}

fn relations() -> Vec<Kernel> {
    let boxes = inputs::boxes3d(CROWD);
    let centers: Vec<Point3<f64>> = boxes.iter().map(|b| b.center.into()).collect();
    let headings: Vec<f64> = boxes.iter().map(|b| b.heading_rad).collect();
    let lateral = LateralConvention::default();
    let of_pairs = |of_pair: fn(&Box3d, &Box3d) -> f64| {
        let boxes = boxes.clone();
        Box::new(move || (inputs::over_pairs(&boxes, of_pair) * 1e6) as usize)
    };
    let close = move || {
        let pairs = black_box(pairwise(&centers, &headings, lateral));
        (1..CROWD).filter(|&other| pairs.distance_m(0, other) < 5.0).count()
    };
    vec![
        ("pairwise", Box::new(close)),
        ("overlap", of_pairs(overlap::iou)),
        ("gap", of_pairs(adjacency::gap_m)),
    ]
}

fn files(cloud: &PointCloud) -> Vec<Kernel> {
    let parse = |bytes: Vec<u8>| Box::new(move || pcd::parse(&bytes, "lidar").unwrap().len());
    vec![
        ("parse_pcd_binary", parse(pcd::write(cloud, Encoding::Binary))),
        ("parse_pcd_compressed", parse(pcd::write(cloud, Encoding::BinaryCompressed))),
        ("parse_pcd_ascii", parse(ascii(cloud))),
    ]
}

/// What is asked of a crowd: attributes, places, relations, an order and a number.
const QUESTIONS: [&str; 5] = [
    "Find young, White and male persons who are far from you on your left",
    "Who is the woman standing to the left of a child, close to me?",
    "How many people in black are next to somebody who is sitting?",
    "the second oldest person from the left who is not walking",
    "What is the man in front of the elderly woman doing?",
];

fn questions() -> Vec<Kernel> {
    let entities = crowd();
    let scene = build(&entities, &GraphConfig::default());
    let indexed = scene.clone();
    let queries: Vec<Query> = QUESTIONS.iter().map(|text| parse(text)).collect();
    let read = || QUESTIONS.iter().map(|text| parse(text).target.conditions.len()).sum();
    vec![
        ("build_graph", Box::new(move || build(&entities, &GraphConfig::default()).edges.len())),
        ("index_graph", Box::new(move || GraphIndex::new(&indexed).size())),
        ("parse", Box::new(read)),
        (
            "search",
            Box::new(move || {
                let answer = |query| search(&scene, query, &SearchConfig::default());
                queries.iter().map(|query| answer(query).ranking.len()).sum()
            }),
        ),
    ]
}

/// People in space of whom everything is known, and how they lie to each other.
fn crowd() -> Entities {
    let mut detections = inputs::detections(CROWD);
    for (number, (detection, box3d)) in
        detections.detections.iter_mut().zip(inputs::boxes3d(CROWD)).enumerate()
    {
        detection.heading_rad = Some(wrap_rad(box3d.heading_rad));
        detection.box3d = Some(box3d);
        detection.attributes = Attributes::certain([
            Age::ALL[number % Age::ALL.len()].into(),
            Gender::ALL[number % Gender::ALL.len()].into(),
            Race::ALL[number / 2 % Race::ALL.len()].into(),
            Action::ALL[number / 3 % Action::ALL.len()].into(),
            AttributeValue::upper_color(Color::ALL[number / 4 % Color::ALL.len()]),
        ]);
    }
    let config = ProjectionConfig { localizer: Localizer::Given, ..ProjectionConfig::default() };
    let rig = inputs::rig();
    project(&detections, &Scan::new(&[], &rig), &config).unwrap()
}

/// ASCII with six decimals, as most programs write it.
fn ascii(cloud: &PointCloud) -> Vec<u8> {
    let count = cloud.len();
    let mut text = format!(
        "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n\
         WIDTH {count}\nHEIGHT 1\nPOINTS {count}\nDATA ascii\n"
    );
    for ((x, y), z) in cloud.x.iter().zip(&cloud.y).zip(&cloud.z) {
        writeln!(text, "{x:.6} {y:.6} {z:.6}").unwrap();
    }
    text.into_bytes()
}

fn floor(cloud: &PointCloud) -> Kernel {
    let columns = cloud.x.iter().zip(&cloud.y).zip(&cloud.z);
    let points: Vec<_> = columns.map(|((&x, &y), &z)| Point3::new(x, y, z).cast()).collect();
    ("fit_floor", Box::new(move || fit_floor(&points, &FloorConfig::default()).unwrap().inliers))
}
