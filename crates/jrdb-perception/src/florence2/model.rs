//! The model: a picture and a prompt to tokens.

use std::fmt;

use jrdb_types::Image;

use super::answer::Answer;
use super::config::Florence2Config;
use super::decoder::{Decoder, DecoderParts};
use super::task::Task;
use crate::detector::{PerceptionError, check_graph, check_image};
use crate::engine::{Engine, Tensor};
use crate::generation::Tokens;
use crate::generation::{DecodeConfig, Sequence, decode};

/// The parts of a Florence-2 model, opened by the caller.
#[derive(Debug)]
pub struct Florence2Parts {
    /// Sizes and rules.
    pub config: Florence2Config,
    /// Its vocabulary.
    pub tokens: Tokens,
    /// `pixel_values` to `image_features`.
    pub vision_encoder: Box<dyn Engine>,
    /// `input_ids` to `inputs_embeds`.
    pub embed_tokens: Box<dyn Engine>,
    /// Image and prompt to the states that the decoder attends to.
    pub encoder: Box<dyn Engine>,
    /// Token by token.
    pub decoder: DecoderParts,
}

/// A model that answers tasks about pictures. Several threads may use it at once.
pub struct Florence2 {
    config: Florence2Config,
    tokens: Tokens,
    vision_encoder: Box<dyn Engine>,
    embed_tokens: Box<dyn Engine>,
    encoder: Box<dyn Engine>,
    decoder: Decoder,
}

impl fmt::Debug for Florence2 {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut shown = f.debug_struct("Florence2");
        shown.field("config", &self.config).field("engine", &self.engine_name());
        shown.finish_non_exhaustive()
    }
}

/// The output of the model.
#[derive(Debug, Clone, PartialEq)]
pub struct Reply {
    /// Its tokens with their probabilities.
    pub sequence: Sequence,
    /// The tokens as text, marks included.
    pub text: String,
}

impl Florence2 {
    /// A model from its parts.
    ///
    /// # Errors
    /// [`PerceptionError::Graph`] if a graph lacks a tensor.
    pub fn new(parts: Florence2Parts) -> Result<Self, PerceptionError> {
        let Florence2Parts { config, tokens, vision_encoder, embed_tokens, encoder, decoder } =
            parts;
        let graphs: [(&dyn Engine, _, &[&str], &[&str]); 3] = [
            (
                &*vision_encoder,
                "pixel_values and image_features (vision_encoder)",
                &["pixel_values"],
                &["image_features"],
            ),
            (
                &*embed_tokens,
                "input_ids and inputs_embeds (embed_tokens)",
                &["input_ids"],
                &["inputs_embeds"],
            ),
            (
                &*encoder,
                "attention_mask, inputs_embeds and last_hidden_state (encoder_model)",
                &["attention_mask", "inputs_embeds"],
                &["last_hidden_state"],
            ),
        ];
        for (graph, expected, inputs, outputs) in graphs {
            check_graph(graph, expected, inputs, outputs)?;
        }
        let head = config.hidden / config.heads.max(1);
        Ok(Self {
            decoder: Decoder::new(decoder, config.heads, head)?,
            config,
            tokens,
            vision_encoder,
            embed_tokens,
            encoder,
        })
    }

