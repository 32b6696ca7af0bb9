//! How probable each word of a closed vocabulary is as the answer to a question.

use super::model::{PromptState, Vlm};
use crate::detector::PerceptionError;
use crate::prompts::{Question, label_in};

/// One spelling of a label as an answer.
#[derive(Debug, Clone, PartialEq)]
pub struct LabelScore {
    /// Natural logarithm of the probability that the model answers so and ends: the sum over its
    /// tokens and the end.
    pub log_likelihood: f64,
    /// Number of its tokens, the end included.
    pub tokens: usize,
}

impl Vlm {
    /// Scores every spelling of every label as the answer to the prompt, label by label.
    ///
    /// Sums, not means: a mean favours long words, whose later tokens have high probabilities.
    ///
    /// # Errors
    /// When a spelling has no tokens or a graph fails.
    pub fn score(
        &self,
        read: &PromptState,
        labels: &[Vec<String>],
        end: u32,
    ) -> Result<Vec<Vec<LabelScore>>, PerceptionError> {
        let ids = |spelling: &String| -> Result<Vec<u32>, PerceptionError> {
            let mut ids = self.tokens().encode(spelling)?;
            ids.push(end);
            Ok(ids)
        };
        let all = labels.iter().flatten().map(ids).collect::<Result<Vec<_>, _>>()?;
        let weights = self.weigh(read, &all)?;
        let mut scores = weights
            .into_iter()
            .map(|logs| LabelScore { log_likelihood: logs.iter().sum(), tokens: logs.len() });
        Ok(labels.iter().map(|spellings| scores.by_ref().take(spellings.len()).collect()).collect())
    }
}

/// Probabilities of labels, given that the answer is one of them; spellings of a label add up. A
/// `temperature` above 1 flattens them.
pub(super) fn probabilities(scores: &[Vec<LabelScore>], temperature: f64) -> Vec<f64> {
    let logs: Vec<f64> = scores
        .iter()
        .map(|spellings| {
            let highest =
                spellings.iter().map(|s| s.log_likelihood).fold(f64::NEG_INFINITY, f64::max);
            let sum: f64 = spellings.iter().map(|s| (s.log_likelihood - highest).exp()).sum();
            (highest + sum.ln()) / temperature
        })
        .collect();
    let highest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if !highest.is_finite() {
        return vec![0.0; logs.len()];
    }
    let weights: Vec<f64> = logs.iter().map(|log| (log - highest).exp()).collect();
    let sum: f64 = weights.iter().sum();
    weights.iter().map(|weight| weight / sum).collect()
}

/// Length of the common beginning of all prompts; each keeps at least one token of its own.
pub(super) fn shared_beginning(prompts: &[Vec<u32>]) -> usize {
    let Some(first) = prompts.first() else { return 0 };
    let alike = |other: &Vec<u32>| first.iter().zip(other).take_while(|(a, b)| a == b).count();
    let shortest = prompts.iter().map(Vec::len).min().unwrap_or(0);
    prompts.iter().map(alike).min().unwrap_or(0).min(shortest.saturating_sub(1))
}

/// The answer that a model writes by itself, as a place in the question's vocabulary.
pub(super) fn free_answer(
    vlm: &Vlm,
    read: PromptState,
    question: &Question,
    longest: usize,
) -> Result<Option<usize>, PerceptionError> {
    let sequence = vlm.write(read, longest)?;
    Ok(label_in(&vlm.tokens().decode_words(&sequence.ids)?, &question.labels))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn score(log_likelihood: f64) -> LabelScore {
        LabelScore { log_likelihood, tokens: 2 }
    }

    #[test]
    fn spellings_add_up_and_everything_sums_to_one() {
        let half = 0.25_f64.ln();
        let found =
            probabilities(&[vec![score(half), score(half)], vec![score(0.5_f64.ln())]], 1.0);
        assert!((found[0] - 0.5).abs() < 1e-12 && (found[1] - 0.5).abs() < 1e-12);
        let cool = probabilities(&[vec![score(-1.0)], vec![score(-3.0)]], 2.0);
        assert!((cool[0] / cool[1] - 1.0_f64.exp()).abs() < 1e-9);
        assert_eq!(probabilities(&[vec![score(f64::NEG_INFINITY)]], 1.0), [0.0]);
    }

    #[test]
    fn prompts_share_what_they_begin_with_but_not_all() {
        assert_eq!(shared_beginning(&[vec![1, 2, 3], vec![1, 2, 4, 5]]), 2);
        assert_eq!(shared_beginning(&[vec![1, 2, 3]]), 2);
        assert_eq!(shared_beginning(&[]), 0);
    }
}
