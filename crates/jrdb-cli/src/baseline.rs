//! The baselines of the paper: the detector answers a whole sentence by itself, without points, graph and search.

use jrdb_types::answer::{Ranked, Reply};
use jrdb_types::{Answer, Detections, EntityId, Image, Issue, Question, Task};

use crate::Error;
use crate::perceive::Perceiver;
use crate::source::FrameSource;
use jrdb_pipeline::query::{read_or_report, speaks_of_time};
use jrdb_pipeline::{Asked, PipelineConfig};

/// The answers to a frame's questions, and all that they point to. Every box that the detector is sure enough of is meant.
///
/// # Errors
/// When the detector takes no sentences, or its model fails. Without a picture nothing is answered, and an issue says so.
pub(crate) fn answer(
    frame: &FrameSource,
    image: &Result<Image, Issue>,
    questions: &[Question],
    perceiver: &Perceiver,
    config: &PipelineConfig,
) -> Result<(Detections, Vec<Asked>), Error> {
    let (id, geometry) = (frame.id.clone(), frame.robot.image);
    let mut all =
        Detections { frame: id, image: geometry, detections: Vec::new(), issues: Vec::new() };
    let image = match image {
        Ok(image) => image,
        Err(issue) => {
            all.issues.push(issue.clone());
            return Ok((all, Vec::new()));
        }
    };
    let mut asked = Vec::new();
    for question in questions {
        let query = read_or_report(&question.text, &config.parser);
        if speaks_of_time(question, &query) {
            continue;
        }
        let mut found = perceiver.ground(frame, image, &question.text)?;
        rename(&mut found, all.detections.len());
        let answer = told(&found, question, query.task.clone(), config);
        all.detections.extend(found.detections);
        asked.push(Asked { question: question.clone(), query, answer });
    }
    all.detections.sort_by(|a, b| a.id.cmp(&b.id));
    Ok((all, asked))
}

/// Gives boxes names that no other question's boxes have.
fn rename(found: &mut Detections, used: usize) {
    for (number, detection) in (used + 1..).zip(&mut found.detections) {
        let number = u32::try_from(number).unwrap_or(u32::MAX);
        detection.id = EntityId::new(&detection.category, number);
    }
}

fn told(found: &Detections, question: &Question, task: Task, config: &PipelineConfig) -> Answer {
    let mut ranking: Vec<Ranked> = found
        .detections
        .iter()
        .map(|one| Ranked { id: one.id.clone(), bbox: one.bbox, probability: one.score })
        .collect();
    ranking.sort_by(|a, b| b.probability.total_cmp(&a.probability).then(a.id.cmp(&b.id)));
    let mut selection: Vec<EntityId> = ranking.iter().map(|one| one.id.clone()).collect();
    selection.sort();
    let reply = match &task {
        Task::Count => Reply::Number(selection.len()),
        Task::Exists(quantity) => Reply::YesNo(quantity.holds(selection.len())),
        _ => Reply::Things,
    };
    Answer {
        frame: found.frame.clone(),
        question: question.text.clone(),
        task,
        policy: config.search.policy,
        lateral: config.projection.lateral,
        reply,
        selection,
        ranking,
        trace: Vec::new(),
        slots: Vec::new(),
        sensitivity: Vec::new(),
        issues: Vec::new(),
    }
}
