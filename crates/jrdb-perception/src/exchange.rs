//! Perception by an external model: requests and replies as JSON Lines.
//!
//! A line holds a request and, once there is one, its reply. Lines without a reply are requests to
//! an external model, such as a script or a server. Lines with replies are read back and replayed;
//! a recording of a model has the same form.

use std::collections::BTreeMap;

use jrdb_types::detection::PERSON;
use jrdb_types::issue::IssueKind;
use jrdb_types::{
    Attributes, Capabilities, Detection, Detections, FrameId, ImageGeometry, Issue, PixelBox,
    Vocabulary,
};
use serde::{Deserialize, Serialize};

use crate::detector::PerceptionError;
use crate::numbered::{CategoryBox, category, numbered};
use crate::prompts::{JsonBox, Question, Topic, believed, label_in, put, questions, text_boxes};

/// One line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Exchange {
    /// The request.
    pub request: Request,
    /// The reply.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reply: Option<Reply>,
}

/// A question about a picture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Request {
    /// The frame.
    pub frame: FrameId,
    /// The picture to look at, from the folder of the exchange: the panorama, or the part in `box`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub image: Option<String>,
    /// The part of the panorama, pixels; absent for the whole panorama. A request with a box asks
    /// for an attribute of the person in it; a request without one asks for detections.
    #[serde(rename = "box", default, skip_serializing_if = "Option::is_none")]
    pub bbox: Option<PixelBox>,
    /// Which attribute of the person in the box.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub topic: Option<Topic>,
    /// The phrase that may be true of the person or object in the box, instead of a topic: "striped
    /// shirt". The labels are `yes` and `no`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub looks: Option<String>,
    /// The question in words.
    pub prompt: String,
    /// A whole question: the boxes of the reply are its answer. Such a line is part of a baseline and
    /// says nothing about what else is in the picture.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sentence: Option<String>,
    /// The words to choose from.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub labels: Vec<String>,
}

/// An answer; one of its fields is enough.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reply {
    /// Text: one of the labels, possibly in a sentence; or boxes in JSON or between marks, in the
    /// forms of vision-language models.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub text: Option<String>,
    /// Width and height that the coordinates in `text` refer to: those of the picture as the model
    /// saw it, pixels, or `[1000, 1000]` or `[1, 1]` for relative ones; those of the panorama when absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size: Option<[f64; 2]>,
    /// Probabilities of the labels.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub probabilities: Option<BTreeMap<String, f64>>,
    /// The detections, pixels of the panorama.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub found: Option<Vec<Found>>,
}

/// A detection.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Found {
    /// Its category; every word for a person becomes `person`.
    pub label: String,
    /// Where, pixels of the panorama.
    #[serde(rename = "box")]
    pub bbox: PixelBox,
    /// Confidence in `[0, 1]`.
    #[serde(default = "certain")]
    pub score: f64,
}

fn certain() -> f64 {
    1.0
}

/// The prompt that asks a model a whole question.
#[must_use]
pub fn whole_question(sentence: &str) -> String {
    format!(
        "{sentence} Locate who is meant in the image. Answer in JSON: [{{\"bbox_2d\": [x0, y0, x1, y1]}}], [] for nobody."
    )
}

/// The prompt that asks a model for all detections.
pub const FIND: &str = "Locate every person and every object in the image. Answer in JSON: [{\"label\": name, \"bbox_2d\": [x0, y0, x1, y1]}].";

impl Exchange {
    /// Whether the line is a whole question, whose boxes are an answer.
    #[must_use]
    pub fn is_whole_question(&self) -> bool {
        self.request.sentence.is_some()
    }

    /// Reads the lines of a file. Empty lines are skipped.
    ///
    /// # Errors
    /// [`PerceptionError::Line`] with the number of the first line that is not an exchange.
    pub fn read_lines(text: &str) -> Result<Vec<Self>, PerceptionError> {
        let lines = (1..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty());
        let read = |(number, line): (usize, &str)| {
            serde_json::from_str(line).map_err(|source| PerceptionError::Line { number, source })
        };
        lines.map(read).collect()
    }

