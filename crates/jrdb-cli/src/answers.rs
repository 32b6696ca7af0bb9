//! Answers from files beside the questions that they are to.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use jrdb_dataset::{GivenAnswer, read_answers};
use jrdb_metrics::{MetricsConfig, Outcome, evaluate_all};
use jrdb_models::sha256_hex;
use jrdb_types::answer::Ranked;
use jrdb_types::{Answer, FrameId, Question, Scores, Truth};
use rayon::prelude::*;
use serde_json::json;

use crate::Error;

/// File of an answer in a run's folder.
const ANSWER_FILE: &str = "answer.json";
/// Characters that make a name a pattern.
const WILDCARDS: [char; 3] = ['*', '?', '['];

/// An answer and the file that it is from.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded {
    /// The file.
    pub path: PathBuf,
    /// The answer.
    pub given: GivenAnswer,
}

impl Loaded {
    /// Where it is: the file, and the line of one with several.
    fn place(&self) -> String {
        match self.given.line {
            Some(line) => format!("{} line {line}", self.path.display()),
            None => self.path.display().to_string(),
        }
    }
}

/// Reads answers from files, from folders (every `answer.json` below), and from the files that
/// patterns such as `out/*/q*/answer.json` name.
///
/// # Errors
/// When there is nothing of a name, or a file is not one of answers.
pub fn load_answers(names: &[String]) -> Result<Vec<Loaded>, Error> {
    let mut files = Vec::new();
    for name in names {
        files.extend(files_of(name)?);
    }
    let read = |path: &PathBuf| {
        let given = read_answers(path)?;
        Ok(given.into_iter().map(|given| Loaded { path: path.clone(), given }).collect::<Vec<_>>())
    };
    let all: Vec<Vec<Loaded>> = files.par_iter().map(read).collect::<Result<_, Error>>()?;
    Ok(all.into_iter().flatten().collect())
}

fn files_of(name: &str) -> Result<Vec<PathBuf>, Error> {
    let path = Path::new(name);
    if path.is_dir() {
        let mut files = Vec::new();
        find_answers(path, &mut files)?;
        if files.is_empty() {
            return Err(Error::Usage(format!("expected {ANSWER_FILE} below {path:?}, found none")));
        }
        return Ok(files);
    }
    if path.exists() || !name.contains(WILDCARDS) {
        return Ok(vec![path.into()]);
    }
    let refused = |error: String| Error::Usage(format!("answers {name:?}: {error}"));
    let found = glob::glob(name).map_err(|error| refused(error.to_string()))?;
    let files: Result<Vec<PathBuf>, _> = found.collect();
    let files = files.map_err(|error| refused(error.to_string()))?;
    if files.is_empty() { Err(refused("expected files, found none".into())) } else { Ok(files) }
}

/// Every answer below a folder, in the order of names.
fn find_answers(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), Error> {
    let fail = |source| Error::file("read", folder, source);
    let entries = std::fs::read_dir(folder).map_err(fail)?;
    let mut paths = entries
        .map(|entry| Ok(entry?.path()))
        .collect::<std::io::Result<Vec<_>>>()
        .map_err(fail)?;
    paths.sort();
    for path in paths {
        if path.is_dir() && !path.is_symlink() {
            find_answers(&path, files)?;
        } else if path.file_name().is_some_and(|name| name == ANSWER_FILE) {
            files.push(path);
        }
    }
    Ok(())
}

/// Answers beside their questions.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Matched {
    /// Questions with their answers, in the order of the questions. Where an answer does not name
    /// what it selects as the truth does, the truth's names are left out: boxes decide.
    pub answered: Vec<(Question, Answer)>,
    /// Questions without an answer.
    pub unanswered: Vec<Question>,
    /// How many answers are to no question.
    pub strangers: usize,
    /// The first of them: its place, and what it is about.
    pub first_stranger: Option<String>,
}

impl Matched {
    /// The scores; questions without an answer are missed.
    #[must_use]
    pub fn scores(&self, config: &MetricsConfig) -> Scores {
        let outcomes = self.answered.iter();
        let outcomes: Vec<Outcome<'_>> =
            outcomes.map(|(question, answer)| Outcome { question, answer }).collect();
        let unanswered: Vec<&Question> = self.unanswered.iter().collect();
        evaluate_all(&outcomes, &unanswered, config)
    }
}

/// A digest of questions with their known answers: scores of different questions are not compared.
#[must_use]
pub fn questions_digest<'q>(questions: impl IntoIterator<Item = &'q Question>) -> String {
    let known = questions.into_iter().filter(|question| question.truth.is_some());
    // What an author notes on the meaning changes neither what is asked nor what is right.
    let bare = known.map(|question| Question { query: None, ..question.clone() });
    let mut lines: Vec<String> = bare.map(|question| json!(question).to_string()).collect();
    lines.sort();
    sha256_hex(lines.join("\n").as_bytes())
}

/// Finds the question of every answer: that of the same frame and id, else of the same frame and
/// words; where the answer names no frame, the one question of that id. A question that stands in
/// the file twice may be answered twice.
///
/// # Errors
/// When a question has two answers.
pub fn match_answers(questions: &[Question], answers: Vec<Loaded>) -> Result<Matched, Error> {
    let index = Index::new(questions);
    let mut given: Vec<Option<Loaded>> = vec![None; questions.len()];
    let mut matched = Matched::default();
    for loaded in answers {
        let places = index.places(&loaded.given);
        let free = places.iter().copied().find(|place| given[*place].is_none());
        match (free, places.first().and_then(|first| given[*first].as_ref())) {
            (Some(place), _) => given[place] = Some(loaded),
            (None, Some(other)) => return Err(twice(&loaded, other)),
            (None, None) => {
                matched.strangers += 1;
                matched.first_stranger.get_or_insert_with(|| described(&loaded));
            }
        }
    }
    for (question, given) in questions.iter().zip(given) {
        match given {
            Some(loaded) => matched.answered.push(pair(question, loaded.given)),
            None => matched.unanswered.push(question.clone()),
        }
    }
    Ok(matched)
}

