//! Checks and times our kernels on the inputs that other programs are timed on: `cargo xtask peers` starts it.
//!
//! `peer_kernels DATA` takes the folder of the inputs and prints `{"rows": [{"case", "median_ms", "runs", ..}]}`. Every result
//! is checked before it is timed; a wrong one ends the program with exit code 1. All on one thread.
#![allow(clippy::print_stdout, reason = "its result is what it prints")]

mod coco;

use std::fs::{self, File};
use std::hint::black_box;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail, ensure};
use jrdb_dataset::cloud::{self, Fields, Reader};
use jrdb_dataset::{Dataset, decode_image, pcd};
use jrdb_perception::image::{Filter, Layout, Normalise, Region, Resizer, resize};
use jrdb_projection::nalgebra::Point3;
use jrdb_projection::relation::{self, overlap, pairwise::pairwise};
use jrdb_projection::select::points_in_boxes;
use jrdb_projection::{BaseCloud, CameraModel, ProjectionConfig, Scan, Sensors, localize, project};
use jrdb_types::rig::FORWARD_CAMERA;
use jrdb_types::{
    Box3d, Camera, CylindricalPanorama, Detection, Detections, Entities, EntityId, FrameId, Image,
    LateralConvention, LensModel, Lidar, PixelBox, PointCloud, Rig, Transform,
};
use serde_json::{Value, json};

/// Every kernel runs so often unmeasured, at least so often measured, and then until the time is over.
const WARM_UP_RUNS: usize = 3;
const MIN_RUNS: usize = 21;
const MAX_RUNS: usize = 301;
const TIME: Duration = Duration::from_millis(1500);

/// Points at the very edge of a box may fall to either side in single precision: at most so many.
const EDGE_POINTS: usize = 5;
/// Centres may be this far from those of the reference, metres.
const CENTER_TOLERANCE_M: f64 = 0.02;
/// Coordinates of the ASCII clouds are rounded to six decimals, metres.
const ASCII_TOLERANCE_M: f32 = 2e-6;

/// The real frame, in the research data.
const SEQUENCE: &str = "bytes-cafe-2019-02-07_0";

fn main() -> Result<()> {
    let data = std::env::args().nth(1).context("expected the folder of the inputs")?;
    let data = PathBuf::from(data);
    let mut rows = Vec::new();
    rows.extend(projection(&data.join("a")).context("projection")?);
    rows.extend(files(&data.join("b")).context("files")?);
    rows.extend(pairs(&data.join("c")).context("pairs")?);
    rows.extend(coco::evaluations(&data.join("e")).context("COCO statistics")?);
    rows.extend(pictures(&data.join("g")).context("pictures")?);
    rows.extend(real_frame().context("real frame")?);
    println!("{}", json!({ "rows": rows }));
    Ok(())
}

/// Times pieces of work in turn, so that all meet the same weather; gives a median for each, ms, and the runs.
fn medians_ms<const N: usize>(mut works: [&mut dyn FnMut(); N]) -> ([f64; N], usize) {
    for _ in 0..WARM_UP_RUNS {
        works.iter_mut().for_each(|work| work());
    }
    let (started, mut runs) = (Instant::now(), 0);
    let mut times: [Vec<f64>; N] = std::array::from_fn(|_| Vec::new());
    while runs < MIN_RUNS || (runs < MAX_RUNS && started.elapsed() < TIME) {
        for (work, times) in works.iter_mut().zip(&mut times) {
            let start = Instant::now();
            work();
            times.push(start.elapsed().as_secs_f64() * 1e3);
        }
        runs += 1;
    }
    (times.map(median), runs)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    f64::midpoint(values[(values.len() - 1) / 2], values[values.len() / 2])
}

fn row(case: &str, mut work: impl FnMut()) -> Value {
    let ([median_ms], runs) = medians_ms([&mut work]);
    json!({ "case": case, "median_ms": median_ms, "runs": runs })
}

/// The numbers of a `.npy` file of version 1, as their bytes.
fn npy<const BYTES: usize>(path: &Path) -> Result<Vec<[u8; BYTES]>> {
    let bytes = fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    let length = bytes.get(8..10).map_or(0, |b| usize::from(u16::from_le_bytes([b[0], b[1]])));
    let body = bytes.get(10 + length..).unwrap_or_default();
    Ok(body.as_chunks::<BYTES>().0.to_vec())
}

