//! Scores of the answers to a list of questions.

use std::collections::{BTreeMap, BTreeSet};

use jrdb_types::score::{IouKind, QuestionScore, Summary};
use jrdb_types::{Answer, EntityId, PixelBox, Question, Scores, Truth};
use serde::{Deserialize, Serialize};

use crate::coco::{self, Area, Dataset, DetectionBox, GroundTruthBox};
use crate::matching::match_boxes;

/// How answers are scored.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MetricsConfig {
    /// IoU on the plane (official) or on the circle.
    pub iou: IouKind,
    /// Circumference of the panorama, pixels. Without it IoU is planar whatever `iou` says, and
    /// [`Scores::iou`] tells so.
    pub period_px: Option<f64>,
    /// Least IoU of a match.
    pub match_iou: f64,
}

impl Default for MetricsConfig {
    /// As the JRDB-Reasoning evaluator: on the plane, a match from 0.5.
    fn default() -> Self {
        Self { iou: IouKind::Planar, period_px: None, match_iou: 0.5 }
    }
}

impl MetricsConfig {
    pub(crate) fn circle_px(&self) -> Option<f64> {
        self.period_px.filter(|period| self.iou == IouKind::Circular && *period > 0.0)
    }
}

/// A question and the answer that was given to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outcome<'a> {
    /// What was asked, with its truth.
    pub question: &'a Question,
    /// What was answered.
    pub answer: &'a Answer,
}

