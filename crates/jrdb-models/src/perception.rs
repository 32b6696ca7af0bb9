//! Every source of detections by its name.

use std::path::PathBuf;
use std::str::FromStr;

use jrdb_perception::{
    AttributeModel, Grounder, KnownDetections, Perceive, PerceptionError, PhraseModel, View,
};
use jrdb_types::{Capabilities, Detections, FrameId};

use crate::Error;
use crate::backbone::{self, Backbone};
use crate::labels::Labels;
use crate::options::PerceptionOptions;
use crate::replay::Replay;

/// Where detections come from.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum PerceptionSource {
    /// The dataset's own labels.
    #[default]
    Labels,
    /// A file of detections: our artefact or COCO results.
    File(PathBuf),
    /// A file with the replies of models that ran before or elsewhere.
    Replay(PathBuf),
    /// The backbone of this name.
    Backbone(String),
}

impl FromStr for PerceptionSource {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        match text.split_once(':') {
            None if text == "labels" => Ok(Self::Labels),
            Some(("file", path)) if !path.is_empty() => Ok(Self::File(path.into())),
            Some(("replay", path)) if !path.is_empty() => Ok(Self::Replay(path.into())),
            None if is_name(text) => Ok(Self::Backbone(text.into())),
            _ => Err(Error::UnknownSource { found: text.into(), known: backbone::built_in() }),
        }
    }
}

/// Whether a text can be the name of a file in the models folder.
fn is_name(text: &str) -> bool {
    let allowed = |c: char| c.is_ascii_alphanumeric() || "-_.+".contains(c);
    text.chars().all(allowed) && text.starts_with(|c: char| c.is_ascii_alphanumeric())
}

/// A source of detections, opened.
pub struct Perception {
    source: Box<dyn Perceive>,
    notes: Vec<String>,
}

impl Perception {
    /// Opens a source by its name: `labels`, `file:PATH`, `replay:PATH`, or that of a backbone such as `light`.
    ///
    /// # Errors
    /// When the name is not one of these, or a file, model or engine is unusable. Labels that cannot be read fail frame
    /// by frame.
    pub fn open(name: &str, options: &PerceptionOptions) -> Result<Self, Error> {
        Self::open_source(&name.parse()?, options)
    }

    /// Opens a source whose name was read already.
    ///
    /// # Errors
    /// As [`Perception::open`].
    pub fn open_source(
        source: &PerceptionSource,
        options: &PerceptionOptions,
    ) -> Result<Self, Error> {
        let silent = |source: Box<dyn Perceive>| Self { source, notes: Vec::new() };
        match source {
            PerceptionSource::Labels => {
                let sequences = options.sequences.iter();
                let sequences = sequences.map(|one| (one.dataset.as_ref(), one.name.as_str()));
                Ok(silent(Box::new(Labels::read(sequences))))
            }
            PerceptionSource::File(path) => {
                let mut all = Vec::new();
                for one in &options.sequences {
                    let found = jrdb_dataset::read_detections(path, &one.name, one.image)?;
                    all.extend(found.into_values());
                }
                Ok(silent(Box::new(KnownDetections::new(all))))
            }
            PerceptionSource::Replay(path) => Ok(silent(Box::new(Replay::read(path)?))),
            PerceptionSource::Backbone(name) => {
                let folder = &options.engine.models;
                let opened = Backbone::named(name, folder)?.open(name, options)?;
                Ok(Self { source: Box::new(opened.models), notes: opened.notes })
            }
        }
    }

    /// What the user should know: which models run, and on which engine.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.notes
    }
}

impl Perceive for Perception {
    fn perceive(&self, frame: &FrameId, view: &View<'_>) -> Result<Detections, PerceptionError> {
        self.source.perceive(frame, view)
    }

    fn looks_at_images(&self) -> bool {
        self.source.looks_at_images()
    }

    fn tracks(&self) -> bool {
        self.source.tracks()
    }

    fn capabilities(&self) -> Capabilities {
        self.source.capabilities()
    }

    fn config(&self) -> serde_json::Value {
        self.source.config()
    }

    fn grounder(&self) -> Option<&dyn Grounder> {
        self.source.grounder()
    }

    fn attribute_model(&self) -> Option<&dyn AttributeModel> {
        self.source.attribute_model()
    }

    fn phrase_model(&self) -> Option<&dyn PhraseModel> {
        self.source.phrase_model()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_sources_are_read() {
        let read = |text: &str| text.parse::<PerceptionSource>().ok();
        assert_eq!(read("labels"), Some(PerceptionSource::Labels));
        assert_eq!(read("file:a:b.json"), Some(PerceptionSource::File("a:b.json".into())));
        assert_eq!(read("light"), Some(PerceptionSource::Backbone("light".into())));
        assert_eq!((read("file:"), read("../eyes"), read("")), (None, None, None));
        let error = "../eyes".parse::<PerceptionSource>().unwrap_err().to_string();
        assert!(error.contains("expected labels, file:PATH"), "{error}");
    }
}
