//! JRDB-Reasoning data points: questions about one frame or a recording with their known answers.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use jrdb_types::{EntityId, FrameId, PixelBox, Question, Questions, Truth};
use serde::de::{Error as _, IgnoredAny, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

use crate::number::Real;
use crate::{Error, boxes, file, json};

/// The only slot that a question about one frame has, and the first of one about a recording.
const SLOT: &str = "slot1";

/// In front of a person's id in JRDB-Reasoning's files.
const HUMAN: &str = "h_";

/// The sub-question that asks for nothing but people.
const ANYBODY: &str = "human";

/// Attributes in the order in which the categories' names list them: key in the file, word in the name.
const ATTRIBUTES: [(&str, &str); 9] = [
    ("gender", "gender"),
    ("age", "age"),
    ("race", "race"),
    ("action", "action"),
    ("distance", "distance"),
    ("SR_Robot_Ref", "SR/robot"),
    ("hhi", "HHI"),
    ("hhg", "HHG"),
    ("hoi", "HOI"),
];

#[derive(Deserialize)]
struct DataPoint {
    #[serde(default, alias = "id")]
    question_id: Option<Name>,
    category: Option<String>,
    task_type: String,
    data: Data<String>,
    question: Asked,
    #[serde(default)]
    labels: BTreeMap<String, serde_json::Value>,
}

/// A name, or a number that is one.
#[derive(Deserialize)]
#[serde(untagged)]
pub(crate) enum Name {
    Text(String),
    Number(i64),
}

impl Name {
    pub(crate) fn into_text(self) -> String {
        match self {
            Self::Text(text) => text,
            Self::Number(number) => number.to_string(),
        }
    }
}

#[derive(Serialize, Deserialize)]
struct Data<T> {
    seq: T,
    modality_type: T,
}

#[derive(Deserialize)]
struct Asked {
    question: String,
    #[serde(default)]
    query: Option<String>,
    #[serde(default)]
    timestamps: BTreeMap<String, Slot>,
    #[serde(default)]
    sub_questions: BTreeMap<String, IgnoredAny>,
    #[serde(default)]
    entities: Entities,
}

#[derive(Deserialize)]
struct Slot {
    #[serde(default)]
    image_ids: Vec<String>,
}

#[derive(Default, Deserialize)]
struct Entities {
    #[serde(default)]
    variation_slots: BTreeMap<String, Variation>,
    #[serde(flatten)]
    constant: BTreeMap<String, IgnoredAny>,
}

#[derive(Deserialize)]
struct Variation {
    #[serde(default)]
    variable: BTreeMap<String, IgnoredAny>,
}

#[derive(Deserialize)]
struct Known {
    #[serde(rename = "final_ID")]
    ids: Option<Vec<String>>,
    #[serde(rename = "final_bbox")]
    boxes: Option<Vec<[Real; 4]>>,
    #[serde(rename = "final_answer")]
    answer: Option<serde_json::Value>,
}

/// What a question is about, as the files name it.
const IMAGE: &str = "image";
const VIDEO: &str = "video";

/// Reads a list of JRDB-Reasoning data points, `VG` and `VQA`, about single frames and recordings.
///
/// The known answer is `final_ID` (without its `h_`), `final_bbox` and, in `VQA`, `final_answer` of
/// `labels.slot1`. A `VQA` question whose answer is not a number is kept without a known answer. Of a
/// recording, the answer of the first slot is known, as the benchmark scores it. The category is the
/// key `category` of our own where it is there; else the attributes asked, named as the benchmark
/// does (`gender-age-race-HHG`); else `uncategorised`. The id is the key `question_id` or `id` of our
/// own.
///
/// # Errors
/// [`Error::Read`], [`Error::Json`], or [`Error::Content`] for a question about something else or of another task,
/// without a frame, or with a known answer that cannot be read.
pub fn read_questions(path: &Path) -> Result<Questions, Error> {
    // What does not stream, and whatever is wrong with it, is left to the reader of whole files.
    match streamed(path) {
        Some(questions) => Ok(questions),
        None => parse(&file::read_text(path)?, path),
    }
}

/// The questions of a plain file, with one data point in memory at a time. `None` where that does not
/// go: a pipe, which can be read only once; UTF-16; numbers that are no JSON; a mistake.
fn streamed(path: &Path) -> Option<Questions> {
    // To open a pipe would begin to read it.
    let file = path.is_file().then(|| File::open(path).ok())??;
    let mut json = serde_json::Deserializer::from_reader(BufReader::new(file));
    let Streamed(questions) = Streamed::deserialize(&mut json).ok()?;
    json.end().ok()?;
    Some(Questions { questions })
}

/// Questions made of data points as these are read.
struct Streamed(Vec<Question>);

impl<'de> Deserialize<'de> for Streamed {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(PointsVisitor).map(Self)
    }
}

