//! Projection, localisation and geometry words against reference tables and one real JRDB frame.
#![allow(clippy::panic, clippy::unwrap_used, reason = "a failing helper should panic")]
#![allow(clippy::print_stdout, reason = "figures and skipped tests are said aloud")]

mod shared;

use std::collections::BTreeMap;

use jrdb_dataset::Dataset;
use jrdb_projection::box_view::BoxView;
use jrdb_projection::heading::body_shape::shoulder_line;
use jrdb_projection::localize::densest_range::{Target, densest_range};
use jrdb_projection::nalgebra::{Point3, Vector3};
use jrdb_projection::relation::{direction, distance, from_person, from_robot};
use jrdb_projection::select::points_in_boxes;
use jrdb_projection::{BaseCloud, CameraModel, ProjectionConfig, Scan, Sensors, project};
use jrdb_types::{
    Detection, Detections, Entity, EntityId, FrameId, LateralConvention, Localizer, PixelBox,
    SpatialRelation,
};
use shared::{shared, table};

const SEQUENCE: &str = "bytes-cafe-2019-02-07_0";

type Row = BTreeMap<String, String>;

fn number(row: &Row, column: &str) -> f64 {
    row[column].parse().unwrap()
}

fn numbers<const N: usize>(row: &Row, columns: [&str; N]) -> [f64; N] {
    columns.map(|column| number(row, column))
}

#[test]
fn conformance_projection_reference() {
    let (Some(rows), Some(root)) =
        (table("data/projection_reference.csv"), shared("data/jrdb-sample"))
    else {
        return;
    };
    let sensors = Sensors::new(&Dataset::open(&root).unwrap().rig().unwrap(), None).unwrap();
    let (mut compared, mut worst_px) = (0, 0.0_f64);
    for row in &rows {
        let point = Point3::from(numbers(row, ["x", "y", "z"]));
        let base = match row["input_frame"].as_str() {
            "base" => point,
            lidar => sensors.lidars[lidar] * point,
        };
        let [u, v] = numbers(row, ["u", "v"]);
        let pixel = sensors.camera.pixel_from_base(&base);
        if u.is_finite() && v.is_finite() {
            let pixel = pixel.unwrap();
            let du = (pixel.u - u).abs();
            worst_px = worst_px.max(du.min(3760.0 - du)).max((pixel.v - v).abs());
            compared += 1;
        } else {
            // The reference divides zero by zero here; the pixel exists all the same.
            assert!(pixel.is_none_or(|p| p.u.is_finite() && p.v.is_finite()), "{row:?}");
        }
    }
    println!("{compared} of {} rows are finite; worst {worst_px:.2e} px", rows.len());
    assert!(compared > 0 && worst_px < 1e-3, "{worst_px} px");
}

fn word(relation: &SpatialRelation) -> String {
    benchmark_word(relation.direction.unwrap())
}

/// The engine writes "right left" for a front right that is up or down.
fn benchmark_word(direction: jrdb_types::Direction) -> String {
    let word = direction.to_string();
    let is_level = direction.elevation == jrdb_types::vocab::Elevation::Level;
    if is_level { word } else { word.replace("front right", "right left") }
}