    /// A recording: the requests and replies that reproduce these detections. Attributes on
    /// `topics` that are unknown become requests without a reply.
    #[must_use]
    pub fn record(detections: &Detections, topics: &[Topic]) -> Vec<Self> {
        let found = |detection: &Detection| Found {
            label: detection.category.clone(),
            bbox: detection.bbox,
            score: detection.score,
        };
        let find = Self {
            request: Request {
                frame: detections.frame.clone(),
                image: None,
                bbox: None,
                topic: None,
                looks: None,
                prompt: FIND.into(),
                sentence: None,
                labels: Vec::new(),
            },
            reply: Some(Reply {
                found: Some(detections.detections.iter().map(found).collect()),
                ..Reply::default()
            }),
        };
        let people = detections.detections.iter().filter(|one| one.category == PERSON);
        let asked = people.flat_map(|person| questions_about(&detections.frame, person, topics));
        std::iter::once(find).chain(asked).collect()
    }
}

fn questions_about(frame: &FrameId, person: &Detection, topics: &[Topic]) -> Vec<Exchange> {
    let ask = |question: Question| {
        let labels: Vec<String> = question.labels.iter().map(|all| all[0].clone()).collect();
        let known = believed(&person.attributes, question.topic);
        let probabilities: BTreeMap<String, f64> =
            labels.iter().cloned().zip(known).filter(|(_, p)| *p > 0.0).collect();
        let reply = Reply { probabilities: Some(probabilities), ..Reply::default() };
        Exchange {
            reply: reply.probabilities.as_ref().is_some_and(|all| !all.is_empty()).then_some(reply),
            request: Request {
                frame: frame.clone(),
                image: None,
                bbox: Some(person.bbox),
                topic: Some(question.topic),
                looks: None,
                prompt: question.text,
                sentence: None,
                labels,
            },
        }
    };
    questions(topics).into_iter().map(ask).collect()
}

/// The detections that the replies for one frame describe. A missing or unusable reply is reported
/// as an issue.
///
/// If no line asks for detections, the boxes of the other requests are people.
#[must_use]
pub fn replay(lines: &[Exchange], frame: &FrameId, image: ImageGeometry) -> Detections {
    let all = lines;
    let is_about = |line: &&Exchange| line.request.frame == *frame && !line.is_whole_question();
    let lines: Vec<&Exchange> = all.iter().filter(is_about).collect();
    let mut issues = Vec::new();
    if lines.is_empty() {
        issues.push(Issue::new(IssueKind::MissingInput, no_line_for(all, frame)));
    }
    let mut found: Vec<CategoryBox> = Vec::new();
    let searches: Vec<_> = lines.iter().filter(|line| line.request.bbox.is_none()).collect();
    for line in &searches {
        match boxes_in(line.reply.as_ref(), image) {
            Ok(boxes) => found.extend(boxes),
            Err(message) => issues.push(Issue::new(IssueKind::MissingInput, message)),
        }
    }
    if searches.is_empty() {
        for bbox in lines.iter().filter_map(|line| line.request.bbox) {
            if !found.iter().any(|one| one.bbox == bbox) {
                found.push(CategoryBox { bbox, score: 1.0, category: PERSON.into() });
            }
        }
    }
    let found = usable(found, image, &mut issues);
    let mut detections = numbered(found);
    for detection in &mut detections {
        let place = |bbox: PixelBox| image.checked_box(bbox).ok();
        let is_about =
            |line: &&&Exchange| line.request.bbox.and_then(place) == Some(detection.bbox);
        let about = lines.iter().filter(is_about);
        for line in about {
            let Some(topic) = line.request.topic else { continue };
            if let Err(message) = apply_reply(&mut detection.attributes, topic, line) {
                issues.push(Issue::about(IssueKind::NotDescribed, &detection.id, message));
            }
        }
    }
    Detections { issues, ..Detections::new(frame.clone(), image, detections) }
}

/// The boxes of the reply to a whole question, as people; boxes that are not in the image are left
/// out with an issue.
///
/// # Errors
/// The issue of a line without a usable reply.
pub fn grounded(line: &Exchange, image: ImageGeometry) -> Result<Detections, Issue> {
    let frame = &line.request.frame;
    let found = boxes_in(line.reply.as_ref(), image)
        .map_err(|message| Issue::new(IssueKind::MissingInput, message))?;
    let mut issues = Vec::new();
    let people = found.into_iter().map(|one| CategoryBox { category: PERSON.into(), ..one });
    let detections = numbered(usable(people.collect(), image, &mut issues));
    Ok(Detections { issues, ..Detections::new(frame.clone(), image, detections) })
}

