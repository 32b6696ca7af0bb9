//! From judgements to the scores of a run.

use std::collections::BTreeMap;

use jrdb_types::score::{Protocol, QuestionScore, Summary};
use jrdb_types::{Question, Scores};

use crate::judge::missed;
use crate::protocol::{ProtocolMismatch, check};
use crate::summary::summary;
use crate::{MetricsConfig, Outcome, score};

/// Scores answers; questions without a known answer are left out.
///
/// An answer is exact if it has the number, the yes or no, or the words of the truth, where the
/// truth has one of these; else if it names the things of the truth; where the truth has boxes
/// without names, if its boxes match them one to one. A question without true boxes adds 0 to
/// `miou_gt` and `miou_query`, as in the benchmark. [`Summary`] defines every number.
///
/// ```
/// use jrdb_metrics::{MetricsConfig, Outcome, evaluate};
/// # use jrdb_types::{answer::Ranked, vocab::MatchPolicy, *};
/// # let id = EntityId::new("pedestrian", 3);
/// # let bbox = PixelBox::from([10.0, 10.0, 40.0, 90.0]);
/// # let frame = FrameId { sequence: "cafe".into(), frame: 0 };
/// # let truth = Truth { ids: vec![id.clone()], boxes: vec![bbox], ..Truth::default() };
/// # let (text, category) = ("Find all men".into(), "gender".into());
/// # let frame_of = frame.clone();
/// # let question = Question { id: None, query: None, text, category, frame: frame_of, slots: vec![], truth: Some(truth) };
/// # let query = Query { text: "Find all men".into(), ..Query::default() };
/// # let answer = Answer::new(frame, &query, MatchPolicy::Ranked, LateralConvention::Physical);
/// # let ranking = vec![Ranked { id: id.clone(), bbox, probability: 0.9 }];
/// # let answer = Answer { selection: vec![id], ranking, ..answer };
/// let outcome = Outcome { question: &question, answer: &answer };
/// let scores = evaluate(&[outcome], &MetricsConfig::default());
/// assert_eq!(scores.overall.exact, 1);
/// assert_eq!(scores.categories["gender"].miou_gt, 1.0);
/// ```
#[must_use]
pub fn evaluate(outcomes: &[Outcome<'_>], config: &MetricsConfig) -> Scores {
    evaluate_all(outcomes, &[], config)
}

/// [`evaluate`], with questions that were not answered: each counts as missed, also where nothing
/// is meant.
#[must_use]
pub fn evaluate_all(
    outcomes: &[Outcome<'_>],
    unanswered: &[&Question],
    config: &MetricsConfig,
) -> Scores {
    let answered = outcomes.iter().filter_map(|outcome| score(*outcome, config));
    let missed = unanswered.iter().filter_map(|question| missed(question));
    from_judgements(config.protocol(), answered.chain(missed).collect())
}

/// The scores that judgements sum up to; they keep their order.
///
/// ```
/// use jrdb_metrics::{MetricsConfig, from_judgements};
/// let scores = from_judgements(MetricsConfig::default().protocol(), Vec::new());
/// assert_eq!((scores.overall.questions, scores.overall.map_ranking), (0, -1.0));
/// ```
#[must_use]
pub fn from_judgements(protocol: Protocol, questions: Vec<QuestionScore>) -> Scores {
    let categories = summaries(&questions, |one| Some(one.category.clone()));
    let overall = summary(&questions.iter().collect::<Vec<_>>());
    Scores { protocol, questions, categories, overall, intervals: None }
}

/// Summaries of the questions of each key; questions without a key are left out.
pub(crate) fn summaries(
    questions: &[QuestionScore],
    key: impl Fn(&QuestionScore) -> Option<String>,
) -> BTreeMap<String, Summary> {
    let mut by_key: BTreeMap<String, Vec<&QuestionScore>> = BTreeMap::new();
    for one in questions {
        if let Some(key) = key(one) {
            by_key.entry(key).or_default().push(one);
        }
    }
    by_key.into_iter().map(|(key, all)| (key, summary(&all))).collect()
}

/// Why scores cannot be merged.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MergeError {
    /// There is nothing to merge, and so no protocol.
    #[error("expected scores to merge, found none")]
    Empty,
    /// A part was judged by other rules than the first.
    #[error("part {part} differs from the first")]
    Protocol {
        /// Which part, counted from 0.
        part: usize,
        /// What differs.
        #[source]
        source: ProtocolMismatch,
    },
}

/// The scores of all parts of a run together. Parts in the order of the run give the run's own
/// scores, bit for bit.
///
/// # Errors
/// [`MergeError`] without a part, or when parts were judged by different rules.
///
/// ```
/// use jrdb_metrics::{MetricsConfig, from_judgements, merge};
/// let part = |iou| {
///     let config = MetricsConfig { match_iou: iou, ..MetricsConfig::default() };
///     from_judgements(config.protocol(), Vec::new())
/// };
/// assert_eq!(merge(&[part(0.5), part(0.5)]).unwrap(), part(0.5));
/// assert!(merge(&[part(0.5), part(0.7)]).is_err());
/// ```
pub fn merge(parts: &[Scores]) -> Result<Scores, MergeError> {
    let first = parts.first().ok_or(MergeError::Empty)?;
    for (part, scores) in parts.iter().enumerate() {
        check(&first.protocol, &scores.protocol)
            .map_err(|source| MergeError::Protocol { part, source })?;
    }
    let questions = parts.iter().flat_map(|part| part.questions.iter().cloned()).collect();
    Ok(from_judgements(first.protocol.clone(), questions))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::example::{answer, judgement, question};
    use jrdb_types::score::IouKind;
    use jrdb_types::{Answer, Artefact};
    use proptest::prelude::*;
    use std::error::Error as _;

    fn scores(question: &Question, answer: &Answer) -> Scores {
        evaluate(&[Outcome { question, answer }], &MetricsConfig::default())
    }

    #[test]
    fn a_question_that_is_not_answered_is_missed() {
        let (asked, nobody) = (question("a", &[1]), question("b", &[]));
        let given = answer(&[1], &[]);
        let outcomes = [Outcome { question: &asked, answer: &given }];
        let scores = evaluate_all(&outcomes, &[&asked, &nobody], &MetricsConfig::default());
        assert_eq!((scores.overall.questions, scores.overall.exact), (3, 1));
        assert_eq!((scores.overall.recall, scores.overall.accuracy), (0.5, 1.0 / 3.0));
        assert_eq!(scores.questions[2].exact, Some(false));
    }

    #[test]
    fn a_missed_person_lowers_the_headline_only() {
        let s = scores(&question("age", &[1, 2]), &answer(&[1], &[])).overall;
        assert_eq!((s.miou_gt, s.miou_matched, s.miou_query), (0.5, 1.0, 1.0));
        assert_eq!((s.precision, s.recall, s.exact), (1.0, 0.5, 0));
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
        let s = scores(&question("age", &[]), &answer(&[], &[5])).overall;
        assert_eq!((s.exact, s.accuracy), (1, 1.0));
        assert_eq!((s.miou_gt, s.miou_query), (0.0, 0.0));
        assert_eq!((s.ap50_ranking, s.map_ranking, s.map_selection), (-1.0, -1.0, -1.0));
    }

    #[test]
    fn the_ranking_is_not_the_selection() {
        let s = scores(&question("age", &[1, 2]), &answer(&[1], &[2])).overall;
        assert!((s.map_ranking - 1.0).abs() < 1e-12);
        assert!((s.map_selection - 51.0 / 101.0).abs() < 1e-12);
        let s = scores(&question("age", &[2]), &answer(&[1], &[2])).overall;
        assert!((s.ap50_ranking - 0.5).abs() < 1e-12);
        assert_eq!(s.ap50_selection, 0.0);
    }

    #[test]
    fn the_scores_say_which_iou_was_really_used() {
        let (q, mut a) = (question("age", &[1]), answer(&[1], &[]));
        a.ranking[0].bbox.x += 1000.0;
        let outcome = [Outcome { question: &q, answer: &a }];
        let mut config = MetricsConfig { iou: IouKind::Circular, ..MetricsConfig::default() };
        assert_eq!(evaluate(&outcome, &config).protocol.iou, IouKind::Planar);
        config.period_px = Some(1000.0);
        let circular = evaluate(&outcome, &config);
        assert_eq!((circular.protocol.iou, circular.overall.miou_gt), (IouKind::Circular, 1.0));
    }

    #[test]
    fn another_protocol_is_refused_by_name() {
        let part = |digest: &str| {
            let questions_digest = Some(digest.into());
            let config = MetricsConfig { questions_digest, ..MetricsConfig::default() };
            from_judgements(config.protocol(), Vec::new())
        };
        let error = merge(&[part("a1"), part("a1"), part("b2")]).unwrap_err();
        assert_eq!(error.to_string(), "part 2 differs from the first");
        let cause = error.source().unwrap().to_string();
        assert_eq!(cause, "expected questions_digest a1, found b2");
        assert_eq!(merge(&[]), Err(MergeError::Empty));
    }

    fn judgements() -> impl Strategy<Value = Vec<QuestionScore>> {
        let ranked = proptest::collection::vec((0.0..1.0, 0_usize..11), 0..6);
        let one = (0..4_u32, ranked, 0_usize..3).prop_map(|(n, ranked, missed)| {
            let category = format!("category {}", n % 3);
            QuestionScore { category, ..judgement(&format!("s{n}"), n, &ranked, missed) }
        });
        proptest::collection::vec(one, 0..30)
    }

    proptest! {
        #[test]
        fn merged_parts_are_the_run_bit_for_bit(
            all in judgements(), mut cuts in proptest::collection::vec(0_usize..31, 0..5),
        ) {
            let protocol = MetricsConfig::default().protocol();
            cuts.extend([0, all.len()]);
            cuts.iter_mut().for_each(|cut| *cut = (*cut).min(all.len()));
            cuts.sort_unstable();
            let part = |ends: &[usize]| {
                let part = from_judgements(protocol.clone(), all[ends[0]..ends[1]].to_vec());
                let text = Artefact::new(serde_json::Value::Null, part).to_json();
                Artefact::<Scores>::from_json(&text).unwrap().data
            };
            let parts: Vec<Scores> = cuts.windows(2).map(part).collect();
            let whole = from_judgements(protocol.clone(), all.clone());
            let bytes = |scores: &Scores| serde_json::to_string(scores).unwrap();
            prop_assert_eq!(bytes(&merge(&parts).unwrap()), bytes(&whole));
        }

        #[test]
        fn a_perfect_answer_scores_one(
            numbers in proptest::collection::btree_set(0_u32..40, 1..9),
        ) {
            let numbers: Vec<u32> = numbers.into_iter().collect();
            let s = scores(&question("age", &numbers), &answer(&numbers, &[90, 91])).overall;
            prop_assert_eq!(s.exact, 1);
            let ious = [s.miou_gt, s.miou_matched, s.miou_query];
            let rates = [s.accuracy, s.precision, s.recall, s.f1];
            let maps = [s.ap50_ranking, s.map_ranking, s.ap50_selection, s.map_selection];
            for value in ious.into_iter().chain(rates).chain(maps) {
                prop_assert!((value - 1.0).abs() < 1e-12);
            }
        }

        #[test]
        fn one_category_is_the_whole(truth in proptest::collection::btree_set(0_u32..9, 0..6),
                                     selected in proptest::collection::btree_set(0_u32..9, 0..6)) {
            let [truth, selected] = [truth, selected].map(|some| some.into_iter().collect::<Vec<_>>());
            let s = scores(&question("age", &truth), &answer(&selected, &[]));
            prop_assert_eq!(&s.categories["age"], &s.overall);
        }
    }
}
