//! People on a real, labelled panorama.
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]
#![allow(clippy::print_stdout, reason = "tests say what they found and what they skip")]

mod onnxruntime;

use std::path::PathBuf;
use std::time::Instant;

use jrdb_perception::{Detector, Engine, OrtEngine, RtenEngine, SsdLite, SsdLiteConfig};
use jrdb_types::{Detection, FrameId, Image, PixelBox};
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;

const SEQUENCE: &str = "bytes-cafe-2019-02-07_0";

fn shared() -> PathBuf {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared");
    std::env::var_os("JRDB_SHARED").map_or_else(|| beside.into(), PathBuf::from)
}

struct Scene {
    image: Image,
    people: Vec<PixelBox>,
    model: Vec<u8>,
}

impl Scene {
    fn read() -> Option<Self> {
        let (shared, sample) = (shared(), shared().join("data/jrdb-sample"));
        let model = std::fs::read(shared.join("models/ssdlite-mbv2-300-person.f16.onnx")).ok()?;
        let picture = sample.join(format!("images/image_stitched/{SEQUENCE}/000000.jpg"));
        let mut decoder = JpegDecoder::new(ZCursor::new(std::fs::read(picture).ok()?));
        let rgb = decoder.decode().unwrap();
        let (width, height) = decoder.dimensions().unwrap();
        let labels = sample.join(format!("labels/{SEQUENCE}.track_3dbb_2dbb.csv"));
        let people = std::fs::read_to_string(labels).ok()?.lines().filter_map(person).collect();
        Some(Self { image: Image { width, height, rgb }, people, model })
    }

    /// The same scene with the seam elsewhere.
    fn turn(&mut self, columns: usize) {
        let width = self.image.width;
        let rows = self.image.rgb.chunks_exact_mut(3 * width);
        rows.for_each(|row| row.rotate_right(3 * columns));
        for person in &mut self.people {
            let moved = PixelBox { x: person.x + columns as f64, ..*person };
            *person = moved.wrapped(width as f64);
        }
    }

    fn detect(&self, engine: Box<dyn Engine>, config: SsdLiteConfig) -> Vec<Detection> {
        let frame = FrameId { sequence: SEQUENCE.into(), frame: 0 };
        SsdLite::new(engine, config).detect(&self.image, &frame).unwrap().detections
    }

    /// For each detection, most confident first, whether it shows a person not shown before.
    fn judge(&self, detections: &[Detection]) -> Vec<bool> {
        let period_px = Some(self.image.width as f64);
        let mut ordered: Vec<&Detection> = detections.iter().collect();
        ordered.sort_by(|a, b| b.score.total_cmp(&a.score));
        let mut unseen = self.people.clone();
        let judge = |d: &Detection| {
            let iou = |p: &PixelBox| d.bbox.iou(p, period_px);
            let best =
                (0..unseen.len()).max_by(|&a, &b| iou(&unseen[a]).total_cmp(&iou(&unseen[b])));
            let right = best.filter(|&at| iou(&unseen[at]) >= 0.5);
            right.map(|at| unseen.remove(at)).is_some()
        };
        ordered.into_iter().map(judge).collect()
    }

    /// Average precision at IoU 0.5 on the circle, COCO's 101 recall points.
    fn ap50(&self, detections: &[Detection]) -> f64 {
        let mut right = 0;
        let points: Vec<(f64, f64)> = (1..)
            .zip(self.judge(detections))
            .map(|(n, is_right)| {
                right += usize::from(is_right);
                (right as f64 / self.people.len() as f64, right as f64 / f64::from(n))
            })
            .collect();
        let precision_at =
            |recall: f64| points.iter().filter(|p| p.0 >= recall).map(|p| p.1).fold(0.0, f64::max);
        (0..=100).map(|i| precision_at(f64::from(i) * 0.01)).sum::<f64>() / 101.0
    }
}

/// A person of frame 0: the columns are frame, track, six of the 3D box, x, y, w, h.
fn person(line: &str) -> Option<PixelBox> {
    let columns: Vec<f64> = line.split(',').map(|c| c.parse().unwrap()).collect();
    (columns[0] == 0.0).then(|| PixelBox::from(<[f64; 4]>::try_from(&columns[8..12]).unwrap()))
}

struct Quality {
    ap50: f64,
    right: usize,
    wrong: usize,
}

fn quality(scene: &Scene, make: impl Fn() -> Box<dyn Engine>) -> (Quality, Vec<Detection>) {
    let every = SsdLiteConfig { min_score: 0.05, ..SsdLiteConfig::default() };
    let ap50 = scene.ap50(&scene.detect(make(), every));
    let detections = scene.detect(make(), SsdLiteConfig::default());
    let judged = scene.judge(&detections);
    let right = judged.iter().filter(|right| **right).count();
    (Quality { ap50, right, wrong: judged.len() - right }, detections)
}

fn check(scene: &Scene, make: impl Fn() -> Box<dyn Engine> + Sync) -> Vec<Detection> {
    let (Quality { ap50, right, wrong }, detections) = quality(scene, &make);
    let (name, people) = (make().name().to_owned(), scene.people.len());
    println!("{name}: AP50 {ap50:.3}, {right} of {people} people found, {wrong} false");
    assert!(ap50 >= 0.5 && right >= 9 && wrong <= 2);

    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let engine = make();
        let start = Instant::now();
        let again = pool.install(|| scene.detect(engine, SsdLiteConfig::default()));
        println!("{name}: {} ms per panorama with {threads} threads", start.elapsed().as_millis());
        assert_eq!(again, detections, "with {threads} threads");
    }
    detections
}

/// The largest difference of two lists of the same detections: pixels, score.
fn difference(a: &[Detection], b: &[Detection]) -> (f64, f64) {
    assert_eq!(a.len(), b.len());
    let (mut pixels, mut score) = (0.0_f64, 0.0_f64);
    for (a, b) in a.iter().zip(b) {
        for (a, b) in <[f64; 4]>::from(a.bbox).into_iter().zip(<[f64; 4]>::from(b.bbox)) {
            pixels = pixels.max((a - b).abs());
        }
        score = score.max((a.score - b.score).abs());
    }
    (pixels, score)
}

#[test]
fn conformance_ssdlite_on_the_real_frame() {
    let Some(scene) = Scene::read() else {
        println!("skipped: no shared data");
        return;
    };
    let rten = check(&scene, || Box::new(RtenEngine::from_onnx(&scene.model).unwrap()));
    let Some(library) = onnxruntime::find() else { return };
    let ort = check(&scene, || Box::new(OrtEngine::from_onnx(&library, &scene.model, 1).unwrap()));
    let (pixels, score) = difference(&rten, &ort);
    println!("largest difference between the engines: {pixels:.1e} px, {score:.1e} in score");
    assert!(pixels < 1e-3 && score < 1e-4);
}

#[test]
fn conformance_ssdlite_wherever_the_seam_and_the_tiles_begin() {
    let Some(mut scene) = Scene::read() else {
        println!("skipped: no shared data");
        return;
    };
    let library = onnxruntime::find();
    for turn in 1..=4 {
        scene.turn(467); // a tile's width and a half, and no multiple of any stride
        let (Quality { ap50, right, wrong }, _) = quality(&scene, || match &library {
            Some(library) => Box::new(OrtEngine::from_onnx(library, &scene.model, 1).unwrap()),
            None => Box::new(RtenEngine::from_onnx(&scene.model).unwrap()),
        });
        println!("turned {turn} times: AP50 {ap50:.3}, {right} people found, {wrong} false");
        assert!(ap50 >= 0.45 && right >= 8 && wrong <= 3);
    }
}