/// Scores answers; questions without a known answer are left out.
///
/// The boxes of a selection are looked up in the answer's ranking; a selected id without a box counts
/// as a false positive. AP50 and mAP pool all rankings as one class with the probabilities as scores,
/// each question an image of its own, at most COCO's 100 candidates each, and are -1 where no question
/// has a true box. An answer is exact if it names the things of the truth; where the truth has boxes without names, if its boxes match them one to
/// one. A question without true boxes adds 0 to `miou_gt` and `miou_query`, as in the
/// benchmark; ratios without a denominator are 0.
///
/// ```
/// use jrdb_metrics::{MetricsConfig, Outcome, evaluate};
/// # use jrdb_types::{answer::Ranked, vocab::MatchPolicy, *};
/// # let id = EntityId::new("pedestrian", 3);
/// # let bbox = PixelBox::from([10.0, 10.0, 40.0, 90.0]);
/// # let frame = FrameId { sequence: "cafe".into(), frame: 0 };
/// # let truth = Truth { ids: vec![id.clone()], boxes: vec![bbox], count: None };
/// # let question = Question { id: None, text: "Find all men".into(), category: "gender".into(), frame: frame.clone(), slots: vec![], truth: Some(truth) };
/// # let query = Query { text: "Find all men".into(), ..Query::default() };
/// # let answer = Answer::new(frame, &query, MatchPolicy::Ranked, LateralConvention::Physical);
/// # let ranking = vec![Ranked { id: id.clone(), bbox, probability: 0.9 }];
/// # let answer = Answer { selection: vec![id], ranking, ..answer };
/// let scores = evaluate(&[Outcome { question: &question, answer: &answer }], &MetricsConfig::default());
/// assert_eq!(scores.overall.exact, 1);
/// assert_eq!(scores.categories["gender"].miou_gt, 1.0);
/// ```
#[must_use]
pub fn evaluate(outcomes: &[Outcome<'_>], config: &MetricsConfig) -> Scores {
    evaluate_all(outcomes, &[], config)
}

/// [`evaluate`], with questions that were not answered: each counts as missed, also where nothing is meant.
#[must_use]
pub fn evaluate_all(
    outcomes: &[Outcome<'_>],
    unanswered: &[&Question],
    config: &MetricsConfig,
) -> Scores {
    let answered = outcomes.iter().filter_map(|outcome| Scored::new(*outcome, config));
    let missed = unanswered.iter().filter_map(|question| Scored::missed(question));
    let scored: Vec<Scored<'_>> = answered.chain(missed).collect();
    let mut by_category: BTreeMap<String, Vec<&Scored<'_>>> = BTreeMap::new();
    for one in &scored {
        by_category.entry(one.score.category.clone()).or_default().push(one);
    }
    let circle_px = config.circle_px();
    Scores {
        iou: if circle_px.is_some() { IouKind::Circular } else { IouKind::Planar },
        overall: summary(&scored.iter().collect::<Vec<_>>(), circle_px),
        categories: by_category.into_iter().map(|(c, all)| (c, summary(&all, circle_px))).collect(),
        questions: scored.into_iter().map(|one| one.score).collect(),
    }
}

/// The score of one question; `None` when its truth is unknown.
#[must_use]
pub fn score(outcome: Outcome<'_>, config: &MetricsConfig) -> Option<QuestionScore> {
    Scored::new(outcome, config).map(|scored| scored.score)
}

struct Scored<'a> {
    truth: &'a Truth,
    answer: Option<&'a Answer>,
    score: QuestionScore,
}

impl<'a> Scored<'a> {
    fn new(Outcome { question, answer }: Outcome<'a>, config: &MetricsConfig) -> Option<Self> {
        let truth = question.truth.as_ref()?;
        let boxes = selected_boxes(answer);
        let matches = match_boxes(&truth.boxes, &boxes, config.match_iou, config.circle_px());
        let score = QuestionScore {
            frame: question.frame.clone(),
            question: question.text.clone(),
            category: question.category.clone(),
            exact: exact(truth, answer, matches.count),
            true_positives: matches.count,
            false_positives: selected(answer) - matches.count,
            false_negatives: truth.boxes.len() - matches.count,
            matched_iou: matches.iou_sum,
        };
        Some(Self { truth, answer: Some(answer), score })
    }

    /// The score of a question that was not answered.
    fn missed(question: &'a Question) -> Option<Self> {
        let truth = question.truth.as_ref()?;
        let score = QuestionScore {
            frame: question.frame.clone(),
            question: question.text.clone(),
            category: question.category.clone(),
            exact: Some(false),
            true_positives: 0,
            false_positives: 0,
            false_negatives: truth.boxes.len(),
            matched_iou: 0.0,
        };
        Some(Self { truth, answer: None, score })
    }
}

/// The boxes of the selection; of a recording, those of the first slot, once for each frame, as the benchmark has it.
fn selected_boxes(answer: &Answer) -> Vec<PixelBox> {
    if let Some(slot) = answer.slots.first() {
        return slot.seen.iter().map(|seen| seen.bbox).collect();
    }
    let boxes: BTreeMap<&EntityId, PixelBox> =
        answer.ranking.iter().map(|ranked| (&ranked.id, ranked.bbox)).collect();
    answer.selection.iter().filter_map(|id| boxes.get(id).copied()).collect()
}

/// How many things the answer says there are, with or without a box.
fn selected(answer: &Answer) -> usize {
    answer.slots.first().map_or(answer.selection.len(), |slot| slot.seen.len())
}

/// Boxes with the probability of what they show.
fn ranked_boxes(answer: &Answer) -> Vec<(PixelBox, f64)> {
    let Some(slot) = answer.slots.first() else {
        return answer.ranking.iter().map(|ranked| (ranked.bbox, ranked.probability)).collect();
    };
    let by_id: BTreeMap<&EntityId, f64> =
        answer.ranking.iter().map(|ranked| (&ranked.id, ranked.probability)).collect();
    slot.seen.iter().map(|seen| (seen.bbox, by_id.get(&seen.id).copied().unwrap_or(1.0))).collect()
}

fn exact(truth: &Truth, answer: &Answer, matched: usize) -> Option<bool> {
    if truth.count.is_some() {
        return Some(answer.number() == truth.count);
    }
    if truth.ids.is_empty() && !truth.boxes.is_empty() {
        return Some(matched == truth.boxes.len() && matched == selected(answer));
    }
    let set = |ids: &'_ [EntityId]| ids.iter().cloned().collect::<BTreeSet<_>>();
    Some(set(&truth.ids) == set(&answer.selection))
}

fn summary(scored: &[&Scored<'_>], circle_px: Option<f64>) -> Summary {
    let questions = scored.len();
    let count =
        |of: fn(&QuestionScore) -> usize| scored.iter().map(|s| of(&s.score)).sum::<usize>();
    let right = count(|s| s.true_positives);
    let sum = |of: fn(&Scored<'_>) -> f64| scored.iter().map(|s| of(s)).sum::<f64>();
    let matched_iou = sum(|s| s.score.matched_iou);
    let per_truth = sum(|s| ratio(s.score.matched_iou, s.truth.boxes.len()));
    let per_match = sum(|s| ratio(s.score.matched_iou, s.score.true_positives));
    let (ap50, map) = average_precision(scored, circle_px);
    Summary {
        questions,
        exact: scored.iter().filter(|s| s.score.exact == Some(true)).count(),
        miou_gt: ratio(per_truth, questions),
        miou_matched: ratio(matched_iou, right),
        miou_query: ratio(per_match, questions),
        precision: ratio(right as f64, right + count(|s| s.false_positives)),
        recall: ratio(right as f64, right + count(|s| s.false_negatives)),
        ap50,
        map,
    }
}

fn ratio(part: f64, whole: usize) -> f64 {
    if whole == 0 { 0.0 } else { part / whole as f64 }
}

fn average_precision(scored: &[&Scored<'_>], period_px: Option<f64>) -> (f64, f64) {
    const ONE_CLASS: u64 = 1;
    const COCO_LIMIT: usize = 100;
    let mut dataset = Dataset::default();
    for (image, one) in (0..).zip(scored) {
        let truth = one.truth.boxes.iter();
        dataset.truth.extend(truth.map(|&bbox| GroundTruthBox::new(image, ONE_CLASS, bbox)));
        let ranked = one.answer.map(ranked_boxes).unwrap_or_default().into_iter();
        dataset.detections.extend(ranked.map(|(bbox, score)| DetectionBox {
            image,
            category: ONE_CLASS,
            bbox,
            score,
        }));
    }
    let config =
        coco::Config { period_px, max_detections: vec![COCO_LIMIT], areas: vec![Area::All] };
    let statistics = coco::evaluate(&dataset, &config).statistics();
    (statistics.ap50, statistics.ap)
}

#[cfg(test)]
mod tests {
    use super::*;
    use jrdb_types::answer::{Count, Ranked, Reply, Sighting, SlotAnswer};
    use jrdb_types::vocab::MatchPolicy;
    use jrdb_types::{FrameId, LateralConvention, Query};
    use proptest::prelude::*;

    fn id(number: u32) -> EntityId {
        EntityId::new("pedestrian", number)
    }

    fn at(x: f64) -> PixelBox {
        PixelBox::from([x, 10.0, 40.0, 100.0])
    }

    fn question(category: &str, numbers: &[u32]) -> Question {
        let ids = numbers.iter().map(|&n| id(n)).collect();
        let boxes = numbers.iter().map(|&n| at(f64::from(n) * 100.0)).collect();
        Question {
            id: None,
            text: "Find them".into(),
            category: category.into(),
            frame: FrameId::default(),
            slots: vec![],
            truth: Some(Truth { ids, boxes, count: None }),
        }
    }

    #[test]
    fn a_question_that_is_not_answered_is_missed() {
        let (asked, nobody) = (question("a", &[1]), question("b", &[]));
        let given = answer(&[1], &[]);
        let outcomes = [Outcome { question: &asked, answer: &given }];
        let scores = evaluate_all(&outcomes, &[&asked, &nobody], &MetricsConfig::default());
        assert_eq!((scores.overall.questions, scores.overall.exact), (3, 1));
        assert_eq!(scores.overall.recall, 0.5);
        assert_eq!(scores.questions[2].exact, Some(false));
    }

    /// Selects `selected` and ranks them above `others`.
    fn answer(selected: &[u32], others: &[u32]) -> Answer {
        let ranked = |probability| {
            move |&n: &u32| Ranked { id: id(n), bbox: at(f64::from(n) * 100.0), probability }
        };
        let query = Query { text: "Find them".into(), ..Query::default() };
        let (policy, lateral) = (MatchPolicy::Ranked, LateralConvention::Physical);
        Answer {
            selection: selected.iter().map(|&n| id(n)).collect(),
            ranking: selected
                .iter()
                .map(ranked(0.9))
                .chain(others.iter().map(ranked(0.1)))
                .collect(),
            ..Answer::new(FrameId::default(), &query, policy, lateral)
        }
    }

    fn score(question: &Question, answer: &Answer) -> Scores {
        evaluate(&[Outcome { question, answer }], &MetricsConfig::default())
    }

    #[test]
    fn of_a_recording_the_boxes_of_the_first_slot_count() {
        let question = question("video", &[1, 1]);
        let mut answer = answer(&[1], &[]);
        let seen = |frame| Sighting { id: id(1), frame, bbox: at(100.0) };
        answer.slots = vec![SlotAnswer { seen: vec![seen(0), seen(1)] }, SlotAnswer::default()];
        let scores = evaluate(
            &[Outcome { question: &question, answer: &answer }],
            &MetricsConfig::default(),
        );
        assert_eq!((scores.questions[0].true_positives, scores.overall.ap50), (2, 1.0));
        assert_eq!(scores.questions[0].exact, Some(true));
    }

    #[test]
    fn a_missed_person_lowers_the_headline_only() {
        let s = score(&question("age", &[1, 2]), &answer(&[1], &[]));
        assert_eq!(
            (s.overall.miou_gt, s.overall.miou_matched, s.overall.miou_query),
            (0.5, 1.0, 1.0)
        );
        assert_eq!((s.overall.precision, s.overall.recall), (1.0, 0.5));
        assert_eq!(s.questions[0].exact, Some(false));
    }

    #[test]
    fn an_unanswered_question_lowers_both_means_but_not_the_sum() {
        let (q, right, none) = (question("age", &[1]), answer(&[1], &[]), answer(&[], &[]));
        let outcomes =
            [Outcome { question: &q, answer: &right }, Outcome { question: &q, answer: &none }];
        let s = evaluate(&outcomes, &MetricsConfig::default()).overall;
        assert_eq!((s.miou_gt, s.miou_matched, s.miou_query), (0.5, 1.0, 0.5));
    }

    #[test]
    fn nobody_meant_and_nobody_selected_is_exact_but_adds_nothing_to_the_means() {
        let s = score(&question("age", &[]), &answer(&[], &[5]));
        assert_eq!(s.overall.exact, 1);
        assert_eq!((s.overall.miou_gt, s.overall.miou_query), (0.0, 0.0));
        assert_eq!((s.overall.ap50, s.overall.map), (-1.0, -1.0));
    }

    #[test]
    fn average_precision_sees_the_ranking_and_not_the_selection() {
        let s = score(&question("age", &[1, 2]), &answer(&[1], &[2]));
        assert!((s.overall.map - 1.0).abs() < 1e-12);
        let s = score(&question("age", &[2]), &answer(&[1], &[2]));
        assert!((s.overall.ap50 - 0.5).abs() < 1e-12);
    }

    #[test]
    fn counting_is_exact_by_number_whoever_was_counted() {
        let mut q = question("count", &[1, 2]);
        q.truth.as_mut().unwrap().count = Some(2);
        let mut a = answer(&[1, 7], &[]);
        a.reply = Reply::Number(Count::Exact(2));
        let s = score(&q, &a);
        assert_eq!(s.questions[0].exact, Some(true));
        assert_eq!((s.questions[0].true_positives, s.questions[0].false_positives), (1, 1));
        a.reply = Reply::Things;
        assert_eq!(score(&q, &a).questions[0].exact, Some(false));
    }

    #[test]
    fn boxes_without_names_are_exact_if_all_match_and_questions_without_truth_are_left_out() {
        let mut q = question("age", &[1]);
        q.truth.as_mut().unwrap().ids.clear();
        assert_eq!(score(&q, &answer(&[1], &[])).questions[0].exact, Some(true));
        assert_eq!(score(&q, &answer(&[2], &[])).questions[0].exact, Some(false));
        assert_eq!(score(&q, &answer(&[1, 2], &[])).questions[0].exact, Some(false));
        q.truth = None;
        assert_eq!(
            score(&q, &answer(&[1], &[])).overall,
            Summary { ap50: -1.0, map: -1.0, ..Summary::default() }
        );
    }

    #[test]
    fn a_selected_name_without_a_box_is_a_false_positive() {
        let mut a = answer(&[1], &[]);
        a.selection.push(id(9));
        let s = score(&question("age", &[1]), &a);
        assert_eq!((s.questions[0].true_positives, s.questions[0].false_positives), (1, 1));
    }

    #[test]
    fn the_scores_say_which_iou_was_really_used() {
        let (q, mut a) = (question("age", &[1]), answer(&[1], &[]));
        a.ranking[0].bbox.x += 1000.0;
        let outcome = [Outcome { question: &q, answer: &a }];
        let mut config = MetricsConfig { iou: IouKind::Circular, ..MetricsConfig::default() };
        assert_eq!(evaluate(&outcome, &config).iou, IouKind::Planar);
        config.period_px = Some(1000.0);
        let circular = evaluate(&outcome, &config);
        assert_eq!((circular.iou, circular.overall.miou_gt), (IouKind::Circular, 1.0));
    }

    #[test]
    fn an_unknown_setting_is_refused() {
        let error = serde_json::from_str::<MetricsConfig>(r#"{"iuo": "planar"}"#).unwrap_err();
        assert!(error.to_string().contains("unknown field `iuo`"));
    }

    proptest! {
        #[test]
        fn a_perfect_answer_scores_one(numbers in proptest::collection::btree_set(0_u32..40, 1..9)) {
            let numbers: Vec<u32> = numbers.into_iter().collect();
            let s = score(&question("age", &numbers), &answer(&numbers, &[90, 91])).overall;
            prop_assert_eq!(s.exact, 1);
            for value in [s.miou_gt, s.miou_matched, s.miou_query, s.precision, s.recall, s.ap50, s.map] {
                prop_assert!((value - 1.0).abs() < 1e-12);
            }
        }

        #[test]
        fn one_category_is_the_whole(truth in proptest::collection::btree_set(0_u32..9, 0..6),
                                     selected in proptest::collection::btree_set(0_u32..9, 0..6)) {
            let (truth, selected): (Vec<u32>, Vec<u32>) = (truth.into_iter().collect(), selected.into_iter().collect());
            let s = score(&question("age", &truth), &answer(&selected, &[]));
            prop_assert_eq!(&s.categories["age"], &s.overall);
        }
    }
}
