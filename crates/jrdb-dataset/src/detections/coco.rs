//! COCO's results and datasets, and JRDB's own detections: one entry that cannot be used does not spoil the others.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use jrdb_types::{Capabilities, Detections, Issue, IssueKind};
use serde::Deserialize;
use serde_json::Value;
use serde_json::value::RawValue;

use super::entry::{Entry, FrameEntries, detections};
use super::source::Source;
use crate::number::Reals;
use crate::{Error, boxes, file};

/// The category of people where a COCO file lists no categories.
const COCO_PERSON: &str = "1";

/// How far a score may be outside of [0, 1] by rounding.
const MAX_ROUNDING: f64 = 1e-3;

/// Most names that a message lists.
const MAX_NAMES: usize = 8;

/// An entry of COCO results, or an annotation of a COCO dataset; anything may be anything.
#[derive(Deserialize)]
struct Annotation {
    image_id: Option<Value>,
    category_id: Option<Value>,
    bbox: Option<Value>,
    score: Option<Value>,
    #[serde(alias = "is_crowd")]
    iscrowd: Option<Value>,
    ignore: Option<Value>,
}

#[derive(Deserialize)]
struct Dataset<'t> {
    #[serde(default, borrow)]
    images: Vec<&'t RawValue>,
    #[serde(borrow)]
    annotations: Vec<&'t RawValue>,
    #[serde(default, borrow)]
    categories: Vec<&'t RawValue>,
}

#[derive(Deserialize)]
struct ImageEntry {
    id: Value,
    file_name: Option<String>,
}

#[derive(Deserialize)]
struct CategoryEntry {
    id: Value,
    name: String,
}

#[derive(Deserialize)]
struct JrdbFile<'t> {
    #[serde(borrow)]
    detections: BTreeMap<String, Vec<&'t RawValue>>,
}

#[derive(Deserialize)]
struct JrdbEntry {
    label_id: Option<String>,
    #[serde(rename = "box")]
    bbox: Option<Value>,
    score: Option<Value>,
}

/// COCO results: a list of annotations.
pub(super) fn results(
    source: &Source<'_>,
    entries: &[&RawValue],
) -> Result<BTreeMap<u32, Detections>, Error> {
    let categories = Categories::new(Vec::new());
    Annotations { source, images: None, categories }.read(entries)
}

/// A COCO dataset.
pub(super) fn dataset(source: &Source<'_>, text: &str) -> Result<BTreeMap<u32, Detections>, Error> {
    let Dataset { images, annotations, categories } = source.json(text)?;
    let images = images.iter().map(|image| source.json(image.get())).collect::<Result<_, _>>()?;
    let entry = |entry: &&RawValue| serde_json::from_str::<CategoryEntry>(entry.get()).ok();
    let categories = Categories::new(categories.iter().filter_map(entry).collect());
    let images =
        (!Vec::is_empty(&images)).then(|| frames_of_images(source, &images)).transpose()?;
    Annotations { source, images, categories }.read(&annotations)
}

/// JRDB's own detections.
pub(super) fn jrdb(source: &Source<'_>, text: &str) -> Result<BTreeMap<u32, Detections>, Error> {
    let JrdbFile { detections: frames } = source.json(text)?;
    let mut found: BTreeMap<u32, FrameEntries> = BTreeMap::new();
    for (key, entries) in &frames {
        let number = file::frame_number(key);
        let frame = number.ok_or_else(|| {
            source.content("frames named like 000000.jpg in `detections`", format!("{key:?}"))
        })?;
        let frame = found.entry(frame).or_default();
        for (index, entry) in entries.iter().enumerate() {
            match jrdb_entry(index, entry.get()) {
                Ok(entry) => frame.entries.push(entry),
                Err((kind, message)) => {
                    frame.issue(kind, format!("detection {index}: {message}"));
                }
            }
        }
    }
    Ok(detections(found, &[], source.target))
}

/// What is wrong with an entry.
type Fault = (IssueKind, String);

fn jrdb_entry(index: usize, text: &str) -> Result<Entry, Fault> {
    let entry: JrdbEntry =
        serde_json::from_str(text).map_err(|error| (IssueKind::BadLabel, error.to_string()))?;
    let label = entry.label_id.unwrap_or_else(|| jrdb_types::detection::PERSON.into());
    let class = label.split(':').next().unwrap_or_default();
    Ok(Entry {
        index,
        category: boxes::category_of_class(class),
        numbers: box_numbers(entry.bbox.as_ref())?,
        score: score(entry.score.as_ref())?,
    })
}

/// A number or a name as files write it: `7`, `7.0` and `"7"` are the same.
fn key(value: &Value) -> Option<String> {
    match value {
        Value::Number(number) => {
            let whole = number.as_f64().filter(|n| n.fract() == 0.0 && n.abs() < 1e15);
            let exact = number.as_u64().map(|n| n.to_string());
            exact.or_else(|| whole.map(|n| format!("{n}")))
        }
        Value::String(text) => {
            let text = text.trim();
            let whole = text.parse::<f64>().ok().filter(|n| n.fract() == 0.0 && n.abs() < 1e15);
            let is_plain = text.bytes().all(|b| b.is_ascii_digit() || b == b'.');
            whole.filter(|_| is_plain).map_or_else(|| Some(text.into()), |n| Some(format!("{n}")))
        }
        _ => None,
    }
}

