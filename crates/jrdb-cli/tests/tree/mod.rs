//! A small dataset in JRDB's form, to be broken: two people 3 m ahead and 3 m to the left.

use std::path::{Path, PathBuf};

use jrdb_dataset::{LabelledFrame, LidarMount, OfficialCalibration, TreeWriter};
use jrdb_types::*;

pub(crate) const SEQUENCE: &str = "two-people";

fn calibration() -> OfficialCalibration {
    let panorama =
        CylindricalPanorama { width_px: 400, height_px: 60, focal_px: 51.5, horizon_px: 26.0 };
    let lidar = |name: &str, z: f64, yaw_rad| LidarMount {
        name: name.into(),
        offset_m: [0.0, 0.0, z],
        yaw_rad,
    };
    OfficialCalibration {
        panorama,
        lidars: vec![lidar("upper_velodyne", -0.25, 0.0), lidar("lower_velodyne", 0.25, 0.0)],
    }
}

/// A person at `(x, y)`, 1.8 m tall from 0.9 m below the sensors, who looks at the robot.
fn person(number: u32, [x, y]: [f64; 2], gender: Gender, bbox: [f64; 4]) -> Detection {
    let heading_rad = (-y).atan2(-x);
    Detection {
        camera: None,
        id: EntityId::new("pedestrian", number),
        category: "person".into(),
        score: 1.0,
        bbox: PixelBox::from(bbox),
        attributes: Attributes::certain([gender.into()]),
        interactions: Vec::new(),
        group: None,
        occlusion: None,
        heading_rad: Some(heading_rad),
        box3d: Some(Box3d { center: [x, y, 0.0], size: [0.5, 0.5, 1.8], heading_rad }),
    }
}

fn cloud(sensor: &str, z: f32) -> PointCloud {
    let grid = (-5..=5_i8)
        .flat_map(|i| (-3..=3_i8).map(move |j| (0.03 * f32::from(i), 0.1 * f32::from(j) + z)));
    let ahead = grid.clone().map(|(side, z)| (2.9, side, z));
    let left = grid.map(|(side, z)| (side, 2.9, z));
    let mut cloud = PointCloud { sensor: sensor.into(), ..PointCloud::default() };
    for (x, y, z) in ahead.chain(left) {
        cloud.x.push(x);
        cloud.y.push(y);
        cloud.z.push(z);
    }
    cloud
}

/// The files of a name below a folder, sorted.
#[allow(dead_code, reason = "not every test file looks for files")]
pub(crate) fn files(root: &Path, name: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(root).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path, name));
        } else if name.is_empty() || path.file_name().is_some_and(|one| one == name) {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// Writes the dataset with frames 0 and 1.
pub(crate) fn write(root: &Path) {
    let (writer, calibration) = (TreeWriter::new(root), calibration());
    writer.calibration(&calibration).unwrap();
    let mut frames = Vec::new();
    for frame in 0..2 {
        let id = FrameId { sequence: SEQUENCE.into(), frame };
        writer.image(&id, &Image::filled(400, 60, [90, 90, 90])).unwrap();
        writer.cloud(&id, &cloud("upper_velodyne", -0.25)).unwrap();
        writer.cloud(&id, &cloud("lower_velodyne", 0.25)).unwrap();
        let people = vec![
            person(1, [3.0, 0.0], Gender::Male, [194.0, 10.0, 12.0, 31.0]),
            person(2, [0.0, 3.0], Gender::Female, [94.0, 10.0, 12.0, 31.0]),
        ];
        let image = calibration.rig().cameras[0].lens.image();
        let detections = Detections::new(id, image, people);
        frames.push(LabelledFrame { detections, num_points: Default::default() });
    }
    writer.labels(SEQUENCE, &frames).unwrap();
}