// Projection, selection and mean centres.

/// The inputs' own rig: the panorama and the points around one origin.
fn rig() -> Rig {
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
            lens: LensModel::Cylindrical(CylindricalPanorama {
                width_px: 3760,
                height_px: 480,
                focal_px: 482.924,
                horizon_px: 209.383,
            }),
        }],
        lidars: vec![Lidar { name: "lidar".into(), frame: "base".into() }],
    }
}

fn projection(data: &Path) -> Result<Vec<Value>> {
    let sensors = Sensors::new(&rig(), None)?;
    let reference: Value = serde_json::from_slice(&fs::read(data.join("reference.json"))?)?;
    let mut rows = Vec::new();
    for points in [65_536, 131_072] {
        let clouds =
            [cloud::read(&data.join(format!("cloud_{points}.npy")), "lidar", Fields::All)?];
        for count in [10, 50, 100] {
            let boxes = boxes(&data.join(format!("boxes_{count}.npy")))?;
            let mut cloud = BaseCloud::default();
            let mut centers = || {
                cloud.refill(&clouds, &sensors, &mut Vec::new());
                let inside = points_in_boxes(&cloud, &boxes, sensors.camera.image());
                inside.iter().map(|inside| localize::mean(&cloud, inside)).collect::<Vec<_>>()
            };
            let case = format!("N={points} M={count}");
            check_centers(&centers(), &reference[format!("{points}/{count}")])
                .context(case.clone())?;
            rows.push(row(&case, || drop(black_box(centers()))));
        }
    }
    Ok(rows)
}

fn boxes(path: &Path) -> Result<Vec<PixelBox>> {
    let numbers: Vec<f64> = npy(path)?.into_iter().map(|b| f32::from_le_bytes(b).into()).collect();
    Ok(numbers.as_chunks::<4>().0.iter().map(|&xywh| PixelBox::from(xywh)).collect())
}

fn check_centers(found: &[Option<localize::Located>], reference: &Value) -> Result<()> {
    let expected = reference.as_array().context("the reference has no such case")?;
    ensure!(
        found.len() == expected.len(),
        "expected {} boxes, found {}",
        expected.len(),
        found.len()
    );
    for (index, (found, expected)) in found.iter().zip(expected).enumerate() {
        let count = expected["count"].as_u64().context("the reference has no count")? as usize;
        let used = found.as_ref().map_or(0, |located| located.used.len());
        ensure!(used.abs_diff(count) <= EDGE_POINTS, "box {index}: {used} points, not {count}");
        let coordinate = |axis: usize| expected["centre"][axis].as_f64();
        let (Some(x), Some(y), Some(z)) = (coordinate(0), coordinate(1), coordinate(2)) else {
            continue;
        };
        let center = found.as_ref().map(|located| located.center);
        let off_m = center.map_or(f64::INFINITY, |center| (center - Point3::new(x, y, z)).norm());
        ensure!(off_m <= CENTER_TOLERANCE_M, "box {index}: the centre is {off_m} m off");
    }
    Ok(())
}

// Files.

fn files(data: &Path) -> Result<Vec<Value>> {
    let paths = |kind: &str| ["upper", "lower"].map(|name| data.join(format!("{name}_{kind}.pcd")));
    let mut expected = Default::default();
    read_both(&mut Reader::default(), &paths("binary"), Fields::All, &mut expected)?;
    for (path, cloud) in paths("compressed").iter().zip(&expected) {
        if !path.exists() {
            // The inputs are made without it where Python has no LZF.
            fs::write(path, pcd::write(cloud, pcd::Encoding::BinaryCompressed))?;
        }
    }
    let mut rows = Vec::new();
    for kind in ["binary", "odd", "compressed", "ascii"] {
        let paths = paths(kind);
        // As a robot reads: positions only, as the others do, into the clouds of the frame before.
        let (mut reader, mut clouds) = (Reader::default(), Default::default());
        read_both(&mut reader, &paths, Fields::Positions, &mut clouds)?;
        check_clouds(&clouds, &expected).context(kind)?;
        let mut ours = || {
            black_box(read_both(&mut reader, &paths, Fields::Positions, &mut clouds)).ok();
            black_box(&clouds);
        };
        let ([median_ms], runs) = medians_ms([&mut ours]);
        let mut buffers = Default::default();
        bytes_into(&paths, &mut buffers)?;
        let mut bytes = || {
            black_box(bytes_into(&paths, &mut buffers)).ok();
            black_box(&buffers);
        };
        // Not in turn with the others, whose caches it would take.
        let ([bytes_ms], _) = medians_ms([&mut bytes]);
        // What is left of many runs is still right.
        check_clouds(&clouds, &expected).context(kind)?;
        rows.push(
            json!({ "case": kind, "median_ms": median_ms, "bytes_ms": bytes_ms, "runs": runs }),
        );
    }
    rows.push(in_new_memory("binary", &paths("binary"))?);
    Ok(rows)
}