#[test]
fn conformance_geometry_words() {
    let Some(rows) = table("goldens/jrdb_reasoning/geometry_table.csv") else { return };
    let engine = LateralConvention::BenchmarkMirrored;
    let mut compared: BTreeMap<String, usize> = BTreeMap::new();
    for row in &rows {
        let kind = row["kind"].as_str();
        let margins = ["angle_margin_deg", "distance_margin_m"].map(|c| row[c].parse::<f64>().ok());
        if matches!(kind, "robot" | "hhg") && margins.iter().flatten().any(|margin| *margin < 1e-9)
        {
            continue;
        }
        let b = ["b_cx", "b_cy", "b_cz"].map(|c| row[c].parse::<f64>());
        let point = || Point3::from(b.clone().map(Result::unwrap));
        let (direction_word, distance_word) = match kind {
            "robot" => {
                let relation = from_robot(&point(), engine);
                (Some(word(&relation)), relation.distance)
            }
            "hhg" => {
                let a = Point3::from(numbers(row, ["a_cx", "a_cy", "a_cz"]));
                let heading = std::f64::consts::PI - number(row, "a_rot_z");
                let relation = from_person(&a, Some(heading), &point(), engine);
                (Some(word(&relation)), relation.distance)
            }
            "direction" => {
                let vector = Vector3::from(b.clone().map(Result::unwrap));
                (Some(benchmark_word(direction::of_vector(&vector, engine))), None)
            }
            "distance" => (None, row["distance_m"].parse().ok().and_then(distance::word)),
            other => panic!("unknown kind {other}"),
        };
        let expect = |column: &str| Some(row[column].clone()).filter(|text| !text.is_empty());
        if let (Some(found), Some(expected)) = (direction_word, expect("direction_label")) {
            assert_eq!(found, expected, "{row:?}");
        }
        if let (Some(found), Some(expected)) = (distance_word, expect("distance_label")) {
            assert_eq!(found.word(), expected, "{row:?}");
        }
        *compared.entry(kind.into()).or_default() += 1;
    }
    println!("geometry words equal in {compared:?} of {} rows", rows.len());
    assert!(compared.values().sum::<usize>() > 0);
}

/// A row of the label table: track, centre and heading from the 3D label, box from the 2D label.
struct Labelled {
    id: EntityId,
    center: [f64; 2],
    heading_rad: f64,
    bbox: PixelBox,
}

/// Frame 0 of the table `frame, track, cx, cy, h, w, l, rot_z, x, y, w, h`.
fn frame_zero() -> Option<Vec<Labelled>> {
    let path = shared(&format!("data/jrdb-sample/labels/{SEQUENCE}.track_3dbb_2dbb.csv"))?;
    let text = std::fs::read_to_string(path).unwrap();
    let rows =
        text.lines().map(|line| line.split(',').map(|f| f.parse().unwrap()).collect::<Vec<f64>>());
    let labelled = rows.filter(|row| row[0] == 0.0).map(|row| Labelled {
        id: EntityId::new("pedestrian", row[1] as u32),
        center: [row[2], row[3]],
        heading_rad: std::f64::consts::PI - row[7],
        bbox: PixelBox::from([row[8], row[9], row[10], row[11]]),
    });
    Some(labelled.collect())
}

fn detections(people: &[Labelled], image: jrdb_types::ImageGeometry) -> Detections {
    let detection = |person: &Labelled| Detection {
        camera: None,
        id: person.id.clone(),
        category: "person".into(),
        score: 1.0,
        bbox: person.bbox,
        attributes: Default::default(),
        interactions: Vec::new(),
        group: None,
        occlusion: None,
        heading_rad: None,
        box3d: None,
    };
    let frame = FrameId { sequence: SEQUENCE.into(), frame: 0 };
    Detections {
        frame,
        image,
        detections: people.iter().map(detection).collect(),
        capabilities: None,
        issues: Vec::new(),
    }
}

#[test]
fn conformance_positions_on_the_real_frame() {
    let (Some(people), Some(root)) = (frame_zero(), shared("data/jrdb-sample")) else { return };
    let dataset = Dataset::open(&root).unwrap();
    let rig = dataset.rig().unwrap();
    let (clouds, issues) = dataset.clouds(SEQUENCE, 0, &rig.lidars);
    assert_eq!(issues, []);
    let detections = detections(&people, rig.cameras[0].lens.image());
    let place = |localizer| {
        let config = ProjectionConfig { localizer, ..ProjectionConfig::default() };
        project(&detections, &Scan::new(&clouds, &rig), &config).unwrap().entities
    };
    let errors = |entities: &[Entity]| {
        let error = |(entity, person): (&Entity, &Labelled)| {
            let [x, y, _] = entity.position.unwrap().center;
            (x - person.center[0]).hypot(y - person.center[1])
        };
        entities.iter().zip(&people).map(error).collect::<Vec<f64>>()
    };
    let placed = place(Localizer::DensestRange);
    let (mean, densest) = (errors(&place(Localizer::Mean)), errors(&placed));
    println!(
        "horizontal position error, metres\n{:<16}{:>8}{:>15}{:>10}{:>8}{:>9}",
        "person", "mean", "densest-range", "quality", "points", "visible"
    );
    for ((entity, mean), densest) in placed.iter().zip(&mean).zip(&densest) {
        let position = entity.position.unwrap();
        let (id, quality) = (entity.id.to_string(), position.quality.word());
        let (points, visible) = (position.points_used, position.visible_fraction.unwrap());
        println!("{id:<16}{mean:>8.2}{densest:>15.2}{quality:>10}{points:>8}{visible:>9.2}");
    }
    println!("{:<16}{:>8.3}{:>15.3}", "median", median(&mean), median(&densest));
    println!("{:<16}{:>8.3}{:>15.3}", "average", average(&mean), average(&densest));
    assert!((median(&mean) - 1.36).abs() < 0.01, "the reference's figure is 1.36 m");
    assert!(median(&densest) <= 0.22 && average(&densest) <= 1.2);
}

