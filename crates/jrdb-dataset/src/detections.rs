//! Detections that another program made: our own artefact, or COCO.

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::path::Path;

use jrdb_types::{
    Artefact, Attributes, Detection, Detections, EntityId, FrameId, ImageGeometry, Issue,
    IssueKind, PixelBox,
};
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::value::RawValue;

use crate::{Error, boxes, file};

/// The category of people where a COCO file lists no categories.
const COCO_PERSON: u64 = 1;

const EXPECTED: &str =
    "a jrdb.detections artefact, a list of them, COCO results, or a COCO dataset";

/// Which keys a JSON object has, to tell the formats apart.
#[derive(Deserialize)]
struct Probe {
    schema: Option<IgnoredAny>,
    annotations: Option<IgnoredAny>,
    image_id: Option<IgnoredAny>,
}

/// An entry of COCO results, or an annotation of a COCO dataset.
#[derive(Deserialize)]
struct Annotation {
    image_id: ImageKey,
    category_id: u64,
    bbox: Option<[f64; 4]>,
    score: Option<f64>,
}

/// How COCO files name an image.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(untagged)]
enum ImageKey {
    Number(u64),
    Name(String),
}

impl ImageKey {
    fn frame(&self) -> Option<u32> {
        match self {
            Self::Number(number) => u32::try_from(*number).ok(),
            Self::Name(name) => file::frame_number(name),
        }
    }
}

#[derive(Deserialize)]
struct CocoFile {
    #[serde(default)]
    images: Vec<ImageEntry>,
    annotations: Vec<Annotation>,
    #[serde(default)]
    categories: Vec<CategoryEntry>,
}

#[derive(Deserialize)]
struct ImageEntry {
    id: ImageKey,
    file_name: Option<String>,
}

#[derive(Deserialize)]
struct CategoryEntry {
    id: u64,
    name: String,
}

/// Reads the detections of a sequence by frame, from any of four kinds of JSON file.
///
/// * One `jrdb.detections` artefact, or a list of them, one for each frame. Those of other sequences are
///   passed over; the image size must be the one given.
/// * COCO results, `[{"image_id", "category_id", "bbox", "score"}]`: `image_id` is the frame's number,
///   or a file name with an integer stem.
/// * A COCO dataset, `{"images", "annotations", "categories"}`: the integer stem of `file_name` is the
///   frame's number. Where some file names lie in a folder named like the sequence, only those count.
///   Images without annotations are frames without detections.
///
/// COCO category 1 is `person` and any other `category_<id>` unless `categories` names them. Ids are
/// given per frame and class from left to right, `person:1`, `person:2` and so on. A missing score is 1.
/// Boxes that are missing, lie outside the image or have no area are issues of their frame.
///
/// # Errors
/// [`Error::Read`], [`Error::Json`], [`Error::Artefact`], or [`Error::Content`] for another kind of file,
/// an image without a frame number, or a score outside `[0, 1]`.
pub fn read_detections(
    path: &Path,
    sequence: &str,
    image: ImageGeometry,
) -> Result<BTreeMap<u32, Detections>, Error> {
    let text = file::read_text(path)?;
    let source = Source { path, sequence, image };
    if text.trim_start().starts_with('[') {
        let entries: Vec<&RawValue> = source.json(&text)?;
        let Some(first) = entries.first() else { return Ok(BTreeMap::new()) };
        let probe: Probe = source.json(first.get())?;
        if probe.schema.is_some() {
            return source.artefacts(entries.iter().map(|entry| entry.get()));
        } else if probe.image_id.is_some() {
            let annotations = source.json(&text)?;
            return source.coco(CocoFile { images: vec![], annotations, categories: vec![] });
        }
    } else {
        let probe: Probe = source.json(&text)?;
        if probe.schema.is_some() {
            return source.artefacts([text.as_str()]);
        } else if probe.annotations.is_some() {
            return source.coco(source.json(&text)?);
        }
    }
    Err(Error::content(path, EXPECTED, "JSON with other keys"))
}

/// The file, and what its detections are for.
#[derive(Clone, Copy)]
struct Source<'a> {
    path: &'a Path,
    sequence: &'a str,
    image: ImageGeometry,
}