    /// Sizes and rules.
    #[must_use]
    pub fn config(&self) -> &Florence2Config {
        &self.config
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

    /// Asks about a picture, with the model's own rules of decoding.
    ///
    /// # Errors
    /// When the picture has no pixels, the prompt cannot be spelled or a graph fails.
    pub fn ask(&self, image: &Image, task: &Task) -> Result<Reply, PerceptionError> {
        check_image(image)?;
        let seen = self.see(&self.config.picture.prepare(image))?;
        let sequence = self.answer(&seen, &self.spell(task)?, &self.config.decode)?;
        let text = self.tokens.decode(&sequence.ids)?;
        Ok(Reply { sequence, text })
    }

    /// The ids of a task's prompt.
    ///
    /// # Errors
    /// When the prompt cannot be spelled.
    pub fn spell(&self, task: &Task) -> Result<Vec<u32>, PerceptionError> {
        self.tokens.encode_input(&task.prompt())
    }

    /// The image tokens of a prepared picture, f32 `[1, tokens, hidden]`.
    ///
    /// # Errors
    /// When the graph fails.
    pub fn see(&self, prepared: &[f32]) -> Result<Tensor, PerceptionError> {
        let pixels = self.config.picture.tensor(&[prepared.to_vec()]);
        one(self.vision_encoder.run(&[("pixel_values", &pixels)], &["image_features"])?)
    }

    /// Answers a prompt about image tokens.
    ///
    /// # Errors
    /// When a graph fails.
    pub fn answer(
        &self,
        seen: &Tensor,
        prompt: &[u32],
        config: &DecodeConfig,
    ) -> Result<Sequence, PerceptionError> {
        let (hidden, mask) = self.encode(seen, prompt)?;
        let mut state = self.decoder.start(&hidden, &mask);
        let embed = |ids: &[u32]| self.embed(ids, [ids.len(), 1]);
        decode(self.config.start_token, config, |last, rows| {
            self.decoder.step(&mut state, &embed(last)?, rows)
        })
    }

    /// Reads a reply to a task about a picture of this size, pixels.
    #[must_use]
    pub fn read(&self, reply: &Reply, task: &Task, size_px: [f64; 2]) -> Answer {
        task.grammar().read(&reply.text, size_px, &self.config.no_phrases)
    }

    /// The states that the decoder attends to, f32 `[1, tokens, hidden]`, and their mask.
    ///
    /// # Errors
    /// When the graph fails.
    pub fn encode(
        &self,
        seen: &Tensor,
        prompt: &[u32],
    ) -> Result<(Tensor, Tensor), PerceptionError> {
        let words = self.embed(prompt, [1, prompt.len()])?;
        let embeds = join(seen, &words)?;
        let length = embeds.shape()[1];
        let mask = Tensor::I64 { shape: vec![1, length], data: vec![1; length] };
        let inputs = [("attention_mask", &mask), ("inputs_embeds", &embeds)];
        let hidden = one(self.encoder.run(&inputs, &["last_hidden_state"])?)?;
        Ok((hidden, mask))
    }

    fn embed(&self, ids: &[u32], shape: [usize; 2]) -> Result<Tensor, PerceptionError> {
        let data = ids.iter().map(|id| i64::from(*id)).collect();
        let ids = Tensor::I64 { shape: shape.to_vec(), data };
        one(self.embed_tokens.run(&[("input_ids", &ids)], &["inputs_embeds"])?)
    }
}

/// The only requested output.
fn one(mut outputs: Vec<Tensor>) -> Result<Tensor, PerceptionError> {
    outputs.pop().ok_or_else(|| PerceptionError::Output {
        name: "the only output",
        expected: "a tensor".into(),
        found: "nothing".into(),
    })
}

/// Two tensors f32 `[1, n, hidden]` one after the other.
fn join(first: &Tensor, second: &Tensor) -> Result<Tensor, PerceptionError> {
    match (first, second) {
        (Tensor::F32 { shape: a, data: x }, Tensor::F32 { shape: b, data: y })
            if a.len() == 3 && b.len() == 3 && a[2] == b[2] && a[0] == 1 && b[0] == 1 =>
        {
            let data = [x.as_slice(), y.as_slice()].concat();
            Ok(Tensor::F32 { shape: vec![1, a[1] + b[1], a[2]], data })
        }
        _ => Err(PerceptionError::Output {
            name: "image_features",
            expected: format!("f32 [1, tokens, hidden], as wide as {}", second.describe()),
            found: first.describe(),
        }),
    }
}
