//! Answers of other programs, to be scored beside ours.

use std::collections::BTreeMap;
use std::path::Path;

use jrdb_types::answer::{Count, PropertyValue, PropertyValues, Ranked, Reply, Status};
use jrdb_types::vocab::MatchPolicy;
use jrdb_types::{
    Answer, Artefact, ArtefactError, EntityId, FrameId, LateralConvention, PixelBox, Query,
    Question,
};
use serde::Deserialize;
use serde_json::Value;

use crate::number::Real;
use crate::questions::Name;
use crate::{Error, file};

/// Class of the ids of boxes without a name.
const UNNAMED: &str = "box";

/// An answer as a file has it.
#[derive(Debug, Clone, PartialEq)]
pub struct GivenAnswer {
    /// Line of the file, from 1; absent where the file is one answer.
    pub line: Option<usize>,
    /// The frame that it is about, where the answer says so.
    pub frame: Option<FrameId>,
    /// The question's id, where the answer names it.
    pub question_id: Option<String>,
    /// The question's words, where the answer repeats them.
    pub question: Option<String>,
    /// What is answered.
    pub content: GivenContent,
}

/// What is answered.
#[derive(Debug, Clone, PartialEq)]
pub enum GivenContent {
    /// An answer of this project, with names and reasons.
    Named(Box<Answer>),
    /// Boxes without names, of another program.
    Boxes(GivenBoxes),
}

/// An answer of another program.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct GivenBoxes {
    /// Boxes with their scores in `[0, 1]`; the score of a box without one is 1. Pixels.
    pub boxes: Vec<(PixelBox, f64)>,
    /// What is replied besides: a number, yes or no, words.
    pub reply: Option<Reply>,
    /// Whether the program says that it cannot tell.
    pub is_unknown: bool,
}

impl GivenAnswer {
    /// The answer to a question. Boxes without names get the ids `box:1`, `box:2` …
    #[must_use]
    pub fn to(self, question: &Question) -> Answer {
        let id = question.id.clone();
        match self.content {
            GivenContent::Named(answer) => Answer { question_id: id, ..*answer },
            GivenContent::Boxes(given) => Answer { question_id: id, ..given.answer(question) },
        }
    }

    /// Whether the answer names what it selects as its source does.
    #[must_use]
    pub fn is_named(&self) -> bool {
        matches!(self.content, GivenContent::Named(_))
    }
}

impl GivenBoxes {
    fn answer(self, question: &Question) -> Answer {
        let query = Query { text: question.text.clone(), ..Query::default() };
        let (policy, lateral) = (MatchPolicy::Strict, LateralConvention::Physical);
        let blank = Answer::new(question.frame.clone(), &query, policy, lateral);
        let ids = (1..).map(|number| EntityId::new(UNNAMED, number));
        let ranked =
            ids.zip(self.boxes).map(|(id, (bbox, probability))| Ranked { id, bbox, probability });
        let ranking: Vec<Ranked> = ranked.collect();
        Answer {
            status: if self.is_unknown { Status::Unknown } else { Status::Answered },
            reply: self.reply.unwrap_or(Reply::Things),
            selection: ranking.iter().map(|ranked| ranked.id.clone()).collect(),
            ranking: by_probability(ranking),
            ..blank
        }
    }
}

/// Most probable first; ties in the order of the file.
fn by_probability(mut ranking: Vec<Ranked>) -> Vec<Ranked> {
    ranking.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    ranking
}