/// The frame that an `image_id` names by itself.
fn frame_of_key(key: &str) -> Option<u32> {
    key.parse().ok().or_else(|| file::frame_number(key))
}

fn number(value: &Value) -> Option<f64> {
    match Reals::deserialize(value).ok()?.0[..] {
        [number] => Some(number),
        _ => None,
    }
}

fn box_numbers(value: Option<&Value>) -> Result<[f64; 4], Fault> {
    let bad = |message: String| (IssueKind::BadBox, message);
    let value = value.filter(|value| !value.is_null()).ok_or_else(|| bad("no box".into()))?;
    let numbers = Reals::deserialize(value).map(|reals| reals.0).unwrap_or_default();
    let found = || format!("expected 4 numbers as box, found {value}");
    <[f64; 4]>::try_from(numbers).map_err(|_| bad(found()))
}

fn score(value: Option<&Value>) -> Result<f64, Fault> {
    let Some(value) = value.filter(|value| !value.is_null()) else { return Ok(1.0) };
    let near = -MAX_ROUNDING..=1.0 + MAX_ROUNDING;
    let score = number(value).filter(|score| near.contains(score));
    let bad = || (IssueKind::BadLabel, format!("expected a score in [0, 1], found {value}"));
    score.map(|score| score.clamp(0.0, 1.0)).ok_or_else(bad)
}

/// Whether a mark is set: 1, true or their texts.
fn is_set(mark: Option<&Value>) -> bool {
    match mark {
        Some(Value::Bool(is_set)) => *is_set,
        Some(Value::String(text)) if text.eq_ignore_ascii_case("true") => true,
        Some(value) => number(value).is_some_and(|number| number != 0.0),
        None => false,
    }
}

/// Each image's frame by its key; none where the image is of another sequence.
type Images = BTreeMap<String, Option<u32>>;

fn frames_of_images(source: &Source<'_>, images: &[ImageEntry]) -> Result<Images, Error> {
    let ours = |image: &ImageEntry| {
        let folders = image.file_name.iter().flat_map(|name| Path::new(name).components());
        folders.into_iter().any(|folder| folder.as_os_str() == source.target.sequence)
    };
    let named = images.iter().any(ours);
    let (mut frames, mut seen) = (BTreeMap::new(), BTreeMap::new());
    for image in images {
        let id = key(&image.id).unwrap_or_else(|| image.id.to_string());
        if named && !ours(image) {
            frames.insert(id, None);
            continue;
        }
        let frame = match &image.file_name {
            Some(name) => file::frame_number(name),
            None => frame_of_key(&id),
        };
        let Some(frame) = frame else {
            let found = format!("{:?} as {id}", image.file_name);
            return Err(source.content("images with a frame number as stem", found));
        };
        if let Some(other) = seen.insert(frame, id.clone()) {
            let found = format!("{other} and {id} for frame {frame}");
            return Err(source.content("one image for each frame", found));
        }
        frames.insert(id, Some(frame));
    }
    Ok(frames)
}

/// The names of categories by their keys.
struct Categories {
    names: BTreeMap<String, String>,
}

impl Categories {
    fn new(entries: Vec<CategoryEntry>) -> Self {
        let name = |entry: CategoryEntry| Some((key(&entry.id)?, entry.name));
        Self { names: entries.into_iter().filter_map(name).collect() }
    }

    /// The category that a key stands for, where the file's keys may count from 0.
    fn of(&self, key: &str, count_from_zero: bool) -> String {
        let is_name = key.parse::<f64>().is_err();
        match self.names.get(key) {
            Some(name) => boxes::category_of_class(name),
            None if is_name => boxes::category_of_class(key),
            None if self.names.is_empty() && key == COCO_PERSON && !count_from_zero => {
                boxes::category_of_class("person")
            }
            None => format!("category_{key}"),
        }
    }

    /// What the source of the file can see: its categories; unstated where it lists none.
    fn capabilities(&self) -> Option<Capabilities> {
        let names = self.names.values().map(|name| boxes::category_of_class(name));
        let seen = Capabilities { categories: names.collect(), ..Capabilities::none() };
        (!self.names.is_empty()).then_some(seen)
    }

