//! Greedy and beam search: from a model's scores of the next token to a sequence.
//!
//! The rules and their order are those of Hugging Face transformers 4.57 (`generate` without
//! sampling): no n-gram twice, then a forced first token, then a forced last one; a finished beam
//! counts only if it is among the best `num_beams` candidates of its step.

use serde::{Deserialize, Serialize};

use super::log_sum_exp::{highest, log_sum_exp};

/// How sequences are searched for: the fields of a `generation_config.json` that matter without
/// sampling.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct DecodeConfig {
    /// Sequences that are followed at once; 1 is greedy search.
    pub num_beams: usize,
    /// No sequence of this many tokens may occur twice; 0 allows all.
    pub no_repeat_ngram_size: usize,
    /// The first token after the start.
    pub forced_bos_token_id: Option<u32>,
    /// The token at the last place that `max_length` leaves.
    pub forced_eos_token_id: Option<u32>,
    /// Tokens that end a sequence.
    pub eos_token_id: EndTokens,
    /// Whether beam search ends as soon as `num_beams` sequences have ended; else when no open one
    /// can become better.
    pub early_stopping: bool,
    /// Sums of log-probabilities are divided by the number of generated tokens to this power.
    pub length_penalty: f64,
    /// Tokens of the longest sequence, the start included.
    pub max_length: usize,
}

impl Default for DecodeConfig {
    /// Greedy search without rules, up to 1025 tokens: the defaults of transformers, except for the
    /// length, which is that of Florence-2's decoder.
    fn default() -> Self {
        Self {
            num_beams: 1,
            no_repeat_ngram_size: 0,
            forced_bos_token_id: None,
            forced_eos_token_id: None,
            eos_token_id: EndTokens::default(),
            early_stopping: false,
            length_penalty: 1.0,
            max_length: 1025,
        }
    }
}

/// One token that ends a sequence, or several.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum EndTokens {
    /// A single one.
    One(u32),
    /// Any of these.
    Any(Vec<u32>),
}

impl Default for EndTokens {
    /// None: sequences end at their greatest length.
    fn default() -> Self {
        Self::Any(Vec::new())
    }
}

impl EndTokens {
    /// Whether a token ends a sequence.
    #[must_use]
    pub fn contains(&self, token: u32) -> bool {
        match self {
            Self::One(end) => *end == token,
            Self::Any(ends) => ends.contains(&token),
        }
    }
}

/// A sequence and how probable the model finds it.
#[derive(Debug, Clone, PartialEq)]
pub struct Sequence {
    /// The tokens, the start included.
    pub ids: Vec<u32>,
    /// Natural logarithm of the probability of each token after the start, given those before it.
    /// Greedy search reports the model's own; in beam search a forced token has 0.
    pub log_probs: Vec<f64>,
    /// Sum of `log_probs` over the number of generated tokens to the power of the length penalty.
    pub score: f64,
}

/// A model's answer to one step: for each sequence a score of every token of the vocabulary, row by
/// row.
pub type Logits = Vec<f32>;

/// Searches for the most probable sequence after `start`.
///
/// `step` takes the last token of each open sequence and, for each, its row in the step before; it
/// returns the scores of the next token, unnormalised, one row per sequence.
///
/// # Errors
/// Those of `step`.
pub fn decode<E>(
    start: u32,
    config: &DecodeConfig,
    mut step: impl FnMut(&[u32], &[usize]) -> Result<Logits, E>,
) -> Result<Sequence, E> {
    if config.num_beams <= 1 {
        greedy(start, config, &mut |token| step(&[token], &[0]))
    } else {
        beam_search(start, config, &mut step)
    }
}

fn greedy<E>(
    start: u32,
    config: &DecodeConfig,
    step: &mut impl FnMut(u32) -> Result<Logits, E>,
) -> Result<Sequence, E> {
    let (mut ids, mut log_probs) = (vec![start], Vec::new());
    let mut last = start;
    while ids.len() < config.max_length {
        let mut scores = step(last)?;
        let normaliser = log_sum_exp(&scores);
        let forced = forced(&ids, config);
        let raw = forced.map(|token| scores.get(token as usize).copied());
        forbid_repeats(&mut scores, &ids, config.no_repeat_ngram_size);
        let Some((token, score)) = best(&scores) else { break };
        let (token, score) = match (forced, raw.flatten()) {
            (Some(token), Some(score)) => (token, score),
            _ => (token, score),
        };
        log_probs.push(f64::from(score) - normaliser);
        ids.push(token);
        last = token;
        if config.eos_token_id.contains(token) {
            break;
        }
    }
    Ok(Beam { ids, sum: log_probs.iter().sum(), log_probs }.finish(config))
}

/// An open sequence.
#[derive(Debug, Clone)]
struct Beam {
    ids: Vec<u32>,
    log_probs: Vec<f64>,
    sum: f64,
}

impl Beam {
    fn with(&self, candidate: &Candidate) -> Self {
        let mut next = self.clone();
        next.ids.push(candidate.token);
        next.log_probs.push(candidate.log_prob);
        next.sum = candidate.sum;
        next
    }