/// Reads answers: one artefact `jrdb.answer`, JSON Lines, or COCO results.
///
/// A line of JSON Lines is an artefact `jrdb.answer` or an answer of another program:
/// `{"frame": {"sequence", "frame"}, "question_id" or "question", "boxes": [[x, y, w, h], …],
/// "scores": […], "answer": …}`, of which `scores` and `answer` may be absent and `frame` where the
/// question's id tells it. Lines of other artefacts and a run's summary are passed over. In COCO
/// results `image_id` is the question's id; rows with one id are one answer.
///
/// # Errors
/// [`Error::Read`], or [`Error::Content`] with the line or row that is not as described.
pub fn read_answers(path: &Path) -> Result<Vec<GivenAnswer>, Error> {
    let text = file::read_text(path)?;
    if text.trim_start().starts_with('[') {
        return coco(&text, path);
    }
    // An artefact in a file of its own has its first key on a line of its own.
    if text.lines().next().is_some_and(|line| line.trim() == "{") {
        let artefact = Artefact::<Answer>::from_json(&text);
        let refused = |error: ArtefactError| Error::content(path, "jrdb.answer", error.to_string());
        return Ok(vec![named(artefact.map_err(refused)?.data, None)]);
    }
    let lines = (1..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty());
    let answers = lines.map(|(number, line)| {
        read_line(line, number).map_err(|(expected, found)| {
            Error::content(path, format!("{expected} in line {number}"), found)
        })
    });
    answers.filter_map(Result::transpose).collect()
}

fn named(answer: Answer, line: Option<usize>) -> GivenAnswer {
    GivenAnswer {
        line,
        frame: Some(answer.frame.clone()),
        question_id: answer.question_id.clone(),
        question: Some(answer.question.clone()),
        content: GivenContent::Named(Box::new(answer)),
    }
}

/// What was expected, and what was found.
type Mismatch = (String, String);

#[derive(Deserialize)]
struct Line {
    schema: Option<String>,
    /// Only a run's summary has it.
    failures: Option<serde::de::IgnoredAny>,
    frame: Option<FrameId>,
    #[serde(alias = "id")]
    question_id: Option<Name>,
    question: Option<String>,
    boxes: Option<Vec<Vec<Real>>>,
    scores: Option<Vec<Real>>,
    answer: Option<Value>,
}

fn read_line(line: &str, number: usize) -> Result<Option<GivenAnswer>, Mismatch> {
    let read: Line = serde_json::from_str(line)
        .map_err(|error| ("an answer as a JSON object".to_owned(), error.to_string()))?;
    match &read.schema {
        Some(schema) if schema == "jrdb.answer" => {
            let artefact = Artefact::<Answer>::from_json(line);
            let answer = artefact.map_err(|error| ("jrdb.answer".to_owned(), error.to_string()))?;
            return Ok(Some(named(answer.data, Some(number))));
        }
        Some(_) => return Ok(None),
        None if read.failures.is_some() && read.boxes.is_none() => return Ok(None),
        None => {}
    }
    let question_id = read.question_id.map(Name::into_text);
    if question_id.is_none() && (read.question.is_none() || read.frame.is_none()) {
        let expected = "a question_id, or a frame and a question";
        return Err((expected.into(), brief(line)));
    }
    let boxes = read.boxes.unwrap_or_default().into_iter().map(pixel_box);
    let boxes = boxes.collect::<Result<Vec<_>, _>>()?;
    let scores = match read.scores {
        Some(scores) => scores.into_iter().map(score).collect::<Result<Vec<_>, _>>()?,
        None => vec![1.0; boxes.len()],
    };
    if scores.len() != boxes.len() {
        let expected = format!("{} scores, one for each box", boxes.len());
        return Err((expected, scores.len().to_string()));
    }
    let mut given =
        GivenBoxes { boxes: boxes.into_iter().zip(scores).collect(), ..Default::default() };
    if let Some(answer) = read.answer {
        given.take_reply(&answer)?;
    }
    Ok(Some(GivenAnswer {
        line: Some(number),
        frame: read.frame,
        question_id,
        question: read.question,
        content: GivenContent::Boxes(given),
    }))
}

