//! The baselines of the paper: the detector answers a whole sentence by itself, without points, graph and search.

use jrdb_perception::{Grounding, View};
use jrdb_types::answer::{Cause, CauseKind, Count, Ranked, Reply};
use jrdb_types::{Answer, Capabilities, Detections, EntityId, FrameId, Issue, Query, Status, Task};

use crate::{Error, Frame, Pipeline, PipelineConfig, Scene};

/// The answers of the detector alone to some questions, and the scene that they point to. Every box that the detector is
/// sure enough of is meant.
///
/// # Errors
/// [`Error::NoGrounder`] when the detector takes no sentences, [`Error::Perception`] when its model fails. Without an
/// image every answer is open, and its cause says so.
pub fn answer(
    pipeline: &Pipeline,
    frame: Frame,
    queries: &[&Query],
) -> Result<(Scene, Vec<Answer>), Error> {
    let (id, geometry) = (frame.id.clone(), pipeline.robot().image());
    let mut all = Detections::new(id, geometry, Vec::new());
    let mut answers = Vec::new();
    for (query, found) in queries.iter().zip(grounded(pipeline, &frame, queries)?) {
        match found {
            Ok(mut found) => {
                rename(&mut found, all.detections.len());
                answers.push(answer_of(&found, query, pipeline.config()));
                all.detections.extend(found.detections);
                all.issues.extend(found.issues);
            }
            Err(issue) => {
                answers.push(open(&frame.id, query, &issue, pipeline.config()));
                all.issues.push(issue);
            }
        }
    }
    all.issues.dedup();
    if !queries.is_empty() && answers.iter().all(|answer| answer.status == Status::Unknown) {
        all.capabilities = Some(Capabilities::none());
    }
    all.detections.sort_by(|a, b| a.id.cmp(&b.id));
    Ok((pipeline.unplaced(frame, all)?, answers))
}

/// What the detector finds for each question, or why that is not known.
fn grounded(
    pipeline: &Pipeline,
    frame: &Frame,
    queries: &[&Query],
) -> Result<Vec<Grounding>, Error> {
    let perception = pipeline.perception();
    let grounder = perception.grounder().ok_or(Error::NoGrounder)?;
    let camera = frame.images.first().filter(|_| perception.looks_at_images());
    let image = match camera.map(crate::CameraImage::pixels).transpose() {
        Ok(image) => image,
        Err(issue) => return Ok(vec![Err(issue.clone()); queries.len()]),
    };
    let view = View { geometry: pipeline.robot().image(), image };
    let sentences: Vec<&str> = queries.iter().map(|query| query.text.as_str()).collect();
    let fail = |source| Error::Perception { frame: frame.id.clone(), source };
    grounder.ground(&frame.id, &view, &sentences).map_err(fail)
}

/// Gives boxes names that no other question's boxes have.
fn rename(found: &mut Detections, used: usize) {
    for (number, detection) in (used + 1..).zip(&mut found.detections) {
        let number = u32::try_from(number).unwrap_or(u32::MAX);
        detection.id = EntityId::new(&detection.category, number);
    }
}

fn answer_of(found: &Detections, query: &Query, config: &PipelineConfig) -> Answer {
    let mut ranking: Vec<Ranked> = found
        .detections
        .iter()
        .map(|one| Ranked { id: one.id.clone(), bbox: one.bbox, probability: one.score })
        .collect();
    ranking.sort_by(|a, b| b.probability.total_cmp(&a.probability).then(a.id.cmp(&b.id)));
    let mut selection: Vec<EntityId> = ranking.iter().map(|one| one.id.clone()).collect();
    selection.sort();
    let (policy, lateral) = (config.search.policy, config.projection.lateral);
    let mut answer = Answer::new(found.frame.clone(), query, policy, lateral);
    answer.reply = match &query.task {
        Task::Count => Reply::Number(Count::Exact(selection.len())),
        Task::Exists(quantity) => Reply::YesNo(Some(quantity.holds(selection.len()))),
        _ => Reply::Things,
    };
    answer.issues.clear();
    (answer.selection, answer.ranking) = (selection, ranking);
    answer
}

/// The answer of a detector that had no image to look at.
fn open(frame: &FrameId, query: &Query, why: &Issue, config: &PipelineConfig) -> Answer {
    let (policy, lateral) = (config.search.policy, config.projection.lateral);
    let message = why.message.clone();
    let because = vec![Cause { kind: CauseKind::Sensor, message, span: None }];
    let reply = match &query.task {
        Task::Count => Reply::Number(Count::between(0, None)),
        Task::Exists(_) | Task::CompareCounts { .. } => Reply::YesNo(None),
        _ => Reply::Things,
    };
    let answer = Answer::new(frame.clone(), query, policy, lateral);
    Answer { status: Status::Unknown, because, reply, ..answer }
}
