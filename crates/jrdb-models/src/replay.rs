//! Perception from the replies of models that ran before or elsewhere.

use std::collections::BTreeMap;
use std::path::Path;

use jrdb_perception::exchange::{self, Exchange, replay};
use jrdb_perception::exchange_phrase::phrase_probability;
use jrdb_perception::{
    AttributeModel, Grounder, Grounding, Perceive, PerceptionError, PhraseModel, Subject, View,
};
use jrdb_types::issue::IssueKind;
use jrdb_types::{Capabilities, Detections, FrameId, Issue, Vocabulary};

use crate::Error;

/// A file of requests with replies, as `jrdb_perception::exchange` describes it.
#[derive(Debug)]
pub struct Replay {
    lines: Vec<Exchange>,
    /// Places of the lines that are whole questions, by frame and words.
    sentences: BTreeMap<(FrameId, String), usize>,
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
        let sentence = |(at, line): (usize, &Exchange)| {
            Some(((line.request.frame.clone(), line.request.sentence.clone()?), at))
        };
        let sentences = lines.iter().enumerate().filter_map(sentence).collect();
        Ok(Self { lines, sentences, capabilities })
    }
}

impl Grounder for Replay {
    fn ground(
        &self,
        frame: &FrameId,
        view: &View<'_>,
        sentences: &[&str],
    ) -> Result<Vec<Grounding>, PerceptionError> {
        let one = |sentence: &&str| {
            let at = self.sentences.get(&(frame.clone(), (*sentence).to_owned()));
            let why =
                || format!("the recording of replies has no line for {sentence:?} on {frame}");
            let line = at.and_then(|at| self.lines.get(*at));
            let line = line.ok_or_else(|| Issue::new(IssueKind::MissingInput, why()))?;
            exchange::grounded(line, view.geometry)
        };
        Ok(sentences.iter().map(one).collect())
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
        let has_some = !self.sentences.is_empty();
        has_some.then_some(self)
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
