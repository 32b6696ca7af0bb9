//! Checks against real sweeps of JRDB, for whoever has some; skipped without them.
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]
#![allow(clippy::print_stdout, reason = "skipping is visible, and so are the numbers")]

use std::fs;
use std::path::PathBuf;

use jrdb_calibration::nalgebra::Point3;
use jrdb_calibration::{Floor, FloorConfig, compare_floors, fit_floor};
use jrdb_dataset::Dataset;
use jrdb_projection::Sensors;
use jrdb_types::Rig;

/// The sample's tree, unless it is absent.
fn sample() -> Option<Dataset> {
    let default = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared");
    let folder = std::env::var_os("JRDB_SHARED").map_or_else(|| default.into(), PathBuf::from);
    let root = folder.join("data/jrdb-sample");
    if !root.is_dir() {
        println!("skipped: no shared data");
        return None;
    }
    Some(Dataset::open(&root).unwrap())
}

fn in_base(points: impl Iterator<Item = Point3<f64>>, sensor: &str, rig: &Rig) -> Vec<Point3<f64>> {
    let base_from_lidar = Sensors::new(rig, None).unwrap().lidars[sensor];
    points.map(|in_lidar| base_from_lidar * in_lidar).collect()
}

/// Histograms of the heights of the clouds have the floor between -0.96 and -0.88 m.
fn check(name: &str, floor: &Floor) {
    let tilt_deg = floor.tilt_rad().to_degrees();
    println!("{name}: tilt {tilt_deg:.2} degrees, {floor:?}");
    assert!((-0.96..=-0.86).contains(&floor.height_m), "{name}: {} m", floor.height_m);
    assert!(tilt_deg < 2.0, "{name}: {tilt_deg} degrees");
}

#[test]
fn conformance_floor_of_the_real_frame() {
    let Some(dataset) = sample() else { return };
    let rig = dataset.rig().unwrap();
    let (clouds, _) = dataset.clouds("bytes-cafe-2019-02-07_0", 0, &rig.lidars);
    let points: Vec<Vec<Point3<f64>>> = clouds
        .iter()
        .map(|cloud| {
            let at = |i: usize| Point3::new(cloud.x[i], cloud.y[i], cloud.z[i]).cast::<f64>();
            in_base((0..cloud.len()).map(at), &cloud.sensor, &rig)
        })
        .collect();
    let named: Vec<(&str, &[Point3<f64>])> =
        clouds.iter().zip(&points).map(|(c, p)| (c.sensor.as_str(), p.as_slice())).collect();
    let found = compare_floors(&named, &FloorConfig::default()).unwrap();
    for seen in &found.floors {
        check(&seen.sensor, &seen.floor);
    }
    assert_eq!(found.differences.len(), 1);
    println!("{:?}", found.differences[0]);
    assert!(found.differences[0].height_m.abs() < 0.05);
}

/// Rows of four little-endian `f32`: x, y, z, intensity, in the lower LiDAR's frame. Two sweeps of
/// flat floors; elsewhere the ground may be anything.
#[test]
fn conformance_floor_of_single_raw_sweeps() {
    let Some(dataset) = sample() else { return };
    let rig = dataset.rig().unwrap();
    for name in ["024653.bin", "026500.bin"] {
        let Ok(bytes) = fs::read(dataset.root().join("extra_lower_velodyne_bin").join(name)) else {
            println!("skipped: no shared data");
            continue;
        };
        let (numbers, _) = bytes.as_chunks::<4>();
        let numbers: Vec<f64> = numbers.iter().map(|b| f32::from_le_bytes(*b).into()).collect();
        let rows = numbers.chunks_exact(4).map(|row| Point3::new(row[0], row[1], row[2]));
        let points = in_base(rows, "lower_velodyne", &rig);
        let floor = fit_floor(&points, &FloorConfig::default()).unwrap();
        check(name, &floor);
    }
}
