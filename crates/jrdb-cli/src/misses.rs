//! What led to an answer that is not the truth.

use jrdb_pipeline::Scene;
use jrdb_types::{EntityId, PixelBox};

use crate::questions::Answered;

/// Boxes that overlap by this IoU show the same thing, as in the scores.
const SAME_IOU: f64 = 0.5;

/// For each thing that is missing from an answer, or does not belong into it, why, in words.
#[must_use]
pub fn reasons(answered: &Answered, scene: &Scene) -> Vec<String> {
    let Some(truth) = &answered.question.truth else { return Vec::new() };
    let period_px = scene.detections().image.period_px();
    let same = |a: &PixelBox, b: &PixelBox| a.iou(b, period_px) >= SAME_IOU;
    let entities = &scene.entities().entities;
    let answer = &answered.answer;
    let selected: Vec<(&EntityId, &PixelBox)> = entities
        .iter()
        .filter(|entity| answer.selection.contains(&entity.id))
        .map(|entity| (&entity.id, &entity.bbox))
        .collect();
    let is_missing = |there: &&PixelBox| !selected.iter().any(|(_, found)| same(there, found));
    let missing = truth.boxes.iter().filter(is_missing).map(|there| {
        let iou = |bbox: &PixelBox| there.iou(bbox, period_px);
        let best = entities.iter().max_by(|a, b| iou(&a.bbox).total_cmp(&iou(&b.bbox)));
        match best.filter(|entity| same(there, &entity.bbox)) {
            Some(entity) => {
                let why = jrdb_render::why_not(answer, &entity.id).replace('\n', "; ");
                format!("{} is not chosen: {why}", entity.id.short())
            }
            None => format!("nothing was detected at {:.0}, {:.0} px", there.x, there.y),
        }
    });
    let is_wrong =
        |(_, found): &&(&EntityId, &PixelBox)| !truth.boxes.iter().any(|there| same(there, found));
    let wrong = selected.iter().filter(is_wrong);
    let wrong = wrong.map(|(id, _)| format!("{} is not meant", id.short()));
    missing.chain(wrong).collect()
}