/// What the model behind some lines can see: the categories that any reply names, people where only people are asked
/// about, and the attributes that any line asks for.
#[must_use]
pub fn capabilities(lines: &[Exchange]) -> Capabilities {
    let lines = || lines.iter().filter(|line| !line.is_whole_question());
    let searches = || lines().filter(|line| line.request.bbox.is_none());
    // Categories do not depend on the size of the image.
    let any_size = ImageGeometry { width_px: 1, height_px: 1, wraps: false };
    let boxes = |line: &Exchange| boxes_in(line.reply.as_ref(), any_size).unwrap_or_default();
    let mut categories: Vocabulary<String> =
        searches().flat_map(boxes).map(|one| one.category).collect();
    if searches().next().is_none() && lines().next().is_some() {
        categories.unite(std::iter::once(PERSON.into()).collect());
    }
    let topics = lines().filter_map(|line| line.request.topic);
    let attributes = topics.filter_map(Topic::attribute).collect();
    Capabilities { categories, attributes, ..Capabilities::none() }
}

/// Why a frame has no detections when no line is about it.
fn no_line_for(all: &[Exchange], frame: &FrameId) -> String {
    let sequence = &frame.sequence;
    let is_same = |line: &&Exchange| line.request.frame.sequence == *sequence;
    let others = all.iter().filter(is_same).count();
    match all.first() {
        None => "the recording of replies has no line".into(),
        Some(_) if others > 0 => format!(
            "the recording of replies has no line for {frame}, but {others} for other frames of {sequence}"
        ),
        Some(line) => format!(
            "the recording of replies has no line for {frame}; its first is about {}",
            line.request.frame
        ),
    }
}

/// The boxes that lie in the image; each other is an issue.
fn usable(
    found: Vec<CategoryBox>,
    image: ImageGeometry,
    issues: &mut Vec<Issue>,
) -> Vec<CategoryBox> {
    let mut check = |one: CategoryBox| match image.checked_box(one.bbox) {
        Ok(bbox) => Some(CategoryBox { bbox, ..one }),
        Err(error) => {
            let message = format!("a {:?} of the reply is left out: {error}", one.category);
            issues.push(Issue::new(IssueKind::BadBox, message));
            None
        }
    };
    found.into_iter().filter_map(&mut check).collect()
}

/// The boxes in a reply, pixels of the image.
fn boxes_in(reply: Option<&Reply>, image: ImageGeometry) -> Result<Vec<CategoryBox>, String> {
    let reply = reply.ok_or("no reply to what is in the image")?;
    if let Some(found) = &reply.found {
        let score =
            |one: &Found| if one.score.is_finite() { one.score.clamp(0.0, 1.0) } else { 0.0 };
        let read = |one: &Found| CategoryBox {
            bbox: one.bbox,
            score: score(one),
            category: category(&one.label),
        };
        return Ok(found.iter().map(read).collect());
    }
    let text = reply.text.as_deref().ok_or("expected found or text in the reply, found neither")?;
    let full_px = [f64::from(image.width_px), f64::from(image.height_px)];
    let scale = reply.size.map_or([1.0; 2], |[w, h]| [full_px[0] / w, full_px[1] / h]);
    let boxes = text_boxes(text, scale).map_err(|error| format!("{error}: {text:?}"))?;
    let read = |one: JsonBox| {
        let [x0, y0, x1, y1] = one.corners;
        let label = if one.label.is_empty() { PERSON } else { &one.label };
        let bbox = PixelBox { x: x0, y: y0, w: x1 - x0, h: y1 - y0 };
        CategoryBox { bbox, score: 1.0, category: category(label) }
    };
    Ok(boxes.into_iter().map(read).collect())
}