    fn score(&self, config: &DecodeConfig) -> f64 {
        let generated = (self.ids.len() - 1).max(1) as f64;
        self.sum / generated.powf(config.length_penalty)
    }

    fn finish(self, config: &DecodeConfig) -> Sequence {
        let score = self.score(config);
        Sequence { ids: self.ids, log_probs: self.log_probs, score }
    }
}

/// A token that may continue a sequence.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    beam: usize,
    token: u32,
    log_prob: f64,
    sum: f64,
}

fn beam_search<E>(
    start: u32,
    config: &DecodeConfig,
    step: &mut impl FnMut(&[u32], &[usize]) -> Result<Logits, E>,
) -> Result<Sequence, E> {
    let mut beams = vec![Beam { ids: vec![start], log_probs: Vec::new(), sum: 0.0 }];
    let mut rows = vec![0];
    let mut ended: Vec<Sequence> = Vec::new();
    loop {
        let last: Vec<u32> = beams.iter().map(|beam| beam.ids[beam.ids.len() - 1]).collect();
        let scores = step(&last, &rows)?;
        let candidates = candidates(&beams, &scores, config);
        let (mut open, mut parents) = (Vec::new(), Vec::new());
        for (rank, candidate) in candidates.iter().enumerate() {
            let next = beams[candidate.beam].with(candidate);
            let ends = config.eos_token_id.contains(candidate.token);
            if ends || next.ids.len() >= config.max_length {
                if rank < config.num_beams {
                    ended.push(next.finish(config));
                }
            } else if open.len() < config.num_beams {
                open.push(next);
                parents.push(candidate.beam);
            }
        }
        ended.sort_by(|a, b| b.score.total_cmp(&a.score));
        ended.truncate(config.num_beams);
        if open.is_empty() || is_done(&ended, &open, config) {
            break;
        }
        (beams, rows) = (open, parents);
    }
    if ended.is_empty() {
        ended = beams.into_iter().map(|beam| beam.finish(config)).collect();
        ended.sort_by(|a, b| b.score.total_cmp(&a.score));
    }
    Ok(ended.swap_remove(0))
}

/// Whether enough sequences have ended and no open one can overtake them.
fn is_done(ended: &[Sequence], open: &[Beam], config: &DecodeConfig) -> bool {
    let (Some(worst), Some(hope)) = (ended.last(), open.first()) else { return false };
    ended.len() >= config.num_beams && (config.early_stopping || worst.score >= hope.score(config))
}

/// The best continuations of all sequences together, twice as many as there are beams, so that
/// enough remain when some end.
fn candidates(beams: &[Beam], scores: &[f32], config: &DecodeConfig) -> Vec<Candidate> {
    let wanted = 2 * config.num_beams;
    let vocabulary = scores.len() / beams.len();
    let mut all = Vec::with_capacity(wanted * beams.len());
    for (number, (beam, row)) in beams.iter().zip(scores.chunks(vocabulary.max(1))).enumerate() {
        let mut add = |token: u32, log_prob: f64| {
            all.push(Candidate { beam: number, token, log_prob, sum: beam.sum + log_prob });
        };
        if let Some(token) = forced(&beam.ids, config) {
            add(token, 0.0);
            continue;
        }
        let normaliser = log_sum_exp(row);
        let mut row = row.to_vec();
        forbid_repeats(&mut row, &beam.ids, config.no_repeat_ngram_size);
        for token in best_few(&row, wanted) {
            add(token, f64::from(row[token as usize]) - normaliser);
        }
    }
    all.sort_by(|a, b| b.sum.total_cmp(&a.sum));
    all.truncate(wanted);
    all
}

/// The token that must come next, if one must.
fn forced(ids: &[u32], config: &DecodeConfig) -> Option<u32> {
    if ids.len() + 1 == config.max_length && config.forced_eos_token_id.is_some() {
        return config.forced_eos_token_id;
    }
    config.forced_bos_token_id.filter(|_| ids.len() == 1)
}

/// Rules out every token that would complete a run of `size` tokens which is in `ids` already.
fn forbid_repeats(scores: &mut [f32], ids: &[u32], size: usize) {
    if size == 0 || ids.len() + 1 < size {
        return;
    }
    let recent = &ids[ids.len() + 1 - size..];
    for run in ids.windows(size) {
        let Some((token, before)) = run.split_last() else { continue };
        if let (true, Some(score)) = (before == recent, scores.get_mut(*token as usize)) {
            *score = f32::NEG_INFINITY;
        }
    }
}

/// The best token and its score; the first of equals; none if no score is a number above negative
/// infinity.
fn best(scores: &[f32]) -> Option<(u32, f32)> {
    let highest = highest(scores);
    let is_some = highest > f32::NEG_INFINITY;
    let (token, score) = (0..).zip(scores).find(|(_, score)| is_some && **score == highest)?;
    Some((token, *score))
}