#[test]
fn conformance_shoulders_on_the_real_frame() {
    let (Some(people), Some(root)) = (frame_zero(), shared("data/jrdb-sample")) else { return };
    let dataset = Dataset::open(&root).unwrap();
    let rig = dataset.rig().unwrap();
    let clouds = dataset.clouds(SEQUENCE, 0, &rig.lidars).0;
    let sensors = Sensors::new(&rig, None).unwrap();
    let cloud = BaseCloud::merge(&clouds, &sensors, &mut Vec::new());
    let config = ProjectionConfig::default();
    let image = sensors.camera.image();
    let off_deg = |person: &Labelled| {
        let view = BoxView::new(&person.bbox, &sensors.camera);
        let target = Target { bbox: &person.bbox, image, view, is_person: true };
        let inside = points_in_boxes(&cloud, &[person.bbox], image);
        let used = densest_range(&cloud, &inside[0], &target, &config)?.used;
        let line = shoulder_line(&cloud, &used, &config.heading)?;
        let off = (line.normal_rad - person.heading_rad).to_degrees().rem_euclid(180.0);
        Some(off.min(180.0 - off))
    };
    let off: Vec<f64> = people.iter().filter_map(off_deg).collect();
    let rms = (off.iter().map(|d| d * d).sum::<f64>() / off.len() as f64).sqrt();
    println!(
        "shoulders of {} of {}: median {:.1}, rms {rms:.1} degrees off the label",
        off.len(),
        people.len(),
        median(&off)
    );
    assert!(off.len() >= 8 && median(&off) < 20.0);
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    f64::midpoint(sorted[(sorted.len() - 1) / 2], sorted[sorted.len() / 2])
}

fn average(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[test]
fn conformance_points_in_boxes_on_the_real_frame() {
    let (Some(rows), Some(root)) =
        (table("data/frame0_box_points_reference.csv"), shared("data/jrdb-sample"))
    else {
        return;
    };
    let dataset = Dataset::open(&root).unwrap();
    let rig = dataset.rig().unwrap();
    let sensors = Sensors::new(&rig, None).unwrap();
    let clouds = dataset.clouds(SEQUENCE, 0, &rig.lidars).0;
    let cloud = BaseCloud::merge(&clouds, &sensors, &mut Vec::new());
    let boxes: Vec<PixelBox> = rows
        .iter()
        .map(|row| PixelBox::from(numbers(row, ["box_x", "box_y", "box_w", "box_h"])))
        .collect();
    let inside = points_in_boxes(&cloud, &boxes, sensors.camera.image());
    for (row, inside) in rows.iter().zip(&inside) {
        // Single precision moves points on the very edge of a box.
        let more = inside.len() as f64 - number(row, "points_in_box");
        assert!(more.abs() <= 2.0, "{}: {more} points more", row["label_id"]);
        let mean = jrdb_projection::localize::mean(&cloud, inside).unwrap().center;
        let expected = Point3::from(numbers(row, ["mean_x", "mean_y", "mean_z"]));
        assert!(
            (mean - expected).norm() < 0.02,
            "{}: {mean} instead of {expected}",
            row["label_id"]
        );
    }
    println!("{} of {} boxes hold the reference's points", inside.len(), rows.len());
}
