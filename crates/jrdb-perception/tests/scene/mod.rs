//! The one labelled panorama, and how well detections fit its labels.
#![allow(dead_code, reason = "each test uses a part of it")]

use std::path::PathBuf;

use jrdb_perception::Detector;
use jrdb_types::detection::PERSON;
use jrdb_types::{Attributes, Detection, EntityId, FrameId, Image, PixelBox};
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;

const SEQUENCE: &str = "bytes-cafe-2019-02-07_0";

fn shared() -> PathBuf {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared");
    std::env::var_os("JRDB_SHARED").map_or_else(|| beside.into(), PathBuf::from)
}

/// A model of the shared folder.
pub(crate) fn model(file: &str) -> Option<Vec<u8>> {
    std::fs::read(shared().join("models").join(file)).ok()
}

pub(crate) struct Scene {
    pub(crate) image: Image,
    pub(crate) people: Vec<PixelBox>,
}

impl Scene {
    pub(crate) fn read() -> Option<Self> {
        let sample = shared().join("data/jrdb-sample");
        let picture = sample.join(format!("images/image_stitched/{SEQUENCE}/000000.jpg"));
        let mut decoder = JpegDecoder::new(ZCursor::new(std::fs::read(picture).ok()?));
        let rgb = decoder.decode().unwrap();
        let (width, height) = decoder.dimensions().unwrap();
        let labels = sample.join(format!("labels/{SEQUENCE}.track_3dbb_2dbb.csv"));
        let people = std::fs::read_to_string(labels).ok()?.lines().filter_map(person).collect();
        Some(Self { image: Image { width, height, rgb }, people })
    }

    /// The same scene with the seam elsewhere.
    pub(crate) fn turn(&mut self, columns: usize) {
        let width = self.image.width;
        let rows = self.image.rgb.chunks_exact_mut(3 * width);
        rows.for_each(|row| row.rotate_right(3 * columns));
        for person in &mut self.people {
            let moved = PixelBox { x: person.x + columns as f64, ..*person };
            *person = moved.wrapped(width as f64);
        }
    }

    /// Everything that the detector sees.
    pub(crate) fn see(&self, detector: &dyn Detector) -> Vec<Detection> {
        let frame = FrameId { sequence: SEQUENCE.into(), frame: 0 };
        detector.detect(&self.image, &frame).unwrap().detections
    }

    /// The people that the detector sees.
    pub(crate) fn people_by(&self, detector: &dyn Detector) -> Vec<Detection> {
        self.see(detector).into_iter().filter(|d| d.category == PERSON).collect()
    }

    /// For each detection, most confident first, whether it shows a person not shown before.
    pub(crate) fn judge(&self, detections: &[Detection]) -> Vec<bool> {
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
    pub(crate) fn ap50(&self, detections: &[Detection]) -> f64 {
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

/// A person in this box.
pub(crate) fn person_at(bbox: PixelBox) -> Detection {
    Detection {
        camera: None,
        id: EntityId::new(PERSON, 1),
        category: PERSON.into(),
        score: 1.0,
        bbox,
        attributes: Attributes::default(),
        interactions: Vec::new(),
        group: None,
        occlusion: None,
        heading_rad: None,
        box3d: None,
    }
}

/// The largest difference of two lists of the same detections: pixels, score.
pub(crate) fn difference(a: &[Detection], b: &[Detection]) -> (f64, f64) {
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