/// The first files of a recording: nothing that is read is given back, so that all memory is new.
fn in_new_memory(kind: &str, paths: &[PathBuf; 2]) -> Result<Value> {
    let (mut clouds, mut bytes) = (Vec::new(), Vec::new());
    let (mut times_ms, mut bytes_times_ms) = (Vec::new(), Vec::new());
    for _ in 0..WARM_UP_RUNS + MIN_RUNS {
        let start = Instant::now();
        clouds.push(paths.each_ref().map(|path| cloud::read(path, "lidar", Fields::Positions)));
        times_ms.push(start.elapsed().as_secs_f64() * 1e3);
        let start = Instant::now();
        bytes.push(paths.each_ref().map(fs::read));
        bytes_times_ms.push(start.elapsed().as_secs_f64() * 1e3);
    }
    let is_read =
        clouds.iter().flatten().all(Result::is_ok) && bytes.iter().flatten().all(Result::is_ok);
    ensure!(is_read, "the files changed while they were read");
    let [median_ms, bytes_ms] =
        [times_ms, bytes_times_ms].map(|mut times| median(times.split_off(WARM_UP_RUNS)));
    let case = format!("{kind}, into new memory");
    Ok(json!({ "case": case, "median_ms": median_ms, "bytes_ms": bytes_ms, "runs": MIN_RUNS }))
}

fn read_both(
    reader: &mut Reader,
    [upper, lower]: &[PathBuf; 2],
    fields: Fields,
    [to_upper, to_lower]: &mut [PointCloud; 2],
) -> Result<()> {
    reader.read_into(upper, "upper", fields, to_upper)?;
    Ok(reader.read_into(lower, "lower", fields, to_lower)?)
}

/// What `fs::read` does, but into memory that is used again.
fn bytes_into(paths: &[PathBuf; 2], buffers: &mut [Vec<u8>; 2]) -> io::Result<()> {
    for (path, buffer) in paths.iter().zip(buffers) {
        buffer.clear();
        File::open(path)?.read_to_end(buffer)?;
    }
    Ok(())
}

fn check_clouds(found: &[PointCloud; 2], expected: &[PointCloud; 2]) -> Result<()> {
    for (found, expected) in found.iter().zip(expected) {
        let (points, count) = (found.len(), expected.len());
        ensure!(points == count && count > 0, "expected {count} points, found {points}");
        let axes = [(&found.x, &expected.x), (&found.y, &expected.y), (&found.z, &expected.z)];
        let off = axes.iter().flat_map(|(a, b)| a.iter().zip(*b)).map(|(a, b)| (a - b).abs());
        let off_m = off.fold(0.0, f32::max);
        ensure!(off_m <= ASCII_TOLERANCE_M, "a coordinate is {off_m} m off");
    }
    Ok(())
}

// All pairs.

fn pairs(data: &Path) -> Result<Vec<Value>> {
    let mut rows = Vec::new();
    for count in [100, 500] {
        let boxes = boxes3d(&data.join(format!("obb_{count}.npy")))?;
        let centers: Vec<Point3<f64>> = boxes.iter().map(|b| b.center.into()).collect();
        // The peers relate in JRDB's convention of angles, but turn the boxes themselves counter-clockwise.
        let heading = |b: &Box3d| relation::wrap_rad(std::f64::consts::PI - b.heading_rad);
        let headings: Vec<f64> = boxes.iter().map(heading).collect();
        let relate = || pairwise(&centers, &headings, LateralConvention::Physical);
        check_words(&relate(), &centers, &headings)?;
        rows.push(row(&format!("relations M={count}"), || drop(black_box(relate()))));
        let mut iou = row(&format!("iou3d M={count}"), || drop(black_box(all_iou(&boxes))));
        // The other programs count these too.
        iou["overlapping"] = all_iou(&boxes).iter().filter(|&&iou| iou > 0.0).count().into();
        rows.push(iou);
    }
    Ok(rows)
}