impl GivenBoxes {
    fn take_reply(&mut self, answer: &Value) -> Result<(), Mismatch> {
        let expected =
            || "an answer that is a number, true, false, a text or a list of texts".to_owned();
        self.reply = match answer {
            Value::Null => None,
            Value::Bool(yes) => Some(Reply::YesNo(Some(*yes))),
            Value::Number(number) => {
                Some(count(number.as_u64()).ok_or_else(|| (expected(), answer.to_string()))?)
            }
            Value::String(text) => self.spoken(text),
            Value::Array(all) => {
                let words: Option<Vec<&str>> = all.iter().map(Value::as_str).collect();
                Some(told(&words.ok_or_else(|| (expected(), answer.to_string()))?))
            }
            Value::Object(_) => return Err((expected(), answer.to_string())),
        };
        Ok(())
    }

    /// What a text replies.
    fn spoken(&mut self, text: &str) -> Option<Reply> {
        match text.trim().to_lowercase().as_str() {
            "yes" | "true" => Some(Reply::YesNo(Some(true))),
            "no" | "false" => Some(Reply::YesNo(Some(false))),
            "unknown" => {
                self.is_unknown = true;
                None
            }
            word => count(word.parse().ok()).or_else(|| Some(told(&[text]))),
        }
    }
}

fn count(number: Option<u64>) -> Option<Reply> {
    Some(Reply::Number(Count::Exact(usize::try_from(number?).ok()?)))
}

fn told(words: &[&str]) -> Reply {
    let values = words.iter().map(|word| PropertyValue::Category((*word).to_owned())).collect();
    let id = EntityId::new(UNNAMED, 1);
    Reply::Properties(vec![PropertyValues { id, property: None, values, words: Vec::new() }])
}

fn pixel_box(numbers: Vec<Real>) -> Result<PixelBox, Mismatch> {
    let numbers: Vec<f64> = numbers.into_iter().map(|Real(number)| number).collect();
    match <[f64; 4]>::try_from(numbers) {
        Ok(bbox) if bbox.iter().all(|n| n.is_finite()) => Ok(bbox.into()),
        Ok(bbox) => Err(("boxes of finite numbers".into(), format!("{bbox:?}"))),
        Err(other) => Err(("boxes [x, y, w, h]".into(), format!("{other:?}"))),
    }
}

fn score(Real(score): Real) -> Result<f64, Mismatch> {
    match score {
        0.0..=1.0 => Ok(score),
        _ => Err(("scores between 0 and 1".into(), score.to_string())),
    }
}

/// The beginning of a line.
fn brief(line: &str) -> String {
    const SHOWN: usize = 80;
    line.chars().take(SHOWN).collect()
}

#[derive(Deserialize)]
struct CocoRow {
    image_id: Name,
    bbox: Vec<Real>,
    score: Option<Real>,
}

