//! Where the frames of a label file are: a recording's labels are larger than its other data in memory, so that only what a frame
//! needs is read.

use std::cell::Cell;
use std::collections::BTreeMap;
use std::fmt;
use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::marker::PhantomData;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

use serde::Deserialize;
use serde::de::{DeserializeSeed, Deserializer, IgnoredAny, MapAccess, Visitor};

use super::raw::{Label, Trouble, objects};
use crate::{Error, file, json};

/// What a label file should be.
const EXPECTED: &str = "labels by frame, {\"labels\": {\"000000.jpg\": [..]}}";

/// A part of a file: from a byte on, so many.
type Span = (u64, u64);

/// A label file whose frames are known by their places in it.
#[derive(Debug, Clone)]
pub(super) struct LabelFile<T> {
    path: PathBuf,
    /// The text, where it is not what the file's bytes are: decoded, or with numbers that JSON has not.
    text: Option<Arc<str>>,
    /// The parts of each frame, by their keys: a frame may have several, such as `7.jpg` and `000007.jpg`.
    frames: BTreeMap<u32, BTreeMap<String, Span>>,
    labels: PhantomData<T>,
}

impl<T: Label> LabelFile<T> {
    /// Reads a file through once; a file that is not there has no frames.
    pub(super) fn open(path: &Path) -> Result<Self, Error> {
        let mut frames: BTreeMap<u32, BTreeMap<String, Span>> = BTreeMap::new();
        let mut text = None;
        if path.is_file() {
            let unreadable = |source| Error::Read { path: path.into(), source };
            let bytes = BufReader::new(File::open(path).map_err(unreadable)?);
            let wrong = |source| Error::Json { expected: EXPECTED, path: path.into(), source };
            let spans = match spans(bytes) {
                Ok(spans) => spans,
                Err(_) => {
                    let tolerant: Arc<str> = json::tolerant(&file::read_text(path)?).into();
                    let found = self::spans(tolerant.as_bytes()).map_err(wrong)?;
                    text = Some(tolerant);
                    found
                }
            };
            let first = spans.first().map(|(key, _)| format!("{key:?}"));
            for (key, span) in spans {
                if let Some(frame) = file::frame_number(&key) {
                    frames.entry(frame).or_default().insert(key, span);
                }
            }
            if let (true, Some(key)) = (frames.is_empty(), first) {
                let expected = "frames named by their numbers, such as 000012.jpg";
                return Err(Error::content(path, expected, key));
            }
        }
        Ok(Self { path: path.into(), text, frames, labels: PhantomData })
    }

    /// The numbers of the frames.
    pub(super) fn numbers(&self) -> impl Iterator<Item = u32> + '_ {
        self.frames.keys().copied()
    }

    /// Whether the file has no frame at all, or is not there.
    pub(super) fn is_absent(&self) -> bool {
        self.frames.is_empty()
    }

    /// Whether the file has a frame.
    pub(super) fn has(&self, frame: u32) -> bool {
        self.frames.contains_key(&frame)
    }

    /// The objects of a frame; those that could not be read say why.
    pub(super) fn of_frame(&self, frame: u32) -> Vec<Result<T, Trouble>> {
        let parts = self.frames.get(&frame).into_iter().flat_map(BTreeMap::values);
        let read = |span: &Span| match self.text(*span) {
            Ok(text) => objects(&text),
            Err(error) => vec![Err(Trouble { subject: None, message: error.to_string() })],
        };
        parts.flat_map(read).collect()
    }

    fn text(&self, (start, length): Span) -> std::io::Result<String> {
        let mut text = String::new();
        if let Some(whole) = &self.text {
            let (start, length) = (start as usize, length as usize);
            text.push_str(whole.get(start..start + length).unwrap_or_default());
        } else {
            let mut file = File::open(&self.path)?;
            file.seek(SeekFrom::Start(start))?;
            file.take(length).read_to_string(&mut text)?;
        }
        // Behind a value that is not a list, what ends it was read, too.
        Ok(text.trim().trim_end_matches([',', '}']).to_string())
    }
}

/// The key and the part of every frame of a label file, in its order.
fn spans(bytes: impl Read) -> Result<Vec<(String, Span)>, serde_json::Error> {
    let position = Rc::new(Cell::new(0));
    let counted = Counted { bytes, position: Rc::clone(&position) };
    let mut deserializer = serde_json::Deserializer::from_reader(counted);
    let labels = deserializer.deserialize_map(FileVisitor(&position))?;
    deserializer.end()?;
    labels.ok_or_else(|| serde::de::Error::missing_field("labels"))
}

/// Counts the bytes that are read.
struct Counted<R> {
    bytes: R,
    position: Rc<Cell<u64>>,
}

impl<R: Read> Read for Counted<R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let count = self.bytes.read(buffer)?;
        self.position.set(self.position.get() + count as u64);
        Ok(count)
    }
}

/// The whole file: an object with `labels`.
struct FileVisitor<'p>(&'p Cell<u64>);

impl<'de> Visitor<'de> for FileVisitor<'_> {
    type Value = Option<Vec<(String, Span)>>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object with labels")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let mut labels = None;
        while let Some(key) = map.next_key::<String>()? {
            if key == "labels" {
                labels = Some(map.next_value_seed(FramesSeed(self.0))?);
            } else {
                map.next_value::<IgnoredAny>()?;
            }
        }
        Ok(labels)
    }
}

/// The object of the frames.
struct FramesSeed<'p>(&'p Cell<u64>);

impl<'de> DeserializeSeed<'de> for FramesSeed<'_> {
    type Value = Vec<(String, Span)>;

    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<Self::Value, D::Error> {
        from.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for FramesSeed<'_> {
    type Value = Vec<(String, Span)>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object of frames")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let mut frames = Vec::new();
        while let Some(key) = map.next_key::<String>()? {
            let span = map.next_value_seed(SpanSeed(self.0))?;
            frames.push((key, span));
        }
        Ok(frames)
    }
}

/// The place of a value, which is passed over.
struct SpanSeed<'p>(&'p Cell<u64>);

impl<'de> DeserializeSeed<'de> for SpanSeed<'_> {
    type Value = Span;

    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<Span, D::Error> {
        // The reader reads no further than it has to: here the colon was its last byte.
        let start = self.0.get();
        IgnoredAny::deserialize(from)?;
        Ok((start, self.0.get() - start))
    }
}