fn all_iou(boxes: &[Box3d]) -> Vec<f64> {
    let all = boxes.iter().enumerate();
    all.flat_map(|(i, a)| boxes[i + 1..].iter().map(move |b| overlap::iou(a, b))).collect()
}

/// Boxes of `cx cy cz l w h angle`, the angle counter-clockwise.
fn boxes3d(path: &Path) -> Result<Vec<Box3d>> {
    let numbers: Vec<f64> = npy(path)?.into_iter().map(f64::from_le_bytes).collect();
    let place = |&[x, y, z, l, w, h, angle_rad]: &[f64; 7]| Box3d {
        center: [x, y, z],
        size: [l, w, h],
        heading_rad: relation::wrap_rad(angle_rad),
    };
    Ok(numbers.as_chunks::<7>().0.iter().map(place).collect())
}

/// The words of all pairs at once are those of every pair alone, which follow the definitions.
fn check_words(
    pairs: &relation::Pairwise,
    centers: &[Point3<f64>],
    headings_rad: &[f64],
) -> Result<()> {
    let lateral = LateralConvention::Physical;
    for (i, (a, heading)) in centers.iter().zip(headings_rad).enumerate() {
        for (j, b) in centers.iter().enumerate().filter(|&(j, _)| j != i) {
            let alone = relation::from_person(a, Some(*heading), b, lateral);
            let together = (pairs.distance(i, j), Some(pairs.direction(i, j)));
            let same = together == (alone.distance, alone.direction);
            ensure!(same, "pair {i}, {j}: expected {alone:?}, found {together:?}");
        }
    }
    Ok(())
}

// Pictures.

/// Columns of the panorama that one tile shows, and how far apart tiles begin, pixels; sides of the tensors of tiles and crops.
const TILE_PX: usize = 640;
const TILE_STEP_PX: usize = 520;
const TILES: usize = 7;
const TILE_SIDE: usize = 768;
const CROP_SIDE: usize = 448;

/// From a JPEG in memory to the tensors of its tiles and of crops; nothing where the inputs could not be made.
fn pictures(data: &Path) -> Result<Vec<Value>> {
    let path = data.join("pano.jpg");
    if !path.exists() {
        return Ok(Vec::new());
    }
    let bytes = fs::read(path)?;
    let image = decode_image(&bytes)?;
    let crops: Vec<[usize; 4]> = serde_json::from_slice(&fs::read(data.join("crops.json"))?)?;
    let crops: Vec<Region> = crops
        .iter()
        .map(|&[x_px, y_px, width_px, height_px]| Region { x_px, y_px, width_px, height_px })
        .collect();
    let whole = Region::whole(&image);
    let tile = |at: usize| Region { x_px: at * TILE_STEP_PX, width_px: TILE_PX, ..whole };
    let tiles: Vec<Region> = (0..TILES).map(tile).collect();
    let mut of_tiles = Tensors::new(TILE_SIDE, tiles.len());
    let mut of_crops = Tensors::new(CROP_SIDE, crops.len());
    of_tiles.fill(&image, &tiles);
    of_crops.fill(&image, &crops);
    of_tiles.check(&image, &tiles)?;
    of_crops.check(&image, &crops)?;
    let mut both =
        || of_tiles.fill(&decode_image(&bytes).unwrap_or_else(|_| image.clone()), &tiles);
    let decoded = row("decode + 7 tiles", &mut both);
    Ok(vec![
        row("decode 3760x480", || drop(black_box(decode_image(&bytes)))),
        row("7 tiles -> 768^2 norm (no decode)", || of_tiles.fill(&image, &tiles)),
        decoded,
        row("30 crops -> 448^2 norm (no decode)", || of_crops.fill(&image, &crops)),
    ])
}