fn pair(question: &Question, given: GivenAnswer) -> (Question, Answer) {
    let (mut question, is_named) = (question.clone(), given.is_named());
    let answer = given.to(&question);
    if let Some(truth) = &mut question.truth
        && !truth.boxes.is_empty()
        && !(is_named && shares_names(truth, &answer))
    {
        truth.ids.clear();
    }
    (question, answer)
}

/// Whether an answer names things as the truth does: models number people in their own way.
fn shares_names(truth: &Truth, answer: &Answer) -> bool {
    let is_like = |ranked: &Ranked| truth.ids.iter().any(|id| id.class == ranked.id.class);
    answer.ranking.iter().any(is_like)
}

fn twice(one: &Loaded, other: &Loaded) -> Error {
    let places = [other.place(), one.place()].join(" and ");
    Error::Usage(format!("expected one answer to {}, found two: {places}", about(&one.given)))
}

/// Where an answer is, and what it is about.
fn described(loaded: &Loaded) -> String {
    format!("{}, to {}", loaded.place(), about(&loaded.given))
}

/// Which question an answer names.
fn about(given: &GivenAnswer) -> String {
    let question = match (&given.question_id, &given.question) {
        (Some(id), _) => format!("question {id:?}"),
        (None, text) => format!("{:?}", text.as_deref().unwrap_or_default()),
    };
    let frame = given.frame.as_ref().map(|frame| format!(" about {frame}")).unwrap_or_default();
    format!("{question}{frame}")
}

/// Places of questions in their list.
struct Index<'q> {
    by_id: BTreeMap<(&'q FrameId, &'q str), Vec<usize>>,
    by_text: BTreeMap<(&'q FrameId, &'q str), Vec<usize>>,
    by_id_alone: BTreeMap<&'q str, Vec<usize>>,
}

impl<'q> Index<'q> {
    fn new(questions: &'q [Question]) -> Self {
        let mut index =
            Self { by_id: BTreeMap::new(), by_text: BTreeMap::new(), by_id_alone: BTreeMap::new() };
        for (place, question) in questions.iter().enumerate() {
            let frame = &question.frame;
            index.by_text.entry((frame, &question.text)).or_default().push(place);
            if let Some(id) = &question.id {
                index.by_id.entry((frame, id)).or_default().push(place);
                index.by_id_alone.entry(id).or_default().push(place);
            }
        }
        index
    }

    /// The questions that an answer may be to.
    fn places<'a>(&'a self, given: &'a GivenAnswer) -> &'a [usize] {
        let id = given.question_id.as_deref();
        let Some(frame) = &given.frame else {
            let alone = id.and_then(|id| self.by_id_alone.get(id));
            return alone.filter(|places| places.len() == 1).map_or(&[], Vec::as_slice);
        };
        let by_id = id.and_then(|id| self.by_id.get(&(frame, id)));
        let by_text = || self.by_text.get(&(frame, given.question.as_deref()?));
        by_id.or_else(by_text).map_or(&[], Vec::as_slice)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use jrdb_dataset::GivenContent;
    use jrdb_types::vocab::MatchPolicy;
    use jrdb_types::{EntityId, LateralConvention, PixelBox, Query};

    fn answer_of(class: &str) -> GivenAnswer {
        let query = Query { text: "Who?".into(), ..Query::default() };
        let (policy, lateral) = (MatchPolicy::Strict, LateralConvention::Physical);
        let blank = Answer::new(FrameId::default(), &query, policy, lateral);
        let (id, bbox) = (EntityId::new(class, 7), PixelBox::from([0.0, 0.0, 9.0, 9.0]));
        let ranking = vec![Ranked { id: id.clone(), bbox, probability: 1.0 }];
        let answer = Answer { selection: vec![id], ranking, ..blank };
        GivenAnswer {
            line: None,
            frame: Some(FrameId::default()),
            question_id: None,
            question: Some("Who?".into()),
            content: GivenContent::Named(Box::new(answer)),
        }
    }

    fn exact(class: &str, truth: Truth) -> Option<bool> {
        let question =
            Question { truth: Some(truth), ..Question::typed("Who?", FrameId::default()) };
        let loaded = Loaded { path: "answer.json".into(), given: answer_of(class) };
        let matched = match_answers(&[question], vec![loaded]).unwrap();
        matched.scores(&MetricsConfig::default()).questions[0].exact
    }

    #[test]
    fn names_are_compared_where_they_are_of_one_kind_and_else_boxes() {
        let ids = vec![EntityId::new("pedestrian", 1)];
        let boxes = vec![PixelBox::from([0.0, 0.0, 9.0, 9.0])];
        let truth = Truth { ids: ids.clone(), boxes, ..Truth::default() };
        assert_eq!(exact("person", truth.clone()), Some(true));
        assert_eq!(exact("pedestrian", truth), Some(false));
        assert_eq!(exact("person", Truth { ids, ..Truth::default() }), Some(false));
    }
}