fn coco(text: &str, path: &Path) -> Result<Vec<GivenAnswer>, Error> {
    let rows: Vec<CocoRow> = crate::json::parse(text, path, "COCO results")?;
    let mut answers: BTreeMap<String, GivenBoxes> = BTreeMap::new();
    for (index, row) in rows.into_iter().enumerate() {
        let fail = |(expected, found): Mismatch| {
            Error::content(path, format!("{expected} in row {index}"), found)
        };
        let bbox = pixel_box(row.bbox).map_err(fail)?;
        let score = row.score.map_or(Ok(1.0), score).map_err(fail)?;
        answers.entry(row.image_id.into_text()).or_default().boxes.push((bbox, score));
    }
    let answer = |(id, given)| GivenAnswer {
        line: None,
        frame: None,
        question_id: Some(id),
        question: None,
        content: GivenContent::Boxes(given),
    };
    Ok(answers.into_iter().map(answer).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(name: &str, text: &str) -> Result<Vec<GivenAnswer>, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        read_answers(&path).map_err(|error| error.to_string())
    }

    fn line(rest: &str) -> String {
        format!(r#"{{"frame": {{"sequence": "cafe_0", "frame": 3}}, "question": "Who?"{rest}}}"#)
    }

    fn boxes(answer: &GivenAnswer) -> &GivenBoxes {
        match &answer.content {
            GivenContent::Boxes(given) => given,
            GivenContent::Named(_) => panic!("{answer:?}"),
        }
    }

    #[test]
    fn lines_of_other_programs_are_answers_without_names() {
        let text = line(r#", "boxes": [[1, 2, 3, 4], [5, 6, 7, 8]], "scores": [0.25, 0.5]"#);
        let found = read("a.jsonl", &text).unwrap().remove(0);
        assert_eq!((found.line, found.question.as_deref()), (Some(1), Some("Who?")));
        let answer = found.to(&Question::typed("Who?", FrameId::default()));
        let ranked: Vec<_> =
            answer.ranking.iter().map(|r| (r.id.to_string(), r.probability)).collect();
        assert_eq!(ranked, [("box:2".into(), 0.5), ("box:1".into(), 0.25)]);
        assert_eq!(answer.selection.len(), 2);
    }

    #[test]
    fn replies_are_numbers_yes_and_no_words_or_unknown() {
        let reply = |answer: &str| {
            let text = line(&format!(r#", "answer": {answer}"#));
            boxes(&read("a.jsonl", &text).unwrap()[0]).clone()
        };
        assert_eq!(reply("3").reply, Some(Reply::Number(Count::Exact(3))));
        assert_eq!(reply("\"2\"").reply, Some(Reply::Number(Count::Exact(2))));
        assert_eq!(reply("false").reply, Some(Reply::YesNo(Some(false))));
        assert_eq!(reply("\"Yes\"").reply, Some(Reply::YesNo(Some(true))));
        assert_eq!(reply("[\"male\"]").reply, Some(told(&["male"])));
        assert!(reply("\"unknown\"").is_unknown);
    }

    #[test]
    fn rows_of_coco_results_with_one_image_are_one_answer() {
        let text = r#"[{"image_id": 7, "category_id": 1, "bbox": [0, 0, 2, 2], "score": 0.5},
            {"image_id": 7, "category_id": 1, "bbox": [4, 0, 2, 2], "score": 0.75}]"#;
        let found = read("a.json", text).unwrap();
        assert_eq!((found.len(), found[0].question_id.as_deref()), (1, Some("7")));
        assert_eq!(boxes(&found[0]).boxes.len(), 2);
    }

    #[test]
    fn our_own_lines_are_read_and_a_runs_summary_is_passed_over() {
        let query = Query { text: "Who?".into(), ..Query::default() };
        let (policy, lateral) = (MatchPolicy::Ranked, LateralConvention::Physical);
        let answer = Answer::new(FrameId::default(), &query, policy, lateral);
        let own = serde_json::json!(Artefact::new(Value::Null, answer)).to_string();
        let text = format!("{own}\n\n{{\"frames\": [], \"failures\": [], \"unasked\": 0}}\n");
        let found = read("a.jsonl", &text).unwrap();
        assert!(found.len() == 1 && found[0].is_named());
        assert_eq!(read("answer.json", &own).unwrap().len(), 1);
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        let wrong = |text: &str| read("a.jsonl", &format!("{}\n{text}", line(""))).unwrap_err();
        for (text, expected) in [
            (line(r#", "boxes": [[1, 2, 3]]"#), "boxes [x, y, w, h] in line 2"),
            (line(r#", "boxes": [[1, 2, 3, 4]], "scores": []"#), "1 scores, one for each box"),
            (line(r#", "boxes": [[1, 2, 3, 4]], "scores": [7]"#), "scores between 0 and 1"),
            (line(r#", "answer": {}"#), "an answer that is a number"),
            (r#"{"boxes": []}"#.into(), "a question_id, or a frame and a question"),
            ("{".into(), "an answer as a JSON object in line 2"),
        ] {
            let error = wrong(&text);
            assert!(error.contains(expected), "{error}");
        }
    }
}