/// Square tensors, one behind the other, whose memory is used again.
struct Tensors {
    resizer: Resizer,
    side: usize,
    numbers: Vec<f32>,
}

impl Tensors {
    fn new(side: usize, count: usize) -> Self {
        let resizer = Resizer::new(Filter::Bilinear, side, side);
        Self { resizer, side, numbers: vec![0.0; 3 * side * side * count] }
    }

    fn fill(&mut self, image: &Image, regions: &[Region]) {
        let tensors = self.numbers.chunks_exact_mut(3 * self.side * self.side);
        for (region, tensor) in regions.iter().zip(tensors) {
            self.resizer.tensor(image, *region, &Normalise::IMAGENET, Layout::Chw, tensor);
        }
        black_box(&self.numbers);
    }

    /// Every number is that of a pixel of the region, cut out first and scaled alone.
    fn check(&self, image: &Image, regions: &[Region]) -> Result<()> {
        let plane = self.side * self.side;
        for (region, tensor) in regions.iter().zip(self.numbers.chunks_exact(3 * plane)) {
            let mut crop = Image::filled(region.width_px, region.height_px, [0; 3]);
            for (at, pixel) in crop.rgb.as_chunks_mut::<3>().0.iter_mut().enumerate() {
                let (x, y) = (at % region.width_px, at / region.width_px);
                *pixel = image.pixel(region.x_px + x, region.y_px + y);
            }
            let scaled = resize(&crop, self.side, self.side, Filter::Bilinear);
            let expected = |at: usize| {
                Normalise::IMAGENET.value(scaled.rgb[at % plane * 3 + at / plane], at / plane)
            };
            let wrong = (0..3 * plane).find(|&at| tensor[at] != expected(at));
            ensure!(wrong.is_none(), "number {wrong:?} of {region:?} is not that of its pixel");
        }
        Ok(())
    }
}

// A real frame.

/// From two compressed clouds on disk to entities; nothing where there is no research data.
fn real_frame() -> Result<Option<Value>> {
    let default = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared");
    let shared = std::env::var_os("JRDB_SHARED").map_or_else(|| default.into(), PathBuf::from);
    let root = shared.join("data/jrdb-sample");
    let labels = shared.join("data/frame0_box_points_reference.csv");
    if !root.exists() || !labels.exists() {
        return Ok(None);
    }
    let dataset = Dataset::open(&root)?;
    let rig = dataset.rig()?;
    let (detections, points_in_box) = people(&fs::read_to_string(labels)?, &rig)?;
    let entities = || -> Result<Entities> {
        let (clouds, issues) = dataset.clouds(SEQUENCE, 0, &rig.lidars);
        ensure!(issues.is_empty(), "{issues:?}");
        Ok(project(&detections, &Scan::new(&clouds, &rig), &ProjectionConfig::default())?)
    };
    for (entity, expected) in entities()?.entities.iter().zip(points_in_box) {
        let found = entity.position.map_or(0, |position| position.points_in_box);
        if found.abs_diff(expected) > EDGE_POINTS {
            bail!("{}: expected {expected} points, found {found}", entity.id);
        }
    }
    Ok(Some(row("real frame", || drop(black_box(entities())))))
}

/// The people of the frame, and how many points the reference counts in the box of each: lines of
/// `id, x, y, w, h, (6 numbers), points, ..`.
fn people(table: &str, rig: &Rig) -> Result<(Detections, Vec<usize>)> {
    let (mut detections, mut points) = (Vec::new(), Vec::new());
    for line in table.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |cell: usize| -> Result<f64> {
            Ok(cells.get(cell).context("a line of the reference is too short")?.parse()?)
        };
        detections.push(Detection {
            camera: None,
            id: cells[0].parse::<EntityId>()?,
            category: "person".into(),
            score: 1.0,
            bbox: PixelBox::from([number(1)?, number(2)?, number(3)?, number(4)?]),
            attributes: Default::default(),
            interactions: Vec::new(),
            group: None,
            occlusion: None,
            heading_rad: None,
            box3d: None,
        });
        points.push(number(11)? as usize);
    }
    let frame = FrameId { sequence: SEQUENCE.into(), frame: 0 };
    let image = rig.cameras.first().context("the rig has no camera")?.lens.image();
    Ok((Detections::new(frame, image, detections), points))
}
