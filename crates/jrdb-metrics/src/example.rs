//! Questions, answers and judgements that tests are made of.

use jrdb_types::answer::Ranked;
use jrdb_types::score::{Candidate, MatchMask, QuestionScore};
use jrdb_types::vocab::MatchPolicy;
use jrdb_types::{
    Answer, EntityId, FrameId, LateralConvention, PixelBox, Query, Question, Status, Truth,
};

use crate::{MetricsConfig, Outcome, score};

fn id(number: u32) -> EntityId {
    EntityId::new("pedestrian", number)
}

fn at(number: u32) -> PixelBox {
    PixelBox::from([f64::from(number) * 100.0, 10.0, 40.0, 100.0])
}

/// A question that means these people.
pub(crate) fn question(category: &str, numbers: &[u32]) -> Question {
    let ids = numbers.iter().map(|&n| id(n)).collect();
    let boxes = numbers.iter().map(|&n| at(n)).collect();
    Question {
        id: None,
        query: None,
        text: "Find them".into(),
        category: category.into(),
        frame: FrameId::default(),
        slots: vec![],
        truth: Some(Truth { ids, boxes, ..Truth::default() }),
    }
}

/// Selects `selected` and ranks them above `others`.
pub(crate) fn answer(selected: &[u32], others: &[u32]) -> Answer {
    let ranked = |probability| move |&n: &u32| Ranked { id: id(n), bbox: at(n), probability };
    let query = Query { text: "Find them".into(), ..Query::default() };
    let (policy, lateral) = (MatchPolicy::Ranked, LateralConvention::Physical);
    Answer {
        selection: selected.iter().map(|&n| id(n)).collect(),
        ranking: selected.iter().map(ranked(0.9)).chain(others.iter().map(ranked(0.1))).collect(),
        ..Answer::new(FrameId::default(), &query, policy, lateral)
    }
}

/// The judgement of an answer under the default configuration.
pub(crate) fn score_of(question: &Question, answer: &Answer) -> QuestionScore {
    score(Outcome { question, answer }, &MetricsConfig::default()).unwrap()
}

/// The judgement of an answer that ranks candidates with these scores, of which those above a half
/// are selected; they match a true box at so many thresholds. Beside those there are `missed` true
/// boxes.
pub(crate) fn judgement(
    sequence: &str,
    frame: u32,
    ranked: &[(f64, usize)],
    missed: usize,
) -> QuestionScore {
    let mut judged = score_of(&question("any", &[]), &answer(&[], &[]));
    let candidate =
        |&(score, count): &(f64, usize)| Candidate { score, matches: MatchMask::of(0..count) };
    judged.ranking = ranked.iter().map(candidate).collect();
    judged.ranking.sort_by(|a, b| b.score.total_cmp(&a.score));
    let selected = || judged.ranking.iter().filter(|c| c.score > 0.5);
    let right = selected().filter(|c| c.matches.at(0)).count();
    let there = judged.ranking.iter().filter(|c| c.matches.at(0)).count();
    judged.false_positives = selected().count() - right;
    judged.selection = selected().map(|c| c.matches).collect();
    judged.true_positives = right;
    judged.false_negatives = there + missed - right;
    judged.matched_iou = 0.8 * right as f64;
    judged.exact = Some(judged.is_one_to_one());
    judged.frame = FrameId { sequence: sequence.into(), frame };
    judged.status = Some(Status::Answered);
    judged
}
