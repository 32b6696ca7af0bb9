//! What the projection kernels are measured on: a LiDAR sweep, image boxes and 3D boxes of the people in it.
#![allow(dead_code, reason = "not every program that includes this file measures everything")]

#[path = "../../../jrdb-dataset/benches/peer_inputs/mod.rs"]
mod peer_inputs;

use std::f64::consts::{PI, TAU};

use jrdb_types::rig::FORWARD_CAMERA;
use jrdb_types::{
    Box3d, Camera, CylindricalPanorama, Detection, Detections, EntityId, FrameId, LensModel, Lidar,
    PixelBox, PointCloud, Rig, Transform,
};
use peer_inputs::{FLOOR_M, Person, SWEEPS, people, uniform};

/// JRDB's panorama.
const PANORAMA: CylindricalPanorama =
    CylindricalPanorama { width_px: 3760, height_px: 480, focal_px: 482.924, horizon_px: 209.383 };

/// That panorama around the base frame's origin, and a LiDAR whose points are in the base frame.
pub(crate) fn rig() -> Rig {
    Rig {
        base: "base".into(),
        transforms: vec![Transform {
            parent: "base".into(),
            child: "panorama".into(),
            translation_m: [0.0; 3],
            rotation: FORWARD_CAMERA,
        }],
        cameras: vec![Camera {
            name: "panorama".into(),
            frame: "panorama".into(),
            lens: LensModel::Cylindrical(PANORAMA),
        }],
        lidars: vec![Lidar { name: "lidar".into(), frame: "base".into() }],
    }
}

/// The first `count` points of the upper sweep, then as many of the lower, in the base frame.
pub(crate) fn cloud(count: usize) -> PointCloud {
    let points = || SWEEPS.iter().flat_map(|sweep| sweep.first_points(count));
    let [x, y, z] = [0, 1, 2].map(|axis| points().map(|point| point[axis]).collect());
    PointCloud { sensor: "lidar".into(), x, y, z, ..PointCloud::default() }
}

/// Image boxes around the first `count` people; the first is across the seam.
pub(crate) fn boxes(count: usize) -> Vec<PixelBox> {
    people().iter().take(count).map(image_box).collect()
}

/// The box of a person with a tenth to spare on either side.
fn image_box(person: &Person) -> PixelBox {
    let [width, height] = [PANORAMA.width_px, PANORAMA.height_px].map(f64::from);
    let half = (person.radius_m / person.range_m).asin() * 1.1;
    let x = (width / 2.0 - (person.azimuth_rad + half) * width / TAU).rem_euclid(width);
    let row = |z: f64| PANORAMA.horizon_px - PANORAMA.focal_px * z / person.range_m;
    let y = row(FLOOR_M + person.height_m).clamp(0.0, height - 2.0);
    let bottom = row(FLOOR_M).clamp(1.0, height);
    PixelBox { x, y, w: half * width / PI, h: bottom - y }
}

/// The first `count` people as a perfect detector sees them.
pub(crate) fn detections(count: usize) -> Detections {
    let detection = |(number, bbox)| Detection {
        camera: None,
        id: EntityId::new("pedestrian", number),
        category: "person".into(),
        score: 1.0,
        bbox,
        attributes: Default::default(),
        interactions: Vec::new(),
        group: None,
        occlusion: None,
        heading_rad: None,
        box3d: None,
    };
    Detections {
        frame: FrameId { sequence: "sweep".into(), frame: 0 },
        image: LensModel::Cylindrical(PANORAMA).image(),
        detections: (1..).zip(boxes(count)).map(detection).collect(),
        capabilities: None,
        issues: Vec::new(),
    }
}

/// People-sized boxes in a room that grows with their number, turned anyhow.
pub(crate) fn boxes3d(count: usize) -> Vec<Box3d> {
    let side_m = 3.0 + 0.6 * (count as f64).sqrt();
    let number = |which: usize, index: usize| uniform(400 + count as u64, which * count + index);
    let place = |i: usize| Box3d {
        center: [
            (number(0, i) - 0.5) * 2.0 * side_m,
            (number(1, i) - 0.5) * 2.0 * side_m,
            -0.3 + number(2, i) * 0.4,
        ],
        size: [0.4 + number(3, i) * 0.8, 0.4 + number(4, i) * 0.5, 1.4 + number(5, i) * 0.5],
        heading_rad: PI - (number(6, i) - 0.5) * 2.0 * TAU,
    };
    (0..count).map(place).collect()
}

/// A kernel over every unordered pair: the sum of what it gives.
pub(crate) fn over_pairs(boxes: &[Box3d], of_pair: fn(&Box3d, &Box3d) -> f64) -> f64 {
    let all = boxes.iter().enumerate();
    all.flat_map(|(i, a)| boxes[i + 1..].iter().map(move |b| of_pair(a, b))).sum()
}