/// Writes the reply on a topic into the attributes of a person.
fn apply_reply(attributes: &mut Attributes, topic: Topic, line: &Exchange) -> Result<(), String> {
    let Some(question) = questions(&[topic]).pop() else { return Ok(()) };
    let reply =
        line.reply.as_ref().ok_or_else(|| format!("no reply to {:?}", line.request.prompt))?;
    if let Some(probabilities) = &reply.probabilities {
        let of = |spellings: &Vec<String>| -> f64 {
            spellings
                .iter()
                .filter_map(|one| probabilities.get(one))
                .filter(|p| p.is_finite())
                .sum()
        };
        let all: Vec<f64> = question.labels.iter().map(of).map(|p| p.clamp(0.0, 1.0)).collect();
        put(attributes, topic, &all);
        return Ok(());
    }
    let text = reply
        .text
        .as_deref()
        .ok_or("expected probabilities or text in the reply, found neither")?;
    let index = label_in(text, &question.labels).ok_or_else(|| {
        format!("expected one of {}, found {text:?}", line.request.labels.join(", "))
    })?;
    let all: Vec<f64> =
        (0..question.labels.len()).map(|at| if at == index { 1.0 } else { 0.0 }).collect();
    put(attributes, topic, &all);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use jrdb_types::vocab::{Age, Gender};
    use jrdb_types::{Belief, EntityId};

    const IMAGE: ImageGeometry = ImageGeometry { width_px: 100, height_px: 50, wraps: true };

    fn at(bbox: [f64; 4], score: f64, category: &str) -> CategoryBox {
        CategoryBox { bbox: bbox.into(), score, category: category.into() }
    }

    fn detections() -> Detections {
        let mut found = numbered(vec![
            at([10.0, 5.0, 8.0, 20.0], 0.9, "person"),
            at([95.0, 5.0, 9.0, 20.0], 0.8, "chair"),
        ]);
        let person = found.iter_mut().find(|one| one.category == PERSON).unwrap();
        person.attributes.set_age(Belief([(Age::Young, 0.75), (Age::Adolescent, 0.25)].into()));
        Detections {
            frame: FrameId::default(),
            image: IMAGE,
            detections: found,
            capabilities: None,
            issues: Vec::new(),
        }
    }

    #[test]
    fn a_recording_replays_what_was_recorded() {
        let lines = Exchange::record(&detections(), &[Topic::Age]);
        let text: Vec<String> =
            lines.iter().map(|line| serde_json::to_string(line).unwrap()).collect();
        let read = Exchange::read_lines(&text.join("\n")).unwrap();
        assert_eq!(read, lines);
        assert_eq!(replay(&read, &FrameId::default(), IMAGE), detections());
    }

    #[test]
    fn what_is_not_known_is_asked_and_may_be_answered_in_words() {
        let mut lines = Exchange::record(&detections(), &[Topic::Gender]);
        assert_eq!(lines[1].reply, None);
        let silent = replay(&lines, &FrameId::default(), IMAGE);
        assert_eq!(silent.issues[0].subject, Some(EntityId::new("person", 1)));
        let say = |text: &str| Some(Reply { text: Some(text.into()), ..Reply::default() });
        lines[1].reply = say("She is a woman.");
        let described = replay(&lines, &FrameId::default(), IMAGE);
        let person = described.detections.iter().find(|one| one.category == PERSON).unwrap();
        assert_eq!(person.attributes.gender().best(), Some(Gender::Female));
        lines[1].reply = say("I cannot say.");
        let unclear = replay(&lines, &FrameId::default(), IMAGE);
        assert!(unclear.issues[0].message.contains("expected one of male, female"));
    }

    #[test]
    fn boxes_that_cannot_be_used_are_issues() {
        let mut lines = Exchange::record(&detections(), &[]);
        let found = lines[0].reply.as_mut().unwrap().found.as_mut().unwrap();
        found[0].bbox.w = -8.0;
        found[1].bbox.x = 1e12;
        let replayed = replay(&lines, &FrameId::default(), IMAGE);
        assert!(replayed.detections.is_empty());
        let messages: Vec<&str> = replayed.issues.iter().map(|one| &*one.message).collect();
        assert!(messages[0].contains("expected a box with an area"), "{messages:?}");
        assert!(messages[1].contains("expected a box inside"), "{messages:?}");
    }

    #[test]
    fn a_frame_without_a_line_is_an_issue() {
        let here = FrameId { sequence: "plaza_0".into(), frame: 0 };
        let said = |lines: &[Exchange]| replay(lines, &here, IMAGE).issues[0].message.clone();
        assert_eq!(said(&[]), "the recording of replies has no line");
        let mut lines = Exchange::record(&detections(), &[]);
        lines[0].request.frame.sequence = "plaza_O".into();
        assert!(said(&lines).contains("no line for plaza_0/000000; its first is about plaza_O"));
        lines[0].request.frame = FrameId { frame: 4, ..here.clone() };
        assert!(said(&lines).contains("but 1 for other frames of plaza_0"));
    }

    #[test]
    fn boxes_in_words_are_people_and_errors_name_the_line() {
        let text = "\n{\"request\": {\"frame\": {\"sequence\": \"\", \"frame\": 0}, \"prompt\": \"?\"}, \
             \"reply\": {\"text\": \"[{\\\"bbox_2d\\\": [1, 2, 5, 20]}]\"}}";
        let read = Exchange::read_lines(text).unwrap();
        let replayed = replay(&read, &FrameId::default(), IMAGE);
        assert_eq!(replayed.detections[0].bbox, PixelBox::from([1.0, 2.0, 4.0, 18.0]));
        let error = Exchange::read_lines("{}\n").unwrap_err().to_string();
        assert!(error.contains("line 1"), "{error}");
    }
}
