//! The model: a prompt with a picture to the tokens that follow.

use std::fmt;

use super::causal::{Cache, Causal, Position};
use super::text_model::TextModel;
use crate::detector::{PerceptionError, check_graph};
use crate::engine::{DeviceTensor, Engine, Tensor};
use crate::generation::Tokens;
use crate::generation::log_sum_exp;
use crate::generation::{DecodeConfig, Sequence, decode};

/// The parts of a vision-language model, opened by the caller.
#[derive(Debug)]
pub struct VlmParts {
    /// Its vocabulary.
    pub tokens: Tokens,
    /// Pixels to image tokens.
    pub vision_encoder: Box<dyn Engine>,
    /// `input_ids` to `inputs_embeds`.
    pub embed_tokens: Box<dyn Engine>,
    /// Embeddings to scores of the next token.
    pub decoder: Box<dyn Engine>,
    /// Sizes and ids of the text half.
    pub text: TextModel,
}

/// A model that writes about pictures. Several threads may use it at once.
pub struct Vlm {
    tokens: Tokens,
    vision_encoder: Box<dyn Engine>,
    embed_tokens: Box<dyn Engine>,
    causal: Causal,
    text: TextModel,
}

impl fmt::Debug for Vlm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Vlm").field("engine", &self.engine_name()).finish_non_exhaustive()
    }
}

/// The state after a prompt: the caches, and the scores of the next token.
#[derive(Debug)]
pub struct PromptState {
    cache: Cache,
    /// Scores of the next token, unnormalised.
    next: Vec<f32>,
}

impl Vlm {
    /// A model from its parts.
    ///
    /// # Errors
    /// [`PerceptionError::Graph`] if a graph lacks a tensor.
    pub fn new(parts: VlmParts) -> Result<Self, PerceptionError> {
        let (vision, embed) = (&*parts.vision_encoder, &*parts.embed_tokens);
        let expected = "pixel_values and image_features (vision_encoder)";
        check_graph(vision, expected, &["pixel_values"], &["image_features"])?;
        let expected = "input_ids and inputs_embeds (embed_tokens)";
        check_graph(embed, expected, &["input_ids"], &["inputs_embeds"])?;
        Ok(Self {
            causal: Causal::new(parts.decoder, &parts.text)?,
            tokens: parts.tokens,
            vision_encoder: parts.vision_encoder,
            embed_tokens: parts.embed_tokens,
            text: parts.text,
        })
    }

    /// Its vocabulary.
    #[must_use]
    pub fn tokens(&self) -> &Tokens {
        &self.tokens
    }

    /// Name of the engine that runs it.
    #[must_use]
    pub fn engine_name(&self) -> &str {
        self.vision_encoder.name()
    }

    /// Names of the inputs of the vision encoder.
    pub(super) fn vision_inputs(&self) -> &[String] {
        self.vision_encoder.inputs()
    }

    /// Image tokens, row by row, for the inputs of the vision encoder: `pixel_values` and, for some
    /// models, the grid.
    ///
    /// # Errors
    /// When the graph fails.
    pub fn see(&self, inputs: &[(&str, &Tensor)]) -> Result<Vec<f32>, PerceptionError> {
        let found = self.vision_encoder.run(inputs, &["image_features"])?;
        match found.into_iter().next() {
            Some(Tensor::F32 { data, .. }) => Ok(data),
            other => Err(PerceptionError::Output {
                name: "image_features",
                expected: "f32".into(),
                found: other.map_or_else(|| "nothing".into(), |tensor| tensor.describe()),
            }),
        }
    }

    /// Reads the ids of a prompt in which every image token stands for a row of `features`.
    /// `places` are those of the tokens where rows and columns of the picture matter.
    ///
    /// # Errors
    /// When there are not as many image tokens as rows, or a graph fails.
    pub fn read(
        &self,
        ids: &[u32],
        features: &[f32],
        places: Option<&[Position]>,
    ) -> Result<PromptState, PerceptionError> {
        let embeds = self.with_image(ids, features)?;
        let (logits, cache) = self.causal.run(None, &embeds, places, 1)?;
        Ok(PromptState { cache, next: last_row(&logits)? })
    }

    /// Reads further ids, words only, after an earlier prompt.
    ///
    /// # Errors
    /// When a graph fails.
    pub fn read_on(
        &self,
        before: &PromptState,
        ids: &[u32],
    ) -> Result<PromptState, PerceptionError> {
        let embeds = self.embed(ids, [1, ids.len()])?;
        let (logits, cache) = self.causal.run(Some(&before.cache), &embeds, None, 1)?;
        Ok(PromptState { cache, next: last_row(&logits)? })
    }

    /// Generates the answer to a prompt, at most this many tokens. The ids include the end token.
    ///
    /// # Errors
    /// When a graph fails.
    pub fn write(&self, read: PromptState, longest: usize) -> Result<Sequence, PerceptionError> {
        let PromptState { cache, next } = read;
        let (mut cache, mut first) = (cache, Some(next));
        let config =
            DecodeConfig { num_beams: 1, max_length: longest + 1, ..self.text.decode.clone() };
        let mut sequence = decode(self.text.image_token, &config, |last, _| {
            if let Some(next) = first.take() {
                return Ok::<_, PerceptionError>(next);
            }
            let embeds = self.embed(last, [1, 1])?;
            let (logits, longer) = self.causal.run(Some(&cache), &embeds, None, 1)?;
            cache = longer;
            last_row(&logits)
        })?;
        // Decoding begins with a token before the first; here that is the prompt.
        sequence.ids.remove(0);
        Ok(sequence)
    }