impl Source<'_> {
    fn json<'t, T: Deserialize<'t>>(&self, text: &'t str) -> Result<T, Error> {
        serde_json::from_str(text).map_err(|source| Error::Json {
            expected: EXPECTED,
            path: self.path.into(),
            source,
        })
    }

    fn content(&self, expected: impl Into<String>, found: impl Into<String>) -> Error {
        Error::content(self.path, expected, found)
    }

    fn artefacts<'t>(
        &self,
        texts: impl IntoIterator<Item = &'t str>,
    ) -> Result<BTreeMap<u32, Detections>, Error> {
        let mut frames = BTreeMap::new();
        for text in texts {
            let artefact = Artefact::<Detections>::from_json(text)
                .map_err(|source| Error::Artefact { path: self.path.into(), source })?;
            if artefact.data.frame.sequence != self.sequence {
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
            let expected = format!("detections of sequence {:?}", self.sequence);
            return Err(self.content(expected, "only other sequences"));
        }
        Ok(frames)
    }

    /// The detections sorted, without unusable boxes.
    fn checked(&self, mut found: Detections) -> Result<Detections, Error> {
        if found.image != self.image {
            let (expected, found) = (format!("{:?}", self.image), format!("{:?}", found.image));
            return Err(self.content(expected, found));
        }
        let issues = &mut found.issues;
        found.detections.retain_mut(|detection| {
            let checked = boxes::checked(detection.bbox, self.image);
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

    fn coco(&self, coco: CocoFile) -> Result<BTreeMap<u32, Detections>, Error> {
        let frames = self.frames_of_images(&coco.images)?;
        let mut found: BTreeMap<u32, Vec<(usize, Annotation)>> =
            frames.values().flatten().map(|&frame| (frame, Vec::new())).collect();
        for (index, annotation) in coco.annotations.into_iter().enumerate() {
            if let Some(frame) = self.frame(&annotation.image_id, &frames)? {
                self.check_score(index, annotation.score)?;
                found.entry(frame).or_default().push((index, annotation));
            }
        }
        let names = coco.categories.into_iter().map(|entry| (entry.id, entry.name)).collect();
        Ok(found
            .into_iter()
            .map(|(frame, list)| (frame, self.frame_of(frame, list, &names)))
            .collect())
    }

    /// Each image's frame; none where the image is of another sequence.
    fn frames_of_images(
        &self,
        images: &[ImageEntry],
    ) -> Result<BTreeMap<ImageKey, Option<u32>>, Error> {
        let ours = |image: &ImageEntry| {
            let folders = image.file_name.iter().flat_map(|name| Path::new(name).components());
            folders.into_iter().any(|folder| folder.as_os_str() == self.sequence)
        };
        let named = images.iter().any(ours);
        let (mut frames, mut seen) = (BTreeMap::new(), BTreeMap::new());
        for image in images {
            if named && !ours(image) {
                frames.insert(image.id.clone(), None);
                continue;
            }
            let frame = match &image.file_name {
                Some(name) => file::frame_number(name),
                None => image.id.frame(),
            };
            let Some(frame) = frame else {
                let found = format!("{:?} as {:?}", image.file_name, image.id);
                return Err(self.content("images with a frame number as stem", found));
            };
            if let Some(other) = seen.insert(frame, &image.id) {
                let found = format!("{other:?} and {:?} for frame {frame}", image.id);
                return Err(self.content("one image for each frame", found));
            }
            frames.insert(image.id.clone(), Some(frame));
        }
        Ok(frames)
    }

    fn frame(
        &self,
        key: &ImageKey,
        frames: &BTreeMap<ImageKey, Option<u32>>,
    ) -> Result<Option<u32>, Error> {
        let known =
            if frames.is_empty() { key.frame().map(Some) } else { frames.get(key).copied() };
        known.ok_or_else(|| {
            let expected = if frames.is_empty() {
                "a frame number as image_id"
            } else {
                "an image_id of `images`"
            };
            self.content(expected, format!("{key:?}"))
        })
    }

    fn check_score(&self, index: usize, score: Option<f64>) -> Result<(), Error> {
        match score {
            Some(score) if !(0.0..=1.0).contains(&score) => {
                let expected = format!("a score in [0, 1] in annotation {index}");
                Err(self.content(expected, score.to_string()))
            }
            _ => Ok(()),
        }
    }

    fn frame_of(
        &self,
        frame: u32,
        annotations: Vec<(usize, Annotation)>,
        names: &BTreeMap<u64, String>,
    ) -> Detections {
        let (mut found, mut issues) = (Vec::new(), Vec::new());
        for (index, annotation) in annotations {
            let bbox = annotation.bbox.ok_or_else(|| String::from("no box"));
            match bbox.and_then(|numbers| boxes::checked(PixelBox::from(numbers), self.image)) {
                Ok(bbox) => found.push((bbox, annotation)),
                Err(message) => {
                    let message = format!("annotation {index}: {message}");
                    issues.push(Issue::new(IssueKind::BadBox, message));
                }
            }
        }
        found.sort_by(|(a, _), (b, _)| from_left(a, b)); // stable: equal boxes keep the file's order
        let mut numbers = BTreeMap::new();
        let mut detections: Vec<Detection> = found
            .into_iter()
            .map(|(bbox, annotation)| {
                let category = category(annotation.category_id, names);
                let number: &mut u32 = numbers.entry(category.clone()).or_default();
                *number += 1;
                detection(EntityId::new(&category, *number), bbox, annotation.score.unwrap_or(1.0))
            })
            .collect();
        detections.sort_by(|a, b| a.id.cmp(&b.id));
        let frame = FrameId { sequence: self.sequence.into(), frame };
        Detections { issues, ..Detections::new(frame, self.image, detections) }
    }
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

fn category(id: u64, names: &BTreeMap<u64, String>) -> String {
    match names.get(&id) {
        Some(name) => boxes::category_of_class(name),
        None if names.is_empty() && id == COCO_PERSON => boxes::category_of_class("person"),
        None => format!("category_{id}"),
    }
}

fn detection(id: EntityId, bbox: PixelBox, score: f64) -> Detection {
    Detection {
        camera: None,
        category: id.class.clone(),
        id,
        score,
        bbox,
        attributes: Attributes::default(),
        interactions: Vec::new(),
        group: None,
        occlusion: None,
        heading_rad: None,
        box3d: None,
    }
}
