//! What separates an answer from the truth.

use jrdb_types::score::Miss;
use jrdb_types::{Detection, PixelBox};

use crate::{MetricsConfig, Outcome};

/// What is missing from an answer, in the order of the truth, then what is too much, in the order of
/// `detections`, which are all things of the frame.
///
/// Boxes are compared as in [`score`](crate::score). Nothing where the truth is unknown.
///
/// ```
/// use jrdb_metrics::{MetricsConfig, Outcome, misses};
/// use jrdb_types::score::Miss;
/// use jrdb_types::vocab::MatchPolicy;
/// use jrdb_types::*;
/// let (frame, query) = (FrameId::default(), Query::default());
/// let nobody = Answer::new(frame.clone(), &query, MatchPolicy::Ranked, LateralConvention::Physical);
/// let bbox = PixelBox::from([10.0, 10.0, 40.0, 90.0]);
/// let truth = Truth { boxes: vec![bbox], ..Truth::default() };
/// let question = Question {
///     id: None,
///     query: None,
///     text: "Find all men".into(), category: "gender".into(), frame, slots: vec![], truth: Some(truth),
/// };
/// let outcome = Outcome { question: &question, answer: &nobody };
/// assert_eq!(misses(outcome, &[], &MetricsConfig::default()), [Miss::NotDetected(bbox)]);
/// ```
#[must_use]
pub fn misses(
    Outcome { question, answer }: Outcome<'_>,
    detections: &[Detection],
    config: &MetricsConfig,
) -> Vec<Miss> {
    let Some(truth) = &question.truth else { return Vec::new() };
    let iou = |a: &PixelBox, b: &PixelBox| a.iou(b, config.circle_px());
    let is_same = |a: &PixelBox, b: &PixelBox| iou(a, b) >= config.match_iou;
    let is_selected = |one: &&Detection| answer.selection.contains(&one.id);
    let selected = || detections.iter().filter(is_selected);
    let is_answered = |there: &PixelBox| selected().any(|found| is_same(there, &found.bbox));
    let missing = truth.boxes.iter().filter(|there| !is_answered(there)).map(|there| {
        let best =
            detections.iter().max_by(|a, b| iou(there, &a.bbox).total_cmp(&iou(there, &b.bbox)));
        match best.filter(|one| is_same(there, &one.bbox)) {
            Some(one) => Miss::NotSelected(one.id.clone()),
            None => Miss::NotDetected(*there),
        }
    });
    let is_meant = |found: &Detection| truth.boxes.iter().any(|there| is_same(there, &found.bbox));
    let wrong = selected().filter(|found| !is_meant(found));
    missing.chain(wrong.map(|found| Miss::NotMeant(found.id.clone()))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use jrdb_types::vocab::MatchPolicy;
    use jrdb_types::{Answer, EntityId, FrameId, LateralConvention, Query, Question, Truth};

    const PERIOD_PX: f64 = 3760.0;

    fn at(x: f64) -> PixelBox {
        PixelBox::from([x, 10.0, 40.0, 100.0])
    }

    fn id(number: u32) -> EntityId {
        EntityId::new("pedestrian", number)
    }

    /// People 1, 2 … at these columns; who is meant, and who is selected.
    fn of(
        columns: &[f64],
        true_boxes: &[f64],
        selected: &[u32],
        config: &MetricsConfig,
    ) -> Vec<Miss> {
        let (frame, lateral) = (FrameId::default(), LateralConvention::Physical);
        let detected = |(number, &x)| Detection::new(id(number), "pedestrian", 0.9, at(x));
        let detections: Vec<Detection> = (1..).zip(columns).map(detected).collect();
        let mut answer =
            Answer::new(frame.clone(), &Query::default(), MatchPolicy::Ranked, lateral);
        answer.selection = selected.iter().map(|&number| id(number)).collect();
        let boxes = true_boxes.iter().map(|&x| at(x)).collect();
        let question = Question {
            id: None,
            query: None,
            text: "Find them".into(),
            category: "any".into(),
            frame,
            slots: vec![],
            truth: Some(Truth { boxes, ..Truth::default() }),
        };
        misses(Outcome { question: &question, answer: &answer }, &detections, config)
    }

    #[test]
    fn each_miss_has_its_kind() {
        let found =
            of(&[100.0, 200.0, 300.0], &[101.0, 201.0, 900.0], &[1, 3], &MetricsConfig::default());
        let expected =
            [Miss::NotSelected(id(2)), Miss::NotDetected(at(900.0)), Miss::NotMeant(id(3))];
        assert_eq!(found, expected);
    }

    #[test]
    fn the_seam_is_crossed_only_where_scores_cross_it() {
        let planar = MetricsConfig { period_px: Some(PERIOD_PX), ..MetricsConfig::default() };
        let circular =
            MetricsConfig { iou: jrdb_types::score::IouKind::Circular, ..planar.clone() };
        let (there, found) = (PERIOD_PX - 2.0, -2.0);
        assert_eq!(of(&[found], &[there], &[1], &circular), []);
        assert_eq!(
            of(&[found], &[there], &[1], &planar),
            [Miss::NotDetected(at(there)), Miss::NotMeant(id(1))]
        );
    }
}
