//! Scores of parts of the questions, and what is taken for what.

use std::collections::BTreeMap;

use jrdb_types::Scores;
use jrdb_types::score::{Confusion, QuestionScore, Summary};

use crate::scores::summaries;

/// The summary of the questions of each key: by range, occlusion, crowd or recording, for example.
/// Questions without a key are left out.
///
/// ```
/// use jrdb_metrics::{MetricsConfig, from_judgements, slices};
/// let scores = from_judgements(MetricsConfig::default().protocol(), Vec::new());
/// assert!(slices(&scores, |one| Some(one.frame.sequence.clone())).is_empty());
/// ```
#[must_use]
pub fn slices(
    scores: &Scores,
    key: impl Fn(&QuestionScore) -> Option<String>,
) -> BTreeMap<String, Summary> {
    summaries(&scores.questions, key)
}

/// Counts pairs of a true word and the word that was said.
///
/// ```
/// let said = [("left", "left"), ("left", "right"), ("right", "right")];
/// let confusion = jrdb_metrics::confusion(said);
/// assert_eq!(confusion.count("left", "right"), 1);
/// ```
#[must_use]
pub fn confusion<'a>(pairs: impl IntoIterator<Item = (&'a str, &'a str)>) -> Confusion {
    let mut confusion = Confusion::default();
    for (truth, said) in pairs {
        let row = confusion.counts.entry(truth.into()).or_default();
        *row.entry(said.into()).or_default() += 1;
    }
    confusion
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::example::judgement;
    use crate::{MetricsConfig, from_judgements};

    #[test]
    fn a_slice_has_the_questions_of_its_key_only() {
        let questions = vec![
            judgement("near", 0, &[(0.9, 10)], 0),
            judgement("far", 0, &[(0.2, 10)], 0),
            judgement("far", 1, &[(0.9, 10)], 0),
        ];
        let scores = from_judgements(MetricsConfig::default().protocol(), questions);
        let slices =
            slices(&scores, |one| (one.frame.frame == 0).then(|| one.frame.sequence.clone()));
        assert_eq!(slices.keys().collect::<Vec<_>>(), ["far", "near"]);
        assert_eq!((slices["near"].recall, slices["far"].recall), (1.0, 0.0));
    }

    #[test]
    fn what_is_said_of_what_is_counted() {
        let confusion = confusion([("left", "right"), ("left", "right"), ("right", "right")]);
        assert_eq!((confusion.count("left", "right"), confusion.count("left", "left")), (2, 0));
    }
}
