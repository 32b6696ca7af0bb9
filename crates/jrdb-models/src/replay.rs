//! Perception from the replies of models that ran before or elsewhere.

use std::path::Path;

use jrdb_perception::exchange::{self, Exchange, replay};
use jrdb_perception::exchange_phrase::phrase_probability;
use jrdb_perception::{
    AttributeModel, Grounder, Perceive, PerceptionError, PhraseModel, Subject, View,
};
use jrdb_types::{Capabilities, Detections, FrameId, Vocabulary};

use crate::Error;

/// A file of requests with replies, as `jrdb_perception::exchange` describes it.
#[derive(Debug)]
pub struct Replay {
    lines: Vec<Exchange>,
    capabilities: Capabilities,
}

impl Replay {
    /// Reads a file of JSON Lines.
    ///
    /// # Errors
    /// When it cannot be read, or a line is not an exchange.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let text = std::fs::read_to_string(path).map_err(Error::read(path))?;
        let refused = |source| Error::Model { path: path.into(), source: Box::new(source) };
        let lines = Exchange::read_lines(&text).map_err(refused)?;
        let capabilities = exchange::capabilities(&lines);
        Ok(Self { lines, capabilities })
    }
}

impl Perceive for Replay {
    fn perceive(&self, frame: &FrameId, view: &View<'_>) -> Result<Detections, PerceptionError> {
        Ok(replay(&self.lines, frame, view.geometry))
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
        serde_json::json!({ "perception": "replay" })
    }

    fn grounder(&self) -> Option<&dyn Grounder> {
        None
    }

    fn attribute_model(&self) -> Option<&dyn AttributeModel> {
        None
    }

    fn phrase_model(&self) -> Option<&dyn PhraseModel> {
        self.lines.iter().any(|line| line.request.looks.is_some()).then_some(self)
    }
}

impl PhraseModel for Replay {
    fn weigh(
        &self,
        subject: &Subject<'_>,
        phrases: &[&str],
    ) -> Result<Vec<Option<f64>>, PerceptionError> {
        let Subject { frame, view, detection } = *subject;
        let told = |phrase: &&str| {
            phrase_probability(&self.lines, frame, view.geometry, detection, phrase)
        };
        Ok(phrases.iter().map(told).collect())
    }

    fn phrases(&self) -> Vocabulary<String> {
        self.lines.iter().filter_map(|line| line.request.looks.clone()).collect()
    }

    fn source(&self) -> String {
        "replay".into()
    }
}
