//! What judgements sum up to.

use jrdb_types::score::{CountSummary, Metric, QuestionScore, Summary, WordSummary, YesNoSummary};

use crate::pool::{List, Pool, mean};
use crate::ratio::{Ratio, total};

/// The summary of questions.
pub(crate) fn summary(questions: &[&QuestionScore]) -> Summary {
    let sum = |metric| total(metric, questions.iter().copied());
    let rate = |metric| quotient(sum(metric));
    let [map_ranking, ap50_ranking] = average_precision(questions, List::Ranking);
    let [map_selection, ap50_selection] = average_precision(questions, List::Selection);
    Summary {
        questions: questions.len(),
        exact: sum(Metric::Exact).part as usize,
        accuracy: rate(Metric::Accuracy),
        miou_gt: rate(Metric::MiouGt),
        miou_matched: rate(Metric::MiouMatched),
        miou_query: rate(Metric::MiouQuery),
        precision: rate(Metric::Precision),
        recall: rate(Metric::Recall),
        f1: rate(Metric::F1),
        map_ranking,
        ap50_ranking,
        map_selection,
        ap50_selection,
        counting: counting(questions, sum(Metric::CountError)),
        words: words(sum(Metric::WordAccuracy)),
        yes_no: yes_no(sum(Metric::YesNoAccuracy), sum(Metric::YesNoRisk)),
    }
}

/// A ratio without a denominator is 0.
fn quotient(ratio: Ratio) -> f64 {
    ratio.value().unwrap_or(0.0)
}

/// mAP and AP50; -1 without a true box.
fn average_precision(questions: &[&QuestionScore], list: List) -> [f64; 2] {
    let together: Vec<(usize, &QuestionScore)> = questions.iter().map(|one| (0, *one)).collect();
    let precisions = Pool::new(&together, 1, list).average_precision(&[1.0]);
    precisions.map_or([-1.0; 2], |all| [mean(&all), all[0]])
}

fn counting(questions: &[&QuestionScore], error: Ratio) -> Option<CountSummary> {
    let asked = questions.iter().filter(|one| one.count.is_some()).count();
    let (told, count_error) = (error.whole as usize, quotient(error));
    (asked > 0).then_some(CountSummary { asked, told, count_error })
}

fn words(accuracy: Ratio) -> Option<WordSummary> {
    let (right, asked) = (accuracy.part as usize, accuracy.whole as usize);
    accuracy.value().map(|accuracy| WordSummary { asked, right, accuracy })
}

fn yes_no(accuracy: Ratio, risk: Ratio) -> Option<YesNoSummary> {
    let (asked, told, wrong) = (accuracy.whole, risk.whole, risk.part);
    accuracy.value().map(|accuracy| YesNoSummary {
        asked: asked as usize,
        right: (told - wrong) as usize,
        wrong: wrong as usize,
        unknown: (asked - told) as usize,
        accuracy,
        coverage: told / asked,
        risk: quotient(risk),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::example::judgement;
    use jrdb_types::score::{CountJudged, YesNoJudged};

    #[test]
    fn ranking_and_selection_have_their_own_average_precision() {
        let of = judgement("a", 0, &[(0.9, 0), (0.4, 10)], 0);
        let summary = summary(&[&of]);
        assert!((summary.ap50_ranking - 0.5).abs() < 1e-12);
        assert_eq!(summary.ap50_selection, 0.0);
    }

    #[test]
    fn an_unknown_yes_or_no_has_a_column_of_its_own() {
        let asked = |truth, told| {
            let yes_no = Some(YesNoJudged { truth, told });
            QuestionScore { yes_no, ..judgement("a", 0, &[], 0) }
        };
        let all = [asked(true, Some(true)), asked(true, Some(false)), asked(false, None)];
        let found = summary(&all.iter().collect::<Vec<_>>()).yes_no.unwrap();
        assert_eq!((found.right, found.wrong, found.unknown), (1, 1, 1));
        let rates = (found.accuracy, found.coverage, found.risk);
        assert_eq!(rates, (1.0 / 3.0, 2.0 / 3.0, 0.5));
    }

    #[test]
    fn counts_without_a_number_are_not_part_of_the_error() {
        let asked = |told| {
            let count = Some(CountJudged { truth: 4, told });
            QuestionScore { count, ..judgement("a", 0, &[], 0) }
        };
        let all = [asked(Some(1)), asked(Some(5)), asked(None)];
        let found = summary(&all.iter().collect::<Vec<_>>()).counting.unwrap();
        assert_eq!(found, CountSummary { asked: 3, told: 2, count_error: 2.0 });
    }
}
