//! Perception from a dataset's own labels.

use std::collections::BTreeMap;

use jrdb_dataset::{Dataset, SequenceLabels};
use jrdb_perception::{AttributeModel, Grounder, Perceive, PerceptionError, PhraseModel, View};
use jrdb_types::{Capabilities, Detections, FrameId};

/// The labels of some sequences, read once.
#[derive(Debug, Default)]
pub struct Labels {
    sequences: BTreeMap<String, Result<SequenceLabels, String>>,
}

impl Labels {
    /// Reads the labels of sequences. Those of a sequence that cannot be read fail frame by frame.
    pub fn read<'a>(sequences: impl IntoIterator<Item = (&'a Dataset, &'a str)>) -> Self {
        let read = |(dataset, name): (&Dataset, &str)| {
            let labels = dataset.labels(name);
            (name.to_owned(), labels.map_err(|error| dataset.error_text(&error)))
        };
        Self { sequences: sequences.into_iter().map(read).collect() }
    }
}

impl Perceive for Labels {
    fn perceive(&self, frame: &FrameId, view: &View<'_>) -> Result<Detections, PerceptionError> {
        match self.sequences.get(&frame.sequence) {
            Some(Ok(labels)) => Ok(labels.detections(frame, view.geometry)),
            Some(Err(message)) => Err(PerceptionError::Source(message.clone())),
            None => Err(PerceptionError::Source(format!("no labels were opened for {frame}"))),
        }
    }

    fn looks_at_images(&self) -> bool {
        false
    }

    fn tracks(&self) -> bool {
        true
    }

    /// Every frame states its own.
    fn capabilities(&self) -> Capabilities {
        Capabilities::none()
    }

    fn config(&self) -> serde_json::Value {
        serde_json::json!({ "perception": "labels" })
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
