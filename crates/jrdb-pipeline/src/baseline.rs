//! The baselines of the paper: the detector answers a whole sentence by itself, without points, graph and search.

use jrdb_types::answer::{Ranked, Reply};
use jrdb_types::{Answer, Detections, EntityId, Query, Task};

use crate::{Error, Frame, Pipeline, PipelineConfig, Scene};

/// The answers of the detector alone to some questions, and the scene that they point to. Every box that the detector is
/// sure enough of is meant.
///
/// # Errors
/// [`Error::NoGrounder`] when the detector takes no sentences, [`Error::Perception`] when its model fails. Without an
/// image nothing is answered, and an issue says so.
pub fn answer(
    pipeline: &Pipeline,
    frame: Frame,
    queries: &[&Query],
) -> Result<(Scene, Vec<Answer>), Error> {
    let (id, image) = (frame.id.clone(), pipeline.robot().image());
    let mut all = Detections { frame: id, image, detections: Vec::new(), issues: Vec::new() };
    let mut answers = Vec::new();
    match frame.images.first().map(crate::CameraImage::pixels) {
        Some(Ok(pixels)) => {
            let grounder = pipeline.perception().grounder().ok_or(Error::NoGrounder)?;
            for query in queries {
                let found = grounder.ground(pixels, &frame.id, &query.text);
                let fail = |source| Error::Perception { frame: frame.id.clone(), source };
                let mut found = found.map_err(fail)?;
                rename(&mut found, all.detections.len());
                answers.push(answer_of(&found, query, pipeline.config()));
                all.detections.extend(found.detections);
            }
        }
        Some(Err(issue)) => all.issues.push(issue.clone()),
        None => {}
    }
    all.detections.sort_by(|a, b| a.id.cmp(&b.id));
    Ok((pipeline.see_detections(frame, all)?, answers))
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
    let reply = match &query.task {
        Task::Count => Reply::Number(selection.len()),
        Task::Exists(quantity) => Reply::YesNo(quantity.holds(selection.len())),
        _ => Reply::Things,
    };
    Answer {
        frame: found.frame.clone(),
        question: query.text.clone(),
        task: query.task.clone(),
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
