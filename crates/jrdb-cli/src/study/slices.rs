//! The scores of a method on parts of the questions: where it is good and where not.

use std::collections::{BTreeMap, BTreeSet};

use jrdb_metrics::slices;
use jrdb_parser::ParserConfig;
use jrdb_pipeline::query::read_or_report;
use jrdb_study::{Cell, Origin, Role, Row, Table, Unit, heading, range_name};
use jrdb_types::query::{Place, RelationKind, Viewpoint};
use jrdb_types::score::{Metric, QuestionScore, Summary};
use jrdb_types::vocab::Occlusion;
use jrdb_types::{Condition, FrameId, Pattern, PixelBox, Query, Question, Scores};

use super::truth::{Facts, PersonFacts};

/// What is shown of each slice.
const METRICS: [Metric; 4] =
    [Metric::Exact, Metric::MapRanking, Metric::MapSelection, Metric::MiouGt];
/// So many people that are meant are shown as one slice.
const MANY: usize = 3;
/// A box of a question and one of the labels are the same person from this IoU on.
const SAME_IOU: f64 = 0.9;

/// The questions of a study and what the labels say of their frames.
#[derive(Clone, Copy)]
pub(super) struct Asked<'a> {
    pub(super) questions: &'a [Question],
    pub(super) facts: &'a Facts,
}

/// A question, and what is known of those who are meant.
struct One<'a> {
    question: &'a Question,
    query: Query,
    period_px: Option<f64>,
    /// Everybody in the frame, where it is labelled.
    people: Option<&'a [PersonFacts]>,
}

/// What questions are sliced by: the name of the key, and the key of a question.
type Key = (&'static str, fn(&One<'_>) -> Option<String>);

const KEYS: [Key; 9] = [
    ("recording", |one| Some(one.question.frame.sequence.clone())),
    ("people meant", people_meant),
    ("range", range),
    ("occlusion", occlusion),
    ("points of a person", points),
    ("people in the frame", crowd),
    ("seam", across_the_seam),
    ("frame of reference", reference),
    ("difficulty", difficulty),
];

/// A row for each value of each key: where those who are meant are, how well they can be seen, and
/// what is asked.
pub(super) fn table(method: &str, asked: Asked<'_>, scores: &Scores) -> Table {
    let period_px = scores.protocol.period_px;
    let named = asked.questions.iter().map(|question| {
        let query = read_or_report(&question.text, &ParserConfig::default());
        let people = asked.facts.get(&question.frame).map(Vec::as_slice);
        ((&question.frame, question.text.as_str()), One { question, query, period_px, people })
    });
    let by_name: BTreeMap<(&FrameId, &str), One<'_>> = named.collect();
    let mut rows = Vec::new();
    for (name, key) in KEYS {
        let of =
            |score: &QuestionScore| key(by_name.get(&(&score.frame, score.question.as_str()))?);
        let mut found: Vec<(String, Summary)> = slices(scores, of).into_iter().collect();
        found.sort_by_key(|(value, _)| first_number(value));
        rows.extend(found.iter().map(|(value, summary)| row(name, value, summary)));
    }
    Table {
        title: format!("{method}: slices"),
        unit: Unit::Percent,
        categories: vec!["questions".into()],
        metrics: METRICS.map(heading).to_vec(),
        rows,
        notes: NOTES.map(Into::into).to_vec(),
    }
}

const NOTES: [&str; 2] = [
    "Range is the mean of those who are meant, occlusion that of the one who is hidden most, points those of the one who has fewest.",
    "Difficulty counts entities (S), relations (R) and times (T), as the benchmark does.",
];

/// The number that a value begins with; values without one come last, in the order of letters.
fn first_number(value: &str) -> u32 {
    let digits = value.split(|c: char| !c.is_ascii_digit()).next();
    digits.and_then(|digits| digits.parse().ok()).unwrap_or(u32::MAX)
}

fn row(name: &str, value: &str, summary: &Summary) -> Row {
    let cell = |metric: Metric| metric.of(summary).map(|value| Cell::plain(100.0 * value));
    Row {
        method: format!("{name} {value} ({})", summary.questions),
        role: Role::Method,
        origin: Origin::Measured,
        cells: METRICS.map(cell).to_vec(),
        failure: None,
    }
}

impl One<'_> {
    fn boxes(&self) -> &[PixelBox] {
        self.question.truth.as_ref().map_or(&[], |truth| &truth.boxes)
    }

    /// What the labels say of those who are meant; none where somebody is not among them.
    fn meant(&self) -> Option<Vec<&PersonFacts>> {
        let people = self.people.filter(|_| !self.boxes().is_empty())?;
        let person = |bbox: &PixelBox| {
            people.iter().find(|one| one.bbox.iou(bbox, self.period_px) >= SAME_IOU)
        };
        self.boxes().iter().map(person).collect()
    }
}

fn people_meant(one: &One<'_>) -> Option<String> {
    let count = one.boxes().len();
    Some(if count < MANY { count.to_string() } else { format!("{MANY} or more") })
}

fn range(one: &One<'_>) -> Option<String> {
    let ranges: Vec<f64> = one.meant()?.iter().map(|one| one.range_m).collect::<Option<_>>()?;
    Some(range_name(ranges.iter().sum::<f64>() / ranges.len() as f64).into())
}

fn occlusion(one: &One<'_>) -> Option<String> {
    let worst = one.meant()?.iter().map(|one| one.occlusion).collect::<Option<Vec<_>>>()?;
    let place = |word: &Occlusion| Occlusion::ALL.iter().position(|one| one == word);
    worst.into_iter().max_by_key(place).map(|word| word.to_string())
}

