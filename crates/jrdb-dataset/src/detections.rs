//! Detections that another program made: our own artefact, COCO, or JRDB's own detections.

mod coco;
mod convention;
mod entry;
mod source;

use std::collections::BTreeMap;
use std::path::Path;

use jrdb_types::{Artefact, Detections, ImageGeometry, Issue, IssueKind};
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::value::RawValue;

use crate::{Error, boxes, file, json};
use entry::Target;
use source::{EXPECTED, Source};

/// Which keys a JSON object has, to tell the formats apart.
#[derive(Deserialize)]
struct Probe {
    schema: Option<IgnoredAny>,
    annotations: Option<IgnoredAny>,
    image_id: Option<IgnoredAny>,
    detections: Option<IgnoredAny>,
}

/// Reads the detections of a sequence by frame, from any of five kinds of JSON file.
///
/// * One `jrdb.detections` artefact, or a list of them, one for each frame. Those of other sequences are
///   passed over; the image size must be the one given.
/// * COCO results, `[{"image_id", "category_id", "bbox", "score"}]`: `image_id` is the frame's number,
///   or a file name with an integer stem.
/// * A COCO dataset, `{"images", "annotations", "categories"}`: the integer stem of `file_name` is the
///   frame's number. Where some file names lie in a folder named like the sequence, only those count.
///   Images without annotations are frames without detections.
/// * JRDB's `detections_2d_stitched/<sequence>.json`, `{"detections": {"000000.jpg": [{"box", "label_id", "score"}]}}`.
///
/// COCO category 1 is `person` and any other `category_<id>` unless `categories` names them; people may be called `Person`,
/// `pedestrian`, `people` or `human`. Ids are given per frame and class from left to right, `person:1`, `person:2` and so on. A
/// missing score is 1. Numbers may be written as texts or with parts (`1.0`).
///
/// An entry that cannot be used is an issue of its frame, and of every frame when it has none. Regions of many (`iscrowd`,
/// `ignore`) are left out. Boxes that all look like corners are read so. Boxes that are parts of the picture are left
/// out, and where nothing in the file can be a person, every frame says so.
///
/// # Errors
/// [`Error::Read`], [`Error::Json`], [`Error::Artefact`], or [`Error::Content`] for another kind of file,
/// a file without any entry that can be used, and two images for one frame.
pub fn read_detections(
    path: &Path,
    sequence: &str,
    image: ImageGeometry,
) -> Result<BTreeMap<u32, Detections>, Error> {
    let text = file::read_text(path)?;
    let text = json::tolerant(&text);
    let source = Source { path, target: Target { sequence, image } };
    if text.trim_start().starts_with('[') {
        let entries: Vec<&RawValue> = source.json(&text)?;
        let probes = || entries.iter().map(|entry| source.json::<Probe>(entry.get()));
        let Some(first) = probes().next() else { return Ok(BTreeMap::new()) };
        if first?.schema.is_some() {
            return source.artefacts(entries.iter().map(|entry| entry.get()));
        } else if probes().flatten().any(|probe| probe.image_id.is_some()) {
            return coco::results(&source, &entries);
        }
    } else {
        let probe: Probe = source.json(&text)?;
        if probe.schema.is_some() {
            return source.artefacts([&*text]);
        } else if probe.annotations.is_some() {
            return coco::dataset(&source, &text);
        } else if probe.detections.is_some() {
            return coco::jrdb(&source, &text);
        }
    }
    Err(source.content(EXPECTED, "JSON with other keys"))
}

impl Source<'_> {
    fn artefacts<'t>(
        &self,
        texts: impl IntoIterator<Item = &'t str>,
    ) -> Result<BTreeMap<u32, Detections>, Error> {
        let mut frames = BTreeMap::new();
        for text in texts {
            let artefact = Artefact::<Detections>::from_json(text)
                .map_err(|source| Error::Artefact { path: self.path.into(), source })?;
            if artefact.data.frame.sequence != self.target.sequence {
                continue;
            }
            let detections = self.checked(artefact.data)?;
            let frame = detections.frame.frame;
            if frames.insert(frame, detections).is_some() {
                let found = format!("two for frame {frame}");
                return Err(self.content("one artefact for each frame", found));
            }
        }
        if frames.is_empty() {
            let expected = format!("detections of sequence {:?}", self.target.sequence);
            return Err(self.content(expected, "only other sequences"));
        }
        Ok(frames)
    }

    /// The detections sorted, without unusable boxes.
    fn checked(&self, mut found: Detections) -> Result<Detections, Error> {
        if found.image != self.target.image {
            let (expected, found) =
                (format!("{:?}", self.target.image), format!("{:?}", found.image));
            return Err(self.content(expected, found));
        }
        for detection in &mut found.detections {
            detection.category = boxes::category_of_class(&detection.category);
        }
        let issues = &mut found.issues;
        found.detections.retain_mut(|detection| {
            let checked = boxes::checked(detection.bbox, self.target.image);
            match checked {
                Ok(bbox) => detection.bbox = bbox,
                Err(ref message) => {
                    issues.push(Issue::about(IssueKind::BadBox, &detection.id, message.as_str()));
                }
            }
            checked.is_ok()
        });
        found.detections.sort_by(|a, b| a.id.cmp(&b.id));
        if let Some(pair) = found.detections.windows(2).find(|pair| pair[0].id == pair[1].id) {
            let found = format!("{} twice in frame {}", pair[0].id, found.frame.frame);
            return Err(self.content("ids that differ", found));
        }
        Ok(found)
    }
}
