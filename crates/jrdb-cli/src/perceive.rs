//! The perception stage as the command line names it: labels, a file, or a model.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use jrdb_dataset::SequenceLabels;
use jrdb_models::backbone::{self, Backbone, Opened};
use jrdb_models::light::{self, Demographics, SSDLITE_FILE};
use jrdb_models::loader::{EngineOptions, open_engine};
use jrdb_perception::exchange::{Exchange, play};
use jrdb_perception::{AttributeModel, Detector, SsdLite, SsdLiteConfig};
use jrdb_types::detection::PERSON;
use jrdb_types::issue::IssueKind;
use jrdb_types::{Attributes, Detection, Detections, Image, Issue};
use rayon::prelude::*;

use crate::Error;
use crate::source::{FrameSource, without_root};
use jrdb_pipeline::with_causes;

/// Where detections come from.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum PerceptionSource {
    /// The dataset's own labels.
    #[default]
    Labels,
    /// A file of detections: our artefact or COCO results.
    File(PathBuf),
    /// The SSDLite person detector on wrapped tiles.
    SsdLite,
    /// Small models without any hub: SSDLite and NanoDet, clothes, faces, and demographics if asked for.
    Light(Demographics),
    /// A file with the replies of models that ran before or elsewhere.
    Replay(PathBuf),
    /// The backbone of this name.
    Backbone(String),
}

impl FromStr for PerceptionSource {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once(':') {
            None if text == "labels" => Ok(Self::Labels),
            None if text == "ssdlite" => Ok(Self::SsdLite),
            None if text == "light" => Ok(Self::Light(Demographics::default())),
            Some(("file", path)) if !path.is_empty() => Ok(Self::File(path.into())),
            Some(("replay", path)) if !path.is_empty() => Ok(Self::Replay(path.into())),
            None if is_name(text) => Ok(Self::Backbone(text.into())),
            _ => Err(format!(
                "expected labels, file:PATH, replay:PATH, light, ssdlite or the name of a backbone ({}), found {text:?}",
                backbone::built_in().join(", ")
            )),
        }
    }
}

/// Whether a text can be the name of a file in the models folder.
fn is_name(text: &str) -> bool {
    let allowed = |c: char| c.is_ascii_alphanumeric() || "-_.+".contains(c);
    text.chars().all(allowed) && text.starts_with(|c: char| c.is_ascii_alphanumeric())
}

/// Perception, ready to run on frames.
pub struct Perceiver {
    kind: Kind,
    config: serde_json::Value,
    notes: Vec<String>,
}

enum Kind {
    Labels(BTreeMap<(PathBuf, String), Result<SequenceLabels, String>>),
    File(BTreeMap<String, BTreeMap<u32, Detections>>),
    Replay(Vec<Exchange>),
    Model(Box<dyn Detector + Send + Sync>, Option<Box<dyn AttributeModel + Send + Sync>>),
}

impl Perceiver {
    /// Reads label files or models once, for all frames.
    ///
    /// # Errors
    /// When a file of detections, a model or an engine is unusable. Labels are looked at frame by frame.
    pub fn open(
        source: &PerceptionSource,
        frames: &[FrameSource],
        models: &Path,
        engine: &EngineOptions,
    ) -> Result<Self, Error> {
        match source {
            PerceptionSource::Labels => Ok(Self::labels(frames)),
            PerceptionSource::File(path) => Self::file(path, frames),
            PerceptionSource::SsdLite => Self::ssdlite(models, engine),
            PerceptionSource::Light(demographics) => Self::light(models, engine, *demographics),
            PerceptionSource::Replay(path) => Self::replay(path),
            PerceptionSource::Backbone(name) => Self::backbone(name, models, engine),
        }
    }

    fn labels(frames: &[FrameSource]) -> Self {
        let mut labels = BTreeMap::new();
        for frame in frames {
            let root = frame.dataset.root();
            labels.entry((root.into(), frame.id.sequence.clone())).or_insert_with(|| {
                frame.dataset.labels(&frame.id.sequence).map_err(|error| without_root(&error, root))
            });
        }
        let config = serde_json::json!({ "perception": "labels" });
        Self { kind: Kind::Labels(labels), config, notes: Vec::new() }
    }

    fn file(path: &Path, frames: &[FrameSource]) -> Result<Self, Error> {
        let mut detections = BTreeMap::new();
        for frame in frames {
            let sequence = &frame.id.sequence;
            if !detections.contains_key(sequence) {
                let image = frame.robot.image;
                detections.insert(
                    sequence.clone(),
                    jrdb_dataset::read_detections(path, sequence, image)?,
                );
            }
        }
        let config = serde_json::json!({ "perception": "file" });
        Ok(Self { kind: Kind::File(detections), config, notes: Vec::new() })
    }

    fn ssdlite(models: &Path, options: &EngineOptions) -> Result<Self, Error> {
        let path = models.join(SSDLITE_FILE);
        let bytes = std::fs::read(&path).map_err(|source| Error::file("read", &path, source))?;
        let (engine, note) = open_engine(&bytes, &path, options)?;
        let detector = SsdLite::new(engine, SsdLiteConfig::default());
        let config = serde_json::json!({ "perception": "ssdlite", "ssdlite": detector.config() });
        Ok(Self { kind: Kind::Model(Box::new(detector), None), config, notes: vec![note] })
    }