    /// What to tell when nothing in a file can be a person: the categories that there are.
    fn nobody(&self, used: &BTreeSet<String>, count_from_zero: bool) -> Option<Issue> {
        let person = boxes::category_of_class("person");
        let is_person = |key: &String| self.of(key, count_from_zero) == person;
        if used.is_empty() || used.iter().any(is_person) || self.names.keys().any(is_person) {
            return None;
        }
        let name = |key: &String| match self.names.get(key) {
            Some(name) => format!("{name:?}"),
            None => key.clone(),
        };
        let known: Vec<String> = used.iter().take(MAX_NAMES).map(name).collect();
        let known = known.join(", ");
        let message = if !self.names.is_empty() {
            format!("no category of the file is called person: there are the categories {known}")
        } else if count_from_zero {
            format!(
                "the file's categories count from 0, COCO's from 1, and none is known to be a person: there are the \
                 categories {known}; name them in `categories`"
            )
        } else {
            format!(
                "no category_id of the file is {COCO_PERSON}, a person: there are the categories {known}; name \
                 them in `categories`"
            )
        };
        Some(Issue::new(IssueKind::MissingInput, message))
    }
}

/// How annotations are read.
struct Annotations<'a> {
    source: &'a Source<'a>,
    images: Option<Images>,
    categories: Categories,
}

impl Annotations<'_> {
    fn read(&self, texts: &[&RawValue]) -> Result<BTreeMap<u32, Detections>, Error> {
        let parse = |text: &&RawValue| serde_json::from_str::<Annotation>(text.get());
        let parsed: Vec<Result<Annotation, serde_json::Error>> = texts.iter().map(parse).collect();
        let keys = parsed.iter().flatten().filter_map(|one| key(one.category_id.as_ref()?));
        let used: BTreeSet<String> = keys.collect();
        let count_from_zero = self.categories.names.is_empty() && used.contains("0");
        let known = self.images.iter().flat_map(BTreeMap::values).flatten();
        let mut frames: BTreeMap<u32, FrameEntries> =
            known.map(|frame| (*frame, FrameEntries::default())).collect();
        let mut orphans = Vec::new();
        for (index, annotation) in parsed.into_iter().enumerate() {
            let frame = match &annotation {
                Ok(annotation) => self.frame(annotation.image_id.as_ref()),
                Err(error) => Err(error.to_string()),
            };
            match (frame, annotation) {
                (Ok(Some(frame)), Ok(annotation)) => {
                    let frame = frames.entry(frame).or_default();
                    self.put(index, &annotation, count_from_zero, frame);
                }
                (Ok(_), _) => {}
                (Err(message), _) => orphans.push(format!("annotation {index}: {message}")),
            }
        }
        if let (true, Some(first)) = (frames.is_empty(), orphans.first()) {
            return Err(self.source.content("annotations of frames", first.as_str()));
        }
        let orphans = (!orphans.is_empty()).then(|| Self::orphans(&orphans));
        let nobody = self.categories.nobody(&used, count_from_zero);
        let common: Vec<Issue> = orphans.into_iter().chain(nobody).collect();
        let mut found = detections(frames, &common, self.source.target);
        for frame in found.values_mut() {
            frame.capabilities = self.categories.capabilities();
        }
        Ok(found)
    }

    fn orphans(orphans: &[String]) -> Issue {
        let more = match orphans.len() - 1 {
            0 => String::new(),
            count => format!(" (and {count} more annotations without a frame)"),
        };
        Issue::new(IssueKind::DoubtfulInput, format!("{}{more}", orphans[0]))
    }

    /// The frame of an annotation; none where it is of another sequence.
    fn frame(&self, id: Option<&Value>) -> Result<Option<u32>, String> {
        let found = || id.map_or("none".into(), Value::to_string);
        let key = id.and_then(key);
        match (&self.images, &key) {
            (Some(images), Some(key)) => {
                let known = images.get(key).copied();
                known.ok_or_else(|| format!("expected an image_id of `images`, found {}", found()))
            }
            (None, Some(key)) => {
                let frame = frame_of_key(key).map(Some);
                frame.ok_or_else(|| {
                    format!("expected a frame number as image_id, found {}", found())
                })
            }
            (_, None) => Err(format!("expected an image_id, found {}", found())),
        }
    }

    fn put(
        &self,
        index: usize,
        annotation: &Annotation,
        count_from_zero: bool,
        frame: &mut FrameEntries,
    ) {
        let place = |message: &str| format!("annotation {index}: {message}");
        if is_set(annotation.iscrowd.as_ref()) || is_set(annotation.ignore.as_ref()) {
            let message = place("a region of many (iscrowd or ignore), left out");
            return frame.issue(IssueKind::DoubtfulInput, message);
        }
        match self.entry(index, annotation, count_from_zero) {
            Ok(entry) => frame.entries.push(entry),
            Err((kind, message)) => frame.issue(kind, place(&message)),
        }
    }

    fn entry(
        &self,
        index: usize,
        annotation: &Annotation,
        count_from_zero: bool,
    ) -> Result<Entry, Fault> {
        let numbers = box_numbers(annotation.bbox.as_ref())?;
        let category = annotation.category_id.as_ref().and_then(key).ok_or_else(|| {
            let found = annotation.category_id.as_ref().map_or("none".into(), Value::to_string);
            (IssueKind::BadLabel, format!("expected a category_id, found {found}"))
        })?;
        Ok(Entry {
            index,
            category: self.categories.of(&category, count_from_zero),
            numbers,
            score: score(annotation.score.as_ref())?,
        })
    }
}
