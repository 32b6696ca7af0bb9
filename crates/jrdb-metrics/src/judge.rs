//! One answer against its truth.

use std::collections::{BTreeMap, BTreeSet};

use jrdb_types::answer::Reply;
use jrdb_types::score::{CountJudged, QuestionScore, ReplyKind, YesNoJudged};
use jrdb_types::{Answer, EntityId, PixelBox, Question, Truth};

use crate::MetricsConfig;
use crate::candidates::judged;
use crate::matching::match_boxes;
use crate::told;

/// A question and the answer that was given to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outcome<'a> {
    /// What was asked, with its truth.
    pub question: &'a Question,
    /// What was answered.
    pub answer: &'a Answer,
}

/// The judgement of one question; `None` when its truth is unknown.
///
/// The boxes of a selection are looked up in the answer's ranking; a selected id without a box
/// counts as a false positive. Boxes match as in [`match_boxes`]; candidates, as in COCO's
/// evaluator.
#[must_use]
pub fn score(
    Outcome { question, answer }: Outcome<'_>,
    config: &MetricsConfig,
) -> Option<QuestionScore> {
    let truth = question.truth.as_ref()?;
    let (boxes, period_px) = (selected_boxes(answer), config.circle_px());
    let matches = match_boxes(&truth.boxes, &boxes, config.match_iou, period_px);
    let selection = boxes.into_iter().map(|bbox| (bbox, 1.0)).collect();
    let blank = missed(question)?;
    Some(QuestionScore {
        status: Some(answer.status),
        reply: Some(ReplyKind::of(&answer.reply)),
        exact: exact(truth, answer, matches.count),
        true_positives: matches.count,
        false_positives: selected(answer) - matches.count,
        false_negatives: truth.boxes.len() - matches.count,
        matched_iou: matches.iou_sum,
        ranking: judged(&truth.boxes, ranked_boxes(answer), period_px),
        selection: judged(&truth.boxes, selection, period_px).iter().map(|c| c.matches).collect(),
        count: blank.count.map(|count| CountJudged { told: answer.number(), ..count }),
        yes_no: blank.yes_no.map(|judged| YesNoJudged { told: yes_no(answer), ..judged }),
        words: blank.words.map(|_| has_words(truth, answer)),
        ..blank
    })
}

/// The judgement of a question that was not answered: missed, also where nothing is meant.
pub(crate) fn missed(question: &Question) -> Option<QuestionScore> {
    let truth = question.truth.as_ref()?;
    Some(QuestionScore {
        frame: question.frame.clone(),
        question_id: question.id.clone(),
        question: question.text.clone(),
        category: question.category.clone(),
        status: None,
        reply: None,
        exact: Some(false),
        true_positives: 0,
        false_positives: 0,
        false_negatives: truth.boxes.len(),
        matched_iou: 0.0,
        ranking: Vec::new(),
        selection: Vec::new(),
        count: truth.count.map(|truth| CountJudged { truth, told: None }),
        yes_no: truth.yes_no.map(|truth| YesNoJudged { truth, told: None }),
        words: (!truth.words.is_empty()).then_some(false),
    })
}

/// The boxes of the selection; of a recording, those of the first slot, once for each frame, as the
/// benchmark has it.
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
    if truth.yes_no.is_some() {
        return Some(yes_no(answer) == truth.yes_no);
    }
    if !truth.words.is_empty() {
        return Some(has_words(truth, answer));
    }
    if truth.ids.is_empty() && !truth.boxes.is_empty() {
        return Some(matched == truth.boxes.len() && matched == selected(answer));
    }
    let set = |ids: &'_ [EntityId]| ids.iter().cloned().collect::<BTreeSet<_>>();
    Some(set(&truth.ids) == set(&answer.selection))
}

/// What the answer says; nothing of an open one, whose reply is no answer.
fn yes_no(answer: &Answer) -> Option<bool> {
    if let Reply::YesNo(told) = answer.reply {
        told.filter(|_| !answer.status.is_open())
    } else {
        None
    }
}

