//! Which questions are asked of which frame, each read once.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use jrdb_parser::ParserConfig;
use jrdb_pipeline::query::{read_or_report, speaks_of_time};
use jrdb_types::score::QuestionScore;
use jrdb_types::{Answer, FrameId, Query, Question, Questions};

use crate::Error;
use crate::source::{FrameSource, Source};

/// The category of questions that were typed, not read from a file.
pub const TYPED: &str = "typed";

/// A question and what it was read as. Copies share the query.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadQuestion {
    /// The question, with its truth where there is one.
    pub question: Question,
    /// What it was read as.
    pub query: Arc<Query>,
}

impl ReadQuestion {
    /// Whether it needs more than one frame.
    #[must_use]
    pub fn speaks_of_time(&self) -> bool {
        speaks_of_time(&self.question, &self.query)
    }
}

/// A question, what it was read as, what was answered, and how good that is.
#[derive(Debug, Clone, PartialEq)]
pub struct Answered {
    /// The question, with its truth where there is one.
    pub question: Question,
    /// What it was read as.
    pub query: Arc<Query>,
    /// The answer.
    pub answer: Answer,
    /// The answer against the truth, where that is known.
    pub score: Option<QuestionScore>,
}

/// The questions of every frame of a run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FrameQuestions {
    /// For each frame, in its order.
    pub per_frame: Vec<Vec<ReadQuestion>>,
    /// Questions of the file that no frame of the run can answer.
    pub unasked: usize,
}

impl FrameQuestions {
    /// Typed queries for every frame, then the questions of files, or without both the scenes' own.
    ///
    /// # Errors
    /// When a file of questions is unusable.
    pub fn gather(
        frames: &[FrameSource],
        typed: &[Arc<Query>],
        files: &[PathBuf],
        sources: &[Source],
        config: &ParserConfig,
    ) -> Result<Self, Error> {
        let mut listed = read_all(files)?;
        if files.is_empty() && typed.is_empty() {
            for source in sources {
                listed.questions.extend(source.own_questions()?.questions);
            }
        }
        let count = listed.questions.len();
        let mut by_frame = by_frame(listed.questions, config);
        let of_frame = |frame: &FrameSource| {
            let typed = typed.iter().map(|query| typed_question(query, &frame.id));
            typed.chain(by_frame.remove(&frame.id).unwrap_or_default()).collect::<Vec<_>>()
        };
        let per_frame: Vec<Vec<ReadQuestion>> = frames.iter().map(of_frame).collect();
        let asked: usize = per_frame.iter().map(Vec::len).sum();
        let from_file = asked - typed.len() * frames.len();
        Ok(Self { per_frame, unasked: count.saturating_sub(from_file) })
    }

    /// Leaves of the truth only its boxes: the names that perception gives are others.
    pub fn forget_names(&mut self) {
        let all = self.per_frame.iter_mut().flatten();
        let truths = all.filter_map(|one| one.question.truth.as_mut());
        // Where the truth has names only, they are all that can be compared.
        truths.filter(|truth| !truth.boxes.is_empty()).for_each(|truth| truth.ids.clear());
    }

    /// All queries.
    pub fn queries(&self) -> impl Iterator<Item = &Query> {
        self.per_frame.iter().flatten().map(|one| &*one.query)
    }

    /// The most questions that a frame has.
    #[must_use]
    pub fn most(&self) -> usize {
        self.per_frame.iter().map(Vec::len).max().unwrap_or(0)
    }
}

/// The questions of several files, one after the other.
///
/// # Errors
/// When one of them is unusable.
pub fn read_all(files: &[PathBuf]) -> Result<Questions, Error> {
    let mut all = Questions::default();
    for path in files {
        all.questions.extend(jrdb_dataset::read_questions(path)?.questions);
    }
    Ok(all)
}

/// The questions of every frame, in their order; equal texts are read once and share their query.
fn by_frame(
    questions: Vec<Question>,
    config: &ParserConfig,
) -> BTreeMap<FrameId, Vec<ReadQuestion>> {
    let mut queries: BTreeMap<String, Arc<Query>> = BTreeMap::new();
    let mut by_frame: BTreeMap<FrameId, Vec<ReadQuestion>> = BTreeMap::new();
    for question in questions {
        let read = || Arc::new(read_or_report(&question.text, config));
        let query = queries.entry(question.text.clone()).or_insert_with(read).clone();
        by_frame.entry(question.frame.clone()).or_default().push(ReadQuestion { question, query });
    }
    by_frame
}

fn typed_question(query: &Arc<Query>, frame: &FrameId) -> ReadQuestion {
    let category = TYPED.into();
    let question = Question { category, ..Question::typed(&*query.text, frame.clone()) };
    ReadQuestion { question, query: query.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_texts_share_a_query_and_frames_keep_the_order_of_their_questions() {
        let asked =
            |text: &str, frame| Question::typed(text, FrameId { sequence: "cafe".into(), frame });
        let all = vec![asked("Find all men", 1), asked("Who sits?", 1), asked("Find all men", 2)];
        let by_frame = by_frame(all, &ParserConfig::default());
        let frames: Vec<&Vec<ReadQuestion>> = by_frame.values().collect();
        let texts: Vec<&str> = frames[0].iter().map(|one| &*one.question.text).collect();
        assert_eq!(texts, ["Find all men", "Who sits?"]);
        assert!(Arc::ptr_eq(&frames[0][0].query, &frames[1][0].query));
    }
}