/// The best tokens, best first, the first of equals first.
fn best_few(scores: &[f32], count: usize) -> Vec<u32> {
    let mut top: Vec<(u32, f32)> = Vec::with_capacity(count + 1);
    for (token, &score) in (0..).zip(scores) {
        let is_full = top.len() == count;
        if score == f32::NEG_INFINITY || score.is_nan() || is_full && score <= top[count - 1].1 {
            continue;
        }
        let place = top.partition_point(|(_, other)| *other >= score);
        top.insert(place, (token, score));
        top.truncate(count);
    }
    top.into_iter().map(|(token, _)| token).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::convert::Infallible;

    const END: u32 = 0;

    fn config(num_beams: usize) -> DecodeConfig {
        DecodeConfig {
            num_beams,
            eos_token_id: EndTokens::One(END),
            early_stopping: true,
            max_length: 6,
            ..DecodeConfig::default()
        }
    }

    /// A model whose scores depend on the last token only.
    fn run(table: &[[f32; 4]], config: &DecodeConfig) -> Sequence {
        let step = |tokens: &[u32], _: &[usize]| -> Result<Logits, Infallible> {
            Ok(tokens.iter().flat_map(|token| table[*token as usize]).collect())
        };
        decode(3, config, step).unwrap()
    }

    fn logs(p: [f32; 4]) -> [f32; 4] {
        p.map(f32::ln)
    }

    #[test]
    fn beams_find_what_greed_misses() {
        // Greedy takes 1 first (0.5), after which nothing is likely; 2 (0.4) leads to a sure end.
        let table = [
            logs([1.0, 0.0, 0.0, 0.0]),
            logs([0.4, 0.3, 0.3, 0.0]),
            logs([0.99, 0.01, 0.0, 0.0]),
            logs([0.1, 0.5, 0.4, 0.0]),
        ];
        assert_eq!(run(&table, &config(1)).ids, [3, 1, END]);
        let found = run(&table, &config(3));
        assert_eq!(found.ids, [3, 2, END]);
        assert!((found.score - (0.4_f64 * 0.99).ln() / 2.0).abs() < 1e-6, "{}", found.score);
    }

    #[test]
    fn no_run_comes_twice_and_ends_are_forced() {
        let loops = [[0.0; 4], [0.0, 0.0, 5.0, 0.0], [0.0, 5.0, 0.0, 0.0], [0.0, 5.0, 0.0, 0.0]];
        let free = DecodeConfig { forced_eos_token_id: Some(END), ..config(1) };
        assert_eq!(run(&loops, &free).ids, [3, 1, 2, 1, 2, END]);
        let ruled = DecodeConfig { no_repeat_ngram_size: 2, ..free.clone() };
        assert_eq!(run(&loops, &ruled).ids[..5], [3, 1, 2, 1, 0]);
        let begun = DecodeConfig { forced_bos_token_id: Some(2), ..free };
        assert_eq!(run(&loops, &begun).ids[..3], [3, 2, 1]);
    }

    #[test]
    fn log_probabilities_are_the_models_own() {
        let table = [[0.0; 4], [3.0, 1.0, 0.0, 0.0], [0.0; 4], [0.0, 2.0, 0.0, 0.0]];
        let found = run(&table, &config(1));
        assert_eq!(found.ids, [3, 1, END]);
        let first = 2.0 - (2.0_f64.exp() + 3.0).ln();
        assert!((found.log_probs[0] - first).abs() < 1e-6);
        assert!((found.score - found.log_probs.iter().sum::<f64>() / 2.0).abs() < 1e-12);
    }

    proptest! {
        #[test]
        fn hostile_scores_and_rules_end_in_a_sequence(
            table in proptest::collection::vec(proptest::array::uniform4(prop_oneof![
                Just(f32::NAN), Just(f32::NEG_INFINITY), Just(f32::INFINITY), -9.0_f32..9.0]), 4),
            beams in 0_usize..5, size in 0_usize..4, max_length in 0_usize..9, forced in proptest::option::of(0_u32..9),
        ) {
            let table: Vec<[f32; 4]> = table;
            let config = DecodeConfig {
                no_repeat_ngram_size: size, max_length, forced_bos_token_id: forced.map(|f| f % 4), ..config(beams)
            };
            let found = run(&table, &config);
            prop_assert!(found.ids.len() <= max_length.max(2));
            prop_assert_eq!(found.ids.len(), found.log_probs.len() + 1);
        }

        #[test]
        fn the_best_few_are_what_sorting_gives(scores in proptest::collection::vec(-3_i8..3, 0..40), count in 1_usize..8) {
            let scores: Vec<f32> = scores.into_iter().map(f32::from).collect();
            let mut sorted: Vec<u32> = (0..scores.len() as u32).collect();
            sorted.sort_by(|a, b| scores[*b as usize].total_cmp(&scores[*a as usize]));
            sorted.truncate(count);
            prop_assert_eq!(best_few(&scores, count), sorted);
        }
    }
}