    fn replay(path: &Path) -> Result<Self, Error> {
        let text =
            std::fs::read_to_string(path).map_err(|source| Error::file("read", path, source))?;
        let refused =
            |source| jrdb_models::Error::Model { path: path.into(), source: Box::new(source) };
        let kind = Kind::Replay(Exchange::read_lines(&text).map_err(refused)?);
        let config = serde_json::json!({ "perception": "replay" });
        Ok(Self { kind, config, notes: Vec::new() })
    }

    fn backbone(name: &str, models: &Path, options: &EngineOptions) -> Result<Self, Error> {
        Ok(Self::opened(Backbone::named(name, models)?.open(name, models, options)?))
    }

    fn opened(models: Opened) -> Self {
        let kind = Kind::Model(models.detector, models.attributes);
        Self { kind, config: models.config, notes: models.notes }
    }

    /// Whether ids are those of the labels, which questions name in their truth.
    #[must_use]
    pub fn knows_truth(&self) -> bool {
        self.tracks()
    }

    fn light(
        models: &Path,
        options: &EngineOptions,
        demographics: Demographics,
    ) -> Result<Self, Error> {
        Ok(Self::opened(light::open(models, options, demographics)?))
    }

    /// Whether an id is the same person or object in every frame of a sequence.
    #[must_use]
    pub fn tracks(&self) -> bool {
        matches!(self.kind, Kind::Labels(_))
    }

    /// What to write into the artefact's `config`.
    #[must_use]
    pub fn config(&self) -> &serde_json::Value {
        &self.config
    }

    /// What the user should know: which engine runs.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Detections of one frame. A panorama that is missing is among their issues.
    ///
    /// # Errors
    /// When the model fails or the sequence's labels cannot be read. A frame that is not in the file of
    /// detections, or has no picture for the model, has no detections and an issue.
    pub fn detect(
        &self,
        frame: &FrameSource,
        image: &Result<Image, Issue>,
    ) -> Result<Detections, Error> {
        let mut detections = self.look(frame, image.as_ref().ok())?;
        detections.issues.extend(image.as_ref().err().cloned());
        Ok(detections)
    }

    /// What the detector alone takes a sentence to mean.
    ///
    /// # Errors
    /// When there is no detector that takes sentences, or its model fails.
    pub(crate) fn ground(
        &self,
        frame: &FrameSource,
        image: &Image,
        sentence: &str,
    ) -> Result<Detections, Error> {
        let found = match &self.kind {
            Kind::Model(detector, _) => detector.ground(image, &frame.id, sentence)?,
            _ => None,
        };
        found.ok_or_else(no_sentences)
    }

    /// Whether there is a model at all that could be asked a sentence.
    ///
    /// # Errors
    /// When there is none.
    pub(crate) fn check_baseline(&self) -> Result<(), Error> {
        if matches!(self.kind, Kind::Model(..)) { Ok(()) } else { Err(no_sentences()) }
    }

    fn look(&self, frame: &FrameSource, image: Option<&Image>) -> Result<Detections, Error> {
        let geometry = frame.robot.image;
        let nothing = |message: String| Detections {
            frame: frame.id.clone(),
            image: geometry,
            detections: Vec::new(),
            issues: vec![Issue::new(IssueKind::MissingInput, message)],
        };
        match &self.kind {
            Kind::Labels(labels) => {
                match labels.get(&(frame.dataset.root().into(), frame.id.sequence.clone())) {
                    Some(Ok(labels)) => Ok(labels.detections(&frame.id, geometry)),
                    Some(Err(message)) => Err(Error::Labels(message.clone())),
                    None => Err(Error::Labels(format!("no labels were opened for {}", frame.id))),
                }
            }
            Kind::File(files) => {
                let found =
                    files.get(&frame.id.sequence).and_then(|frames| frames.get(&frame.id.frame));
                Ok(found
                    .cloned()
                    .unwrap_or_else(|| nothing(format!("the file has nothing for {}", frame.id))))
            }
            Kind::Replay(lines) => Ok(play(lines, &frame.id, geometry)),
            Kind::Model(detector, attributes) => match image {
                Some(image) => {
                    let mut detections = detector.detect(image, &frame.id)?;
                    if let Some(model) = attributes {
                        describe(&mut detections, image, &**model);
                    }
                    Ok(detections)
                }
                None => Ok(nothing("the model had no picture to look at".into())),
            },
        }
    }
}

fn no_sentences() -> Error {
    let can = "Florence-2, MM-Grounding-DINO or LLMDet";
    Error::Usage(format!("expected a detector that takes sentences for --baseline: {can}"))
}

/// Fills in what a model believes of every person. Somebody it fails on stays undescribed, and an issue says so.
fn describe(
    detections: &mut Detections,
    image: &Image,
    model: &(dyn AttributeModel + Send + Sync),
) {
    let look = |detection: &Detection| {
        let is_person = detection.category == PERSON;
        is_person.then(|| model.describe(image, detection))
    };
    let looks: Vec<Option<Result<Attributes, _>>> =
        detections.detections.par_iter().map(look).collect();
    for (detection, look) in detections.detections.iter_mut().zip(looks) {
        match look {
            Some(Ok(attributes)) => detection.attributes = attributes,
            Some(Err(error)) => {
                let message =
                    format!("nothing is known of its attributes: {}", with_causes(&error));
                let issue = Issue::about(IssueKind::NotDescribed, &detection.id, message);
                detections.issues.push(issue);
            }
            None => {}
        }
    }
}