    /// Natural logarithm of the probability of each token of each continuation, its end included,
    /// after the prompt.
    ///
    /// # Errors
    /// When a graph fails.
    pub fn weigh(
        &self,
        read: &PromptState,
        continuations: &[Vec<u32>],
    ) -> Result<Vec<Vec<f64>>, PerceptionError> {
        let at_once = self.causal.rows_at_once(&read.cache).max(1);
        let mut all = Vec::with_capacity(continuations.len());
        for some in continuations.chunks(at_once) {
            all.extend(self.weigh_together(read, some)?);
        }
        Ok(all)
    }

    /// All continuations in one run: shorter ones are padded after their end, which does not affect
    /// the tokens before.
    fn weigh_together(
        &self,
        read: &PromptState,
        continuations: &[Vec<u32>],
    ) -> Result<Vec<Vec<f64>>, PerceptionError> {
        let first = |ids: &Vec<u32>| ids.first().map(|id| log_prob(&read.next, *id));
        let firsts: Vec<Option<f64>> = continuations.iter().map(first).collect();
        let longest = continuations.iter().map(Vec::len).max().unwrap_or(0).saturating_sub(1);
        if longest == 0 {
            return Ok(firsts.into_iter().map(|log| log.into_iter().collect()).collect());
        }
        let filled = |ids: &Vec<u32>| {
            let given = ids[..ids.len().saturating_sub(1)].to_vec();
            given.into_iter().chain(std::iter::repeat(0)).take(longest).collect::<Vec<_>>()
        };
        let rows = continuations.len();
        let ids: Vec<u32> = continuations.iter().flat_map(filled).collect();
        let embeds = self.embed(&ids, [rows, longest])?;
        let cache = read.cache.repeated(rows)?;
        let (logits, _) = self.causal.run(Some(&cache), &embeds, None, longest)?;
        let (shape, scores) = logits.floats("logits")?;
        let vocabulary = shape.last().copied().unwrap_or(0);
        let row = |row: usize, place: usize| {
            let start = (row * longest + place) * vocabulary;
            scores.get(start..start + vocabulary).unwrap_or_default()
        };
        let weights = |(number, (ids, first)): (usize, (&Vec<u32>, Option<f64>))| {
            let later = ids.iter().skip(1).enumerate().map(|(p, id)| log_prob(row(number, p), *id));
            first.into_iter().chain(later).collect()
        };
        Ok(continuations.iter().zip(firsts).enumerate().map(weights).collect())
    }

    fn embed(&self, ids: &[u32], shape: [usize; 2]) -> Result<Tensor, PerceptionError> {
        let data = ids.iter().map(|id| i64::from(*id)).collect();
        let ids = Tensor::I64 { shape: shape.to_vec(), data };
        let found = self.embed_tokens.run(&[("input_ids", &ids)], &["inputs_embeds"])?;
        found.into_iter().next().ok_or_else(|| PerceptionError::Output {
            name: "inputs_embeds",
            expected: "f32".into(),
            found: "nothing".into(),
        })
    }

    /// Embeddings of a prompt with image tokens in their places.
    fn with_image(&self, ids: &[u32], features: &[f32]) -> Result<Tensor, PerceptionError> {
        let embeds = self.embed(ids, [1, ids.len()])?;
        let Tensor::F32 { shape, mut data } = embeds else {
            let (expected, found) = ("f32".into(), embeds.describe());
            return Err(PerceptionError::Output { name: "inputs_embeds", expected, found });
        };
        let width = shape.last().copied().unwrap_or(0).max(1);
        let places = ids.iter().filter(|id| **id == self.text.image_token).count();
        if places * width != features.len() {
            return Err(PerceptionError::Output {
                name: "image_features",
                expected: format!("{places} rows of {width}"),
                found: format!("{} numbers", features.len()),
            });
        }
        let images = data
            .chunks_exact_mut(width)
            .zip(ids)
            .filter(|(_, id)| **id == self.text.image_token)
            .map(|(row, _)| row);
        images
            .zip(features.chunks_exact(width))
            .for_each(|(row, image)| row.copy_from_slice(image));
        Ok(Tensor::F32 { shape, data })
    }
}

fn log_prob(scores: &[f32], id: u32) -> f64 {
    let score = scores.get(id as usize).copied().unwrap_or(f32::NEG_INFINITY);
    f64::from(score) - log_sum_exp(scores)
}

/// The scores at the last place of a single row.
fn last_row(logits: &DeviceTensor) -> Result<Vec<f32>, PerceptionError> {
    let (shape, data) = logits.floats("logits")?;
    let vocabulary = shape.last().copied().unwrap_or(0);
    Ok(data[data.len().saturating_sub(vocabulary)..].to_vec())
}
