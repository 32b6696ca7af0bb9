//! One detection of a file, and the detections of a frame out of many.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use jrdb_types::{
    Detection, Detections, EntityId, FrameId, ImageGeometry, Issue, IssueKind, PixelBox,
};

use super::convention::{Convention, in_pixels};
use crate::boxes;

/// What detections are for.
#[derive(Clone, Copy)]
pub(super) struct Target<'a> {
    pub(super) sequence: &'a str,
    pub(super) image: ImageGeometry,
}

/// A detection as the file writes it.
pub(super) struct Entry {
    /// Its place in the file, from 0.
    pub(super) index: usize,
    pub(super) category: String,
    /// The four numbers of its box, whatever they mean.
    pub(super) numbers: [f64; 4],
    pub(super) score: f64,
}

/// What a file says of a frame.
#[derive(Default)]
pub(super) struct FrameEntries {
    pub(super) entries: Vec<Entry>,
    pub(super) issues: Vec<Issue>,
}

impl FrameEntries {
    pub(super) fn issue(&mut self, kind: IssueKind, message: String) {
        self.issues.push(Issue::new(kind, message));
    }
}

/// The detections of every frame. `common` are issues of them all.
pub(super) fn detections(
    frames: BTreeMap<u32, FrameEntries>,
    common: &[Issue],
    target: Target<'_>,
) -> BTreeMap<u32, Detections> {
    let boxes: Vec<[f64; 4]> =
        frames.values().flat_map(|frame| frame.entries.iter().map(|entry| entry.numbers)).collect();
    let convention = Convention::of(&boxes, target.image);
    let one = |(frame, mut entries): (u32, FrameEntries)| {
        entries.issues.extend_from_slice(common);
        if !entries.entries.is_empty() {
            entries.issues.extend(convention.issue());
        }
        (frame, of_frame(frame, entries, convention, target))
    };
    frames.into_iter().map(one).collect()
}

fn of_frame(
    frame: u32,
    FrameEntries { entries, mut issues }: FrameEntries,
    convention: Convention,
    target: Target<'_>,
) -> Detections {
    let mut found = Vec::new();
    for entry in entries {
        let Some(numbers) = in_pixels(entry.numbers, convention) else { continue };
        match boxes::checked(PixelBox::from(numbers), target.image) {
            Ok(bbox) => found.push((bbox, entry)),
            Err(message) => {
                let message = format!("annotation {}: {message}", entry.index);
                issues.push(Issue::new(IssueKind::BadBox, message));
            }
        }
    }
    found.sort_by(|(a, _), (b, _)| from_left(a, b)); // stable: equal boxes keep the file's order
    let mut numbers = BTreeMap::new();
    let mut detections: Vec<Detection> = found
        .into_iter()
        .map(|(bbox, entry)| {
            let number: &mut u32 = numbers.entry(entry.category.clone()).or_default();
            *number += 1;
            let id = EntityId::new(&entry.category, *number);
            Detection::new(id, entry.category, entry.score, bbox)
        })
        .collect();
    detections.sort_by(|a, b| a.id.cmp(&b.id));
    let is_fault = |issue: &&Issue| matches!(issue.kind, IssueKind::BadBox | IssueKind::BadLabel);
    let faults = issues.iter().filter(is_fault).count();
    if detections.is_empty() && faults > 0 {
        // Whom the detector saw is not known: nobody is not what it says.
        let message = format!("none of the frame's {faults} detections could be used");
        issues.push(Issue::new(IssueKind::MissingInput, message));
    }
    let frame = FrameId { sequence: target.sequence.into(), frame };
    Detections { issues, ..Detections::new(frame, target.image, detections) }
}

fn from_left(a: &PixelBox, b: &PixelBox) -> Ordering {
    let keys = |bbox: &PixelBox| <[f64; 4]>::from(*bbox);
    keys(a)
        .iter()
        .zip(keys(b))
        .map(|(a, b)| a.total_cmp(&b))
        .find(|order| order.is_ne())
        .unwrap_or(Ordering::Equal)
}