struct PointsVisitor;

impl<'de> Visitor<'de> for PointsVisitor {
    type Value = Vec<Question>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("data points")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut points: A) -> Result<Vec<Question>, A::Error> {
        let mut questions = Vec::new();
        while let Some(point) = points.next_element()? {
            questions.push(question(point).map_err(|(expected, _)| A::Error::custom(expected))?);
        }
        Ok(questions)
    }
}

fn parse(text: &str, path: &Path) -> Result<Questions, Error> {
    let expected = "a list of JRDB-Reasoning data points";
    let points: Vec<DataPoint> = json::parse(text, path, expected)?;
    let questions = points.into_iter().enumerate().map(|(index, point)| {
        question(point).map_err(|(expected, found)| {
            Error::content(path, format!("{expected} in question {index}"), found)
        })
    });
    Ok(Questions { questions: questions.collect::<Result<_, _>>()? })
}

/// What was expected, and what was found.
type Mismatch = (&'static str, String);

fn question(point: DataPoint) -> Result<Question, Mismatch> {
    if ![IMAGE, VIDEO].contains(&point.data.modality_type.as_str()) {
        let found = format!("{:?}", point.data.modality_type);
        return Err(("modality_type \"image\" or \"video\"", found));
    }
    if !["VG", "VQA"].contains(&point.task_type.as_str()) {
        return Err(("task_type \"VG\" or \"VQA\"", format!("{:?}", point.task_type)));
    }
    let sequence = point.data.seq.strip_suffix(".json").unwrap_or(&point.data.seq);
    let mut slots = slots(&point)?;
    let frame = FrameId { sequence: sequence.into(), frame: slots[0][0] };
    if point.data.modality_type == IMAGE {
        slots.clear();
    }
    let truth = match point.labels.get(SLOT) {
        Some(known) => truth(known, &point.task_type)?,
        None => None,
    };
    let category = point.category.unwrap_or_else(|| derived_category(&point.question));
    let id = point.question_id.map(Name::into_text);
    let Asked { question: text, query, .. } = point.question;
    Ok(Question { id, text, query, category, frame, slots, truth })
}

/// Numbers of the frames of each slot; there is at least one slot, and one frame in each.
fn slots(point: &DataPoint) -> Result<Vec<Vec<u32>>, Mismatch> {
    let expected = "timestamps.slot1.image_ids with a frame number";
    let named = (1..).map_while(|number| point.question.timestamps.get(&format!("slot{number}")));
    let slots: Option<Vec<Vec<u32>>> = named
        .map(|slot| {
            let numbers = slot.image_ids.iter().map(|name| file::frame_number(name));
            numbers.collect::<Option<Vec<u32>>>().filter(|numbers| !numbers.is_empty())
        })
        .collect();
    slots.filter(|slots| !slots.is_empty()).ok_or_else(|| {
        let first = point.question.timestamps.get(SLOT).map(|slot| slot.image_ids.as_slice());
        (expected, format!("{:?}", first.unwrap_or_default()))
    })
}

fn truth(known: &serde_json::Value, task: &str) -> Result<Option<Truth>, Mismatch> {
    let known = Known::deserialize(known)
        .map_err(|error| ("final_ID, final_bbox and final_answer", error.to_string()))?;
    let counts = task == "VQA";
    let count = known.answer.as_ref().filter(|_| counts).and_then(count);
    if (counts && count.is_none()) || (!counts && known.ids.is_none() && known.boxes.is_none()) {
        return Ok(None);
    }
    let mut ids =
        known.ids.unwrap_or_default().iter().map(|id| human(id)).collect::<Result<Vec<_>, _>>()?;
    let boxes = known.boxes.unwrap_or_default();
    let mut boxes: Vec<PixelBox> =
        boxes.into_iter().map(|numbers| numbers.map(|Real(number)| number).into()).collect();
    let numbers = |bbox: &PixelBox| <[f64; 4]>::from(*bbox);
    if let Some(bbox) = boxes.iter().find(|bbox| !numbers(bbox).iter().all(|n| n.is_finite())) {
        return Err(("boxes of finite numbers", format!("{:?}", numbers(bbox))));
    }
    if ids.len() == boxes.len() {
        let mut pairs: Vec<_> = ids.into_iter().zip(boxes).collect();
        pairs.sort_by(|a, b| a.0.cmp(&b.0));
        (ids, boxes) = pairs.into_iter().unzip();
    }
    ids.sort();
    Ok(Some(Truth { ids, boxes, count, ..Truth::default() }))
}

/// A whole number, bare or as text.
fn count(answer: &serde_json::Value) -> Option<usize> {
    match answer {
        serde_json::Value::String(text) => text.trim().parse().ok(),
        _ => answer.as_u64().and_then(|count| usize::try_from(count).ok()),
    }
}

fn human(text: &str) -> Result<EntityId, Mismatch> {
    let id: Result<EntityId, _> = text.strip_prefix(HUMAN).unwrap_or(text).parse();
    id.map(boxes::usual_id).map_err(|_| ("ids like \"h_pedestrian:12\"", format!("{text:?}")))
}

/// The attributes asked, joined by hyphens.
fn derived_category(asked: &Asked) -> String {
    let keys = asked.sub_questions.keys().flat_map(|key| key.split(", "));
    let mut keys: BTreeSet<&str> = keys.collect();
    if keys.is_empty() {
        let slots = asked.entities.variation_slots.values();
        let variable = slots.flat_map(|slot| slot.variable.keys());
        keys = variable.chain(asked.entities.constant.keys()).map(String::as_str).collect();
    }
    let names: Vec<&str> =
        ATTRIBUTES.iter().filter(|(key, _)| keys.contains(key)).map(|(_, name)| *name).collect();
    match names[..] {
        [] if keys.contains(ANYBODY) => ANYBODY.into(),
        [] => "uncategorised".into(),
        _ => names.join("-"),
    }
}

#[derive(Serialize)]
struct DataPointOut<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    question_id: Option<&'a str>,
    category: &'a str,
    task_type: &'static str,
    r#type: &'static str,
    data: Data<String>,
    question: AskedOut<'a>,
    labels: BTreeMap<&'static str, KnownOut>,
}

