//! Several questions about one scene, each of which may go back to the one before.

use jrdb_types::{Answer, Query};

use crate::query::read_query_after;
use crate::{Error, Scene};

/// A conversation about a scene: "who is on the bench?", "which of them is a woman?", "and behind her?".
pub struct Conversation<'s> {
    scene: &'s Scene,
    before: Option<Query>,
}

impl Conversation<'_> {
    /// Answers a question; pronouns stand for what the question before was about.
    ///
    /// # Errors
    /// As [`Scene::ask`]. A question that is not understood is forgotten.
    pub fn ask(&mut self, question: &str) -> Result<Answer, Error> {
        let parser = &self.scene.config().parser;
        let query = read_query_after(question, parser, self.before.as_ref())?;
        let answer = self.scene.ask_query(&query);
        self.before = Some(query);
        Ok(answer)
    }
}

impl Scene {
    /// A conversation: each question may go back to the one before.
    #[must_use]
    pub fn conversation(&self) -> Conversation<'_> {
        Conversation { scene: self, before: None }
    }
}
