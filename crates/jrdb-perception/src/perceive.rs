//! Perception as the pipeline uses it: one image in, detections with attributes out.

use std::collections::BTreeMap;
use std::sync::Arc;

use jrdb_types::detection::{PERSON, occurring};
use jrdb_types::issue::IssueKind;
use jrdb_types::{
    Attributes, Capabilities, Detection, Detections, FrameId, Image, ImageGeometry, Issue,
    Vocabulary, with_causes,
};
use rayon::prelude::*;

use crate::detector::{AttributeModel, Detector, Grounder, PerceptionError};
use crate::phrase::PhraseModel;
use crate::view::View;

/// A source of detections: labels, files, recorded replies or models.
pub trait Perceive: Send + Sync {
    /// The people and objects of one frame.
    ///
    /// # Errors
    /// When a model fails, or the source cannot be used for this frame. A frame that the source
    /// does not know yields no detections and an issue.
    fn perceive(&self, frame: &FrameId, view: &View<'_>) -> Result<Detections, PerceptionError>;

    /// Whether pixels are needed: otherwise images need not be decoded.
    fn looks_at_images(&self) -> bool;

    /// Whether an id is the same person or object in every frame of a sequence.
    fn tracks(&self) -> bool;

    /// What can be seen in a frame, where its detections do not state it.
    fn capabilities(&self) -> Capabilities;

    /// Every setting that shapes the detections, for the artefact's `config`.
    fn config(&self) -> serde_json::Value;

    /// The model that takes whole sentences, if any.
    fn grounder(&self) -> Option<&dyn Grounder>;

    /// The model that describes people, if any. It can describe a crop again later.
    fn attribute_model(&self) -> Option<&dyn AttributeModel>;

    /// The model that judges phrases about a detection, if any.
    fn phrase_model(&self) -> Option<&dyn PhraseModel>;
}

/// No detections, with the reason as an issue: nothing was seen, so nothing is known to be absent.
#[must_use]
pub fn nothing_seen(frame: &FrameId, image: ImageGeometry, why: String) -> Detections {
    Detections {
        capabilities: Some(Capabilities::none()),
        issues: vec![Issue::new(IssueKind::MissingInput, why)],
        ..Detections::new(frame.clone(), image, Vec::new())
    }
}

/// Detections that are known beforehand, by frame.
#[derive(Debug, Clone, Default)]
pub struct KnownDetections {
    frames: BTreeMap<FrameId, Detections>,
    capabilities: Capabilities,
    config: serde_json::Value,
}

impl KnownDetections {
    /// These detections. Of two for one frame the last counts. Those that do not state what their source can see are
    /// taken to see what occurs in any of them.
    #[must_use]
    pub fn new(detections: impl IntoIterator<Item = Detections>) -> Self {
        let frames: BTreeMap<FrameId, Detections> =
            detections.into_iter().map(|one| (one.frame.clone(), one)).collect();
        let unstated = frames.values().filter(|one| one.capabilities.is_none());
        let capabilities = occurring(unstated.flat_map(|one| &one.detections));
        Self { frames, capabilities, config: serde_json::json!({ "perception": "file" }) }
    }
}

impl Perceive for KnownDetections {
    fn perceive(&self, frame: &FrameId, view: &View<'_>) -> Result<Detections, PerceptionError> {
        let found = self.frames.get(frame).cloned();
        let nothing =
            || nothing_seen(frame, view.geometry, format!("the file has nothing for {frame}"));
        Ok(found.unwrap_or_else(nothing))
    }

    fn looks_at_images(&self) -> bool {
        false
    }

    fn tracks(&self) -> bool {
        false
    }

    fn capabilities(&self) -> Capabilities {
        self.capabilities.clone()
    }

    fn config(&self) -> serde_json::Value {
        self.config.clone()
    }

    fn grounder(&self) -> Option<&dyn Grounder> {
        None
    }

    fn attribute_model(&self) -> Option<&dyn AttributeModel> {
        None
    }

    fn phrase_model(&self) -> Option<&dyn PhraseModel> {
        None
    }
}

/// Neural perception: a detector, and a model that describes the people it finds.
#[derive(Clone)]
pub struct Models {
    /// Finds people and objects.
    pub detector: Arc<dyn Detector>,
    /// Describes people.
    pub attributes: Option<Arc<dyn AttributeModel>>,
    /// Takes whole sentences.
    pub grounder: Option<Arc<dyn Grounder>>,
    /// Judges phrases.
    pub phrases: Option<Arc<dyn PhraseModel>>,
    /// The classes that the detector was trained for, where it does not know them itself.
    pub categories: Option<Vocabulary<String>>,
    /// Every setting that shapes the detections.
    pub config: serde_json::Value,
}

impl Perceive for Models {
    fn perceive(&self, frame: &FrameId, view: &View<'_>) -> Result<Detections, PerceptionError> {
        let image = match view.pixels() {
            Ok(image) => image,
            Err(issue) => return Ok(nothing_seen(frame, view.geometry, issue.message)),
        };
        let mut detections = self.detector.detect(image, frame)?;
        if let Some(model) = &self.attributes {
            describe(&mut detections, image, &**model);
        }
        Ok(detections)
    }

    fn looks_at_images(&self) -> bool {
        true
    }

    fn tracks(&self) -> bool {
        false
    }

    fn capabilities(&self) -> Capabilities {
        let attributes = self.attributes.iter().flat_map(|model| model.attributes());
        Capabilities {
            categories: self.categories.clone().unwrap_or_else(|| self.detector.categories()),
            attributes: attributes.collect(),
            ..Capabilities::none()
        }
    }

    fn config(&self) -> serde_json::Value {
        self.config.clone()
    }

    fn grounder(&self) -> Option<&dyn Grounder> {
        self.grounder.as_deref()
    }

    fn attribute_model(&self) -> Option<&dyn AttributeModel> {
        self.attributes.as_deref()
    }

    fn phrase_model(&self) -> Option<&dyn PhraseModel> {
        self.phrases.as_deref()
    }
}

/// Adds the attributes of every person. If the model fails on a person, the attributes stay unknown
/// and an issue reports the error.
fn describe(detections: &mut Detections, image: &Image, model: &dyn AttributeModel) {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_that_is_not_known_has_nothing_and_an_issue() {
        let geometry = ImageGeometry { width_px: 100, height_px: 50, wraps: true };
        let known = |frame: u32| FrameId { sequence: "lab".into(), frame };
        let given = Detections::new(known(3), geometry, Vec::new());
        let source = KnownDetections::new([given.clone()]);
        let view = View { geometry, image: None };
        assert_eq!(source.perceive(&known(3), &view).unwrap(), given);
        let nothing = source.perceive(&known(4), &view).unwrap();
        assert_eq!(nothing.issues[0].message, "the file has nothing for lab/000004");
    }
}
