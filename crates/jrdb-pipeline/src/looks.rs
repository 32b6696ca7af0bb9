//! Perception, asked how the things of a scene look.

use std::cell::RefCell;

use jrdb_perception::{Perceive, PhraseModel, Subject, View};
use jrdb_search::Looks;
use jrdb_types::issue::IssueKind;
use jrdb_types::{Detections, EntityId, Issue, with_causes};

use crate::Frame;

/// Asks perception again, about crops of a frame's image.
pub(crate) struct Eyes<'s> {
    frame: &'s Frame,
    detections: &'s Detections,
    looks_at_images: bool,
    model: &'s dyn PhraseModel,
    /// What could not be told because the model failed.
    failures: RefCell<Vec<Issue>>,
}

impl<'s> Eyes<'s> {
    /// None where perception cannot be asked.
    pub(crate) fn of(
        perception: &'s dyn Perceive,
        frame: &'s Frame,
        detections: &'s Detections,
    ) -> Option<Self> {
        let (model, looks_at_images) = (perception.phrase_model()?, perception.looks_at_images());
        Some(Self { frame, detections, looks_at_images, model, failures: RefCell::default() })
    }

    /// What could not be told because the model failed.
    pub(crate) fn into_failures(self) -> Vec<Issue> {
        self.failures.into_inner()
    }

    /// The frame's only view. Pixels that perception does not look at are not decoded.
    fn view(&self) -> View<'s> {
        let image = if self.looks_at_images { self.frame.pixels() } else { None };
        View { geometry: self.detections.image, image }
    }
}

impl Looks for Eyes<'_> {
    fn probability(&self, id: &EntityId, words: &str) -> Option<f64> {
        let detection = self.detections.detections.iter().find(|one| one.id == *id)?;
        let subject = Subject { frame: &self.frame.id, view: self.view(), detection };
        match self.model.weigh(&subject, &[words]) {
            Ok(told) => told.into_iter().next()?,
            Err(error) => {
                let message = format!("{words:?} could not be looked for: {}", with_causes(&error));
                let issue = Issue::about(IssueKind::NotDescribed, id, message);
                self.failures.borrow_mut().push(issue);
                None
            }
        }
    }

    fn source(&self) -> String {
        self.model.source()
    }
}