#[derive(Serialize)]
struct AskedOut<'a> {
    question: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    query: Option<&'a str>,
    timestamps: BTreeMap<String, SlotOut>,
}

#[derive(Serialize)]
struct SlotOut {
    t1: f64,
    t2: f64,
    image_ids: Vec<String>,
    r#type: &'static str,
}

#[derive(Serialize)]
struct KnownOut {
    image_ids: Vec<String>,
    #[serde(rename = "final_ID")]
    ids: Vec<String>,
    #[serde(rename = "final_bbox")]
    boxes: Vec<PixelBox>,
    #[serde(rename = "final_answer", skip_serializing_if = "Option::is_none")]
    answer: Option<usize>,
}

/// The questions as a list of JRDB-Reasoning data points with a key `category` of our own.
///
/// [`read_questions`] gives the same questions back. A question with a number as its known answer is
/// `VQA`, any other `VG`.
///
/// # Panics
/// Never: every key is a string.
#[must_use]
pub fn write_questions(questions: &Questions) -> String {
    let points: Vec<_> = questions.questions.iter().map(data_point).collect();
    let mut text = serde_json::to_string_pretty(&points).expect("keys are strings");
    text.push('\n');
    text
}

fn data_point(question: &Question) -> DataPointOut<'_> {
    let one = vec![vec![question.frame.frame]];
    let slots = if question.slots.is_empty() { &one } else { &question.slots };
    let images = |frames: &[u32]| frames.iter().map(|n| format!("{n:06}.jpg")).collect::<Vec<_>>();
    let ends =
        |frames: &[u32]| [frames.first(), frames.last()].map(|n| f64::from(*n.unwrap_or(&0)));
    let slot = |frames: &Vec<u32>| {
        let [t1, t2] = ends(frames);
        SlotOut { t1, t2, image_ids: images(frames), r#type: "specific" }
    };
    let timestamps =
        (1..).zip(slots).map(|(number, frames)| (format!("slot{number}"), slot(frames)));
    let modality = if question.slots.is_empty() { IMAGE } else { VIDEO };
    let known = question.truth.as_ref().map(|truth| KnownOut {
        image_ids: images(&slots[0]),
        ids: truth.ids.iter().map(|id| format!("{HUMAN}{id}")).collect(),
        boxes: truth.boxes.clone(),
        answer: truth.count,
    });
    let counts = question.truth.as_ref().is_some_and(|truth| truth.count.is_some());
    DataPointOut {
        question_id: question.id.as_deref(),
        category: &question.category,
        task_type: if counts { "VQA" } else { "VG" },
        r#type: "human",
        data: Data {
            seq: format!("{}.json", question.frame.sequence),
            modality_type: modality.into(),
        },
        question: AskedOut {
            question: &question.text,
            query: question.query.as_deref(),
            timestamps: timestamps.collect(),
        },
        labels: known.map(|known| (SLOT, known)).into_iter().collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const POINT: &str = r#"{"task_type": "VG", "type": "human", "difficulty_level": 3, "question_level": "U(S)P(T)",
        "data": {"seq": "x_0.json", "modality_type": "image", "specs": {"fps": 15}},
        "question": {"question": "Find child and Black person who is standing", "spatial_level": 2,
            "entities": {"id": "h_pedestrian:6", "variation_slots": {"slot1": {"start": 2, "end": 2, "variable": {
                "action": {"variable": ["standing"]}, "face_visibility": {"variable": ["visible"]}}}},
                "age": "child", "race": "Black"},
            "timestamps": {"slot1": {"t1": 2.0, "t2": 2.0, "image_ids": ["000002.jpg"], "type": "specific"}},
            "sub_questions": {"age": "Find child person", "age, gender": "..", "age, gender, hhg": "..", "human": "Find all persons"}},
        "labels": {"slot1": {"image_ids": ["000002.jpg"], "final_ID": ["h_pedestrian:6", "h_pedestrian:2"],
            "final_bbox": [[165, 0, 202, 480], [1638, 0, "202", 480]],
            "age": {"target_ID": ["h_pedestrian:2"], "target_bbox": [[1, 2, 3, 4]]}}}}"#;

    fn read(points: &str) -> Result<Questions, Error> {
        parse(&format!("[{points}]"), Path::new("questions.json"))
    }

    fn error(points: &str) -> String {
        read(points).unwrap_err().to_string()
    }

    fn category(old: &str, new: &str) -> String {
        read(&POINT.replace(old, new)).unwrap().questions[0].category.clone()
    }

    #[test]
    fn a_data_point_of_the_benchmark_is_read() {
        let question = read(POINT).unwrap().questions.remove(0);
        assert_eq!(question.text, "Find child and Black person who is standing");
        assert_eq!(question.frame, FrameId { sequence: "x_0".into(), frame: 2 });
        assert_eq!(question.category, "gender-age-HHG");
        let truth = question.truth.unwrap();
        assert_eq!(truth.ids, [EntityId::new("pedestrian", 2), EntityId::new("pedestrian", 6)]);
        assert_eq!(truth.boxes[0].x, 1638.0, "boxes follow their ids");
        assert_eq!(truth.count, None);
    }

    #[test]
    fn plain_files_are_streamed_and_others_are_read_all_the_same() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("questions.json");
        let write = |text: &str| file::write(&path, text.as_bytes()).unwrap();
        let expected = read(&[POINT, POINT].join(",")).unwrap();
        write(&format!("[{POINT}, {POINT}]\n"));
        assert_eq!(streamed(&path), Some(expected.clone()));
        let odd_number = POINT.replace("\"difficulty_level\": 3", "\"difficulty_level\": NaN");
        for text in [format!("\u{feff}[{POINT}, {POINT}]"), format!("[{odd_number}, {POINT}]")] {
            write(&text);
            assert_eq!((streamed(&path), read_questions(&path).unwrap()), (None, expected.clone()));
        }
        write(&format!("[{POINT}, {}]", POINT.replace("\"VG\"", "\"QA\"")));
        let error = read_questions(&path).unwrap_err().to_string();
        assert!(error.contains("in question 1, found \"QA\""), "{error}");
    }

    #[test]
    fn categories_come_from_our_key_the_sub_questions_or_the_entity() {
        assert_eq!(category(r#""task_type""#, r#""category": "mine", "task_type""#), "mine");
        assert_eq!(category(r#""sub_questions""#, r#""other""#), "age-race-action");
        let only_people = r#""sub_questions": {"human": ".."}, "other""#;
        assert_eq!(category(r#""sub_questions""#, only_people), "human");
        let nothing = POINT.replace("sub_questions", "other").replace("entities", "else");
        assert_eq!(read(&nothing).unwrap().questions[0].category, "uncategorised");
    }

    #[test]
    fn a_counting_question_has_a_number_as_its_answer() {
        let vqa = POINT.replace(r#""VG""#, r#""VQA""#);
        for answer in ["3", r#""3""#] {
            let point =
                vqa.replace(r#""final_ID""#, &format!(r#""final_answer": {answer}, "final_ID""#));
            let truth = read(&point).unwrap().questions[0].truth.clone().unwrap();
            assert_eq!((truth.count, truth.ids.len()), (Some(3), 2));
        }
        let words = vqa.replace(r#""final_ID""#, r#""final_answer": ["male"], "final_ID""#);
        assert_eq!(read(&words).unwrap().questions[0].truth, None);
    }

    #[test]
    fn questions_survive_the_round_trip() {
        let mut questions = read(&[POINT, POINT, POINT].join(",")).unwrap();
        questions.questions[1].truth = None;
        questions.questions[2].truth.as_mut().unwrap().count = Some(2);
        questions.questions[2].slots = vec![vec![2, 3], vec![5]];
        let text = write_questions(&questions);
        assert_eq!(parse(&text, Path::new("q")).unwrap(), questions);
    }

    #[test]
    fn a_question_about_a_recording_has_the_frames_of_its_slots() {
        let video = POINT.replace(r#""image","#, r#""video","#).replace(
            r#""image_ids": ["000002.jpg"], "type": "specific"}}"#,
            r#""image_ids": ["000002.jpg"]}, "slot2": {"image_ids": ["000004.jpg", "000005.jpg"]}}"#,
        );
        let question = &read(&video).unwrap().questions[0];
        assert_eq!((question.frame.frame, &question.slots), (2, &vec![vec![2], vec![4, 5]]));
    }

    #[test]
    fn trouble_names_the_question() {
        let place = r#"in "questions.json""#;
        assert_eq!(
            error(&POINT.replace(r#""image","#, r#""sound","#)),
            format!(
                r#"expected modality_type "image" or "video" in question 0, found "sound", {place}"#
            )
        );
        assert_eq!(
            error(&format!("{POINT}, {}", POINT.replace("h_pedestrian:2", "h_None"))),
            format!(
                r#"expected ids like "h_pedestrian:12" in question 1, found "h_None", {place}"#
            )
        );
        assert_eq!(
            error(&POINT.replace("000002.jpg", "cover.jpg")),
            format!(
                "expected timestamps.slot1.image_ids with a frame number in question 0, \
                 found [\"cover.jpg\"], {place}"
            )
        );
        assert_eq!(error("{}"), format!("expected a list of JRDB-Reasoning data points {place}"));
    }
}