/// Whether the words told are those of the truth.
fn has_words(truth: &Truth, answer: &Answer) -> bool {
    let wanted: BTreeSet<String> = truth.words.iter().map(|word| told::plain(word)).collect();
    !answer.status.is_open() && told::words(&answer.reply) == wanted
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::example::{answer, question, score_of};
    use jrdb_types::answer::{Count, PropertyValue, PropertyValues, Sighting, SlotAnswer};
    use jrdb_types::score::MatchMask;
    use jrdb_types::{Age, Status};

    #[test]
    fn of_a_recording_the_boxes_of_the_first_slot_count() {
        let mut answer = answer(&[1], &[]);
        let bbox = answer.ranking[0].bbox;
        let seen = |frame| Sighting { id: answer.selection[0].clone(), frame, bbox };
        answer.slots = vec![SlotAnswer { seen: vec![seen(0), seen(1)] }, SlotAnswer::default()];
        let judged = score_of(&question("video", &[1, 1]), &answer);
        assert_eq!((judged.true_positives, judged.ranking.len()), (2, 2));
        assert_eq!(judged.exact, Some(true));
    }

    #[test]
    fn counting_is_exact_by_number_whoever_was_counted() {
        let mut q = question("count", &[1, 2]);
        q.truth.as_mut().unwrap().count = Some(2);
        let mut a = answer(&[1, 7], &[]);
        a.reply = Reply::Number(Count::Exact(2));
        let judged = score_of(&q, &a);
        assert_eq!(judged.exact, Some(true));
        assert_eq!((judged.true_positives, judged.false_positives), (1, 1));
        assert_eq!(judged.count, Some(CountJudged { truth: 2, told: Some(2) }));
        a.reply = Reply::Things;
        let judged = score_of(&q, &a);
        assert_eq!((judged.exact, judged.count.unwrap().told), (Some(false), None));
    }

    #[test]
    fn boxes_without_names_are_exact_if_all_match() {
        let mut q = question("age", &[1]);
        q.truth.as_mut().unwrap().ids.clear();
        assert_eq!(score_of(&q, &answer(&[1], &[])).exact, Some(true));
        assert_eq!(score_of(&q, &answer(&[2], &[])).exact, Some(false));
        assert_eq!(score_of(&q, &answer(&[1, 2], &[])).exact, Some(false));
        q.truth = None;
        let answer = answer(&[1], &[]);
        let outcome = Outcome { question: &q, answer: &answer };
        assert_eq!(score(outcome, &MetricsConfig::default()), None);
    }

    #[test]
    fn a_selected_name_without_a_box_is_a_false_positive() {
        let mut a = answer(&[1], &[]);
        a.selection.push(EntityId::new("pedestrian", 9));
        let judged = score_of(&question("age", &[1]), &a);
        assert_eq!((judged.true_positives, judged.false_positives), (1, 1));
        assert_eq!(judged.selection, [MatchMask::of(0..10)]);
    }

    #[test]
    fn yes_and_no_are_judged_and_an_open_reply_is_neither() {
        let mut q = question("exists", &[]);
        q.truth.as_mut().unwrap().yes_no = Some(true);
        let mut a = answer(&[], &[]);
        a.reply = Reply::YesNo(Some(true));
        assert_eq!(score_of(&q, &a).exact, Some(true));
        a.status = Status::Unknown;
        let judged = score_of(&q, &a);
        assert_eq!((judged.exact, judged.yes_no.unwrap().told), (Some(false), None));
    }

    #[test]
    fn words_are_judged_as_a_set() {
        let mut q = question("age", &[]);
        q.truth.as_mut().unwrap().words = vec!["Young".into()];
        let mut a = answer(&[], &[]);
        let value = PropertyValue::Attribute { value: Age::Young.into(), probability: 0.7 };
        let id = EntityId::new("pedestrian", 1);
        let told = PropertyValues { id, property: None, values: vec![value], words: vec![] };
        a.reply = Reply::Properties(vec![told]);
        assert_eq!(score_of(&q, &a).words, Some(true));
        q.truth.as_mut().unwrap().words.push("female".into());
        assert_eq!(score_of(&q, &a).exact, Some(false));
    }
}
