//! How fast the two sweeps of a frame are read: `cargo bench -p jrdb-dataset`.
#![allow(missing_docs, reason = "criterion's macros write functions without")]
#![allow(clippy::unwrap_used, reason = "a failing benchmark should panic")]

mod peer_inputs;

use std::fmt::Write;
use std::fs;
use std::hint::black_box;
use std::path::{Path, PathBuf};

use criterion::{Criterion, criterion_group, criterion_main};
use jrdb_dataset::cloud::{self, Fields};
use jrdb_dataset::pcd::{self, Encoding};
use jrdb_types::PointCloud;
use peer_inputs::{POINTS, SWEEPS, Sweep, uniform};

/// Makes a file of a cloud.
type WriteCloud = fn(&PointCloud) -> Vec<u8>;

/// Seed of the intensities of the first sweep; that of the second is one more.
const INTENSITY_SEED: u64 = 301;

/// Yaw of each LiDAR in the base frame, radians: its points are turned back.
const YAWS_RAD: [f64; 2] = [0.085, 0.0];
/// What its mount adds to z, metres.
const OFFSETS_M: [f64; 2] = [-0.33529, 0.13511];

/// A sweep in its LiDAR's frame.
fn sweep(index: usize, sweep: &Sweep) -> PointCloud {
    let (sin, cos) = (-YAWS_RAD[index]).sin_cos();
    let mut cloud = PointCloud::default();
    for (i, [x, y, z]) in sweep.points().into_iter().map(|p| p.map(f64::from)).enumerate() {
        cloud.x.push((cos * x - sin * y) as f32);
        cloud.y.push((sin * x + cos * y) as f32);
        cloud.z.push((z + OFFSETS_M[index]) as f32);
        let intensity = uniform(INTENSITY_SEED + index as u64, i) * 256.0;
        cloud.intensity.push(intensity.floor() as f32);
    }
    cloud
}

fn rows(cloud: &PointCloud) -> impl Iterator<Item = [f32; 4]> {
    (0..cloud.len()).map(|i| [cloud.x[i], cloud.y[i], cloud.z[i], cloud.intensity[i]])
}

/// ASCII with six decimals, as most programs write it.
fn ascii(cloud: &PointCloud) -> Vec<u8> {
    let header = pcd::write(&PointCloud::default(), Encoding::Ascii);
    let header = String::from_utf8(header).unwrap();
    let header = header.replace("x y z", "x y z intensity").replace("4 4 4", "4 4 4 4");
    let header = header.replace("F F F", "F F F F").replace("1 1 1", "1 1 1 1");
    let mut text = header.replace("WIDTH 0", &format!("WIDTH {POINTS}"));
    text = text.replace("POINTS 0", &format!("POINTS {POINTS}"));
    for [x, y, z, intensity] in rows(cloud) {
        writeln!(text, "{x:.6} {y:.6} {z:.6} {intensity:.0}").unwrap();
    }
    text.into_bytes()
}

/// Points of 22 bytes, as drivers write them: `x y z intensity ring time`.
fn odd(cloud: &PointCloud) -> Vec<u8> {
    let mut bytes = format!(
        "VERSION 0.7\nFIELDS x y z intensity ring time\nSIZE 4 4 4 4 2 4\nTYPE F F F F U F\n\
         COUNT 1 1 1 1 1 1\nWIDTH {POINTS}\nHEIGHT 1\nPOINTS {POINTS}\nDATA binary\n"
    )
    .into_bytes();
    for (i, row) in rows(cloud).enumerate() {
        bytes.extend(row.iter().flat_map(|value| value.to_le_bytes()));
        bytes.extend((i as u16 % 16).to_le_bytes());
        bytes.extend((i as f32 * 1e-6).to_le_bytes());
    }
    bytes
}

fn read_both(paths: &[PathBuf; 2]) -> [PointCloud; 2] {
    paths.each_ref().map(|path| cloud::read(path, "lidar", Fields::All).unwrap())
}

fn clouds(criterion: &mut Criterion) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("clouds");
    fs::create_dir_all(&folder).unwrap();
    let sweeps = [0, 1].map(|i| sweep(i, &SWEEPS[i]));
    let kinds: [(&str, WriteCloud); 4] = [
        ("binary", |cloud| pcd::write(cloud, Encoding::Binary)),
        ("odd", odd),
        ("compressed", |cloud| pcd::write(cloud, Encoding::BinaryCompressed)),
        ("ascii", ascii),
    ];
    let mut group = criterion.benchmark_group("two sweeps");
    for (kind, write) in kinds {
        let paths = [0, 1].map(|i| folder.join(format!("{i}_{kind}.pcd")));
        for (path, sweep) in paths.iter().zip(&sweeps) {
            fs::write(path, write(sweep)).unwrap();
        }
        assert!(read_both(&paths).iter().all(|cloud| cloud.len() == POINTS));
        let bytes = || paths.each_ref().map(|path| fs::read(path).unwrap());
        group.bench_function(format!("{kind}, bytes only"), |b| b.iter(|| black_box(bytes())));
        group.bench_function(kind, |b| b.iter(|| black_box(read_both(&paths))));
    }
    group.finish();
}

criterion_group!(benches, clouds);
criterion_main!(benches);