fn points(one: &One<'_>) -> Option<String> {
    let fewest = one.meant()?.iter().map(|one| one.points).min()??;
    let name = match fewest {
        0..10 => "0 to 9",
        10..100 => "10 to 99",
        100..1000 => "100 to 999",
        _ => "1000 or more",
    };
    Some(name.into())
}

fn crowd(one: &One<'_>) -> Option<String> {
    let name = match one.people?.len() {
        0..5 => "0 to 4",
        5..10 => "5 to 9",
        10..20 => "10 to 19",
        20..40 => "20 to 39",
        _ => "40 or more",
    };
    Some(name.into())
}

fn across_the_seam(one: &One<'_>) -> Option<String> {
    let crosses =
        one.period_px.is_some_and(|period| one.boxes().iter().any(|b| b.x + b.w > period));
    Some(if crosses { "crossed" } else { "not crossed" }.into())
}

/// Whose left and right the question speaks of.
fn reference(one: &One<'_>) -> Option<String> {
    let mut whose = BTreeSet::new();
    viewpoints(&one.query.target, &mut whose);
    let name = match (whose.contains("robot"), whose.contains("person")) {
        (true, true) => "the robot's and a person's",
        (true, false) => "the robot's",
        (false, true) => "a person's",
        (false, false) => "none",
    };
    Some(name.into())
}

fn viewpoints(pattern: &Pattern, whose: &mut BTreeSet<&'static str>) {
    pattern.conditions.iter().for_each(|condition| viewpoints_of(condition, whose));
}

fn viewpoints_of(condition: &Condition, whose: &mut BTreeSet<&'static str>) {
    let is_direction = |place: &Place| matches!(place, Place::Direction(_) | Place::Degrees { .. });
    match condition {
        Condition::FromRobot(place) if is_direction(place) => {
            whose.insert("robot");
        }
        Condition::Related(related) => {
            for kind in &related.kinds {
                match kind {
                    RelationKind::Placed { place, viewpoint } if is_direction(place) => {
                        let is_robot = *viewpoint == Viewpoint::Robot;
                        whose.insert(if is_robot { "robot" } else { "person" });
                    }
                    _ => {}
                }
            }
            viewpoints(&related.partner, whose);
        }
        Condition::Is(pattern) => viewpoints(pattern, whose),
        Condition::Not(inner) => viewpoints_of(inner, whose),
        Condition::Any(parts) | Condition::All(parts) => {
            parts.iter().for_each(|part| viewpoints_of(part, whose));
        }
        _ => {}
    }
}

fn difficulty(one: &One<'_>) -> Option<String> {
    let relations = relations(&one.query.target);
    let times = one.question.slots.len().max(one.query.slots.len()).max(1);
    Some(format!("S{} R{relations} T{times}", relations + 1))
}

/// How many relations a pattern asks for, those of its partners included.
fn relations(pattern: &Pattern) -> usize {
    pattern.conditions.iter().map(relations_of).sum()
}

fn relations_of(condition: &Condition) -> usize {
    match condition {
        Condition::Related(related) => 1 + relations(&related.partner),
        Condition::Is(pattern) => relations(pattern),
        Condition::Not(inner) => relations_of(inner),
        Condition::Any(parts) | Condition::All(parts) => parts.iter().map(relations_of).sum(),
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use jrdb_types::Truth;

    fn asked(text: &str, x: f64) -> Question {
        let truth = Truth { boxes: vec![PixelBox::from([x, 0.0, 50.0, 90.0])], ..Truth::default() };
        Question { truth: Some(truth), ..Question::typed(text, FrameId::default()) }
    }

    fn one<'a>(question: &'a Question, people: Option<&'a [PersonFacts]>) -> One<'a> {
        let query = read_or_report(&question.text, &ParserConfig::default());
        One { question, query, period_px: Some(1000.0), people }
    }

    #[test]
    fn questions_are_sliced_by_what_they_ask_and_where_the_answer_is() {
        let (near, plain) =
            (asked("Who is the woman left of a child?", 980.0), asked("Find all men", 0.0));
        let says = |key: fn(&One<'_>) -> Option<String>, of| key(&one(of, None)).unwrap();
        assert_eq!(says(difficulty, &near), "S2 R1 T1");
        assert_eq!(says(difficulty, &plain), "S1 R0 T1");
        assert_eq!(says(across_the_seam, &near), "crossed");
        assert_eq!(says(people_meant, &near), "1");
        assert_eq!(says(reference, &plain), "none");
        assert_eq!(says(reference, &asked("Find the man on your left", 0.0)), "the robot's");
        assert_eq!(range(&one(&near, None)), None);
    }

    #[test]
    fn labels_tell_how_far_and_how_visible_those_who_are_meant_are() {
        let person = |x: f64, range_m, occlusion, points| PersonFacts {
            bbox: PixelBox::from([x, 0.0, 50.0, 90.0]),
            range_m: Some(range_m),
            occlusion: Some(occlusion),
            points: Some(points),
        };
        let people = [
            person(100.0, 4.0, Occlusion::SeverelyOccluded, 12),
            person(300.0, 40.0, Occlusion::FullyVisible, 5),
        ];
        let (question, nobody) = (asked("Find all men", 100.0), asked("Find all men", 700.0));
        let meant = one(&question, Some(&people));
        let said = [range, occlusion, points, crowd].map(|key| key(&meant).unwrap());
        assert_eq!(said, ["3 to 6 m", "severely occluded", "10 to 99", "0 to 4"]);
        assert_eq!(range(&one(&nobody, Some(&people))), None);
    }
}
