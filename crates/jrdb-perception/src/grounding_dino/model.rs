//! The model: a picture and a prompt to boxes.

use std::fmt;

use jrdb_types::Image;
use serde::{Deserialize, Serialize};

use super::picture::CanvasConfig;
use crate::detector::{PerceptionError, check_graph, check_image};
use crate::engine::{Engine, Tensor};
use crate::generation::Tokens;

/// Which boxes are taken.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct GroundingConfig {
    /// Least confidence of a box. Default 0.4, as transformers' example for MM-Grounding-DINO has
    /// it.
    pub threshold: f64,
    /// Least confidence of a token to be part of a box's label. Default 0.3, from the same place.
    pub text_threshold: f64,
}

impl Default for GroundingConfig {
    /// Each field documents the source of its number.
    fn default() -> Self {
        Self { threshold: 0.4, text_threshold: 0.3 }
    }
}

/// A box for a phrase.
#[derive(Debug, Clone, PartialEq)]
pub struct Grounded {
    /// Corners x0, y0, x1, y1, pixels of the picture.
    pub corners: [f64; 4],
    /// Confidence in `[0, 1]`: the greatest of its tokens'.
    pub score: f64,
    /// The tokens above the threshold as text, as in the reference; may contain special and
    /// unrelated tokens.
    pub tokens: String,
    /// Index of the phrase whose tokens have the greatest total confidence.
    pub phrase: usize,
}

/// The output of the model: for each query the unnormalised scores of the prompt's tokens, and a
/// box.
#[derive(Debug, Clone, PartialEq)]
pub struct GroundingOutput {
    /// f32 `[queries, columns]`.
    pub logits: Vec<f32>,
    /// Columns of `logits`.
    pub columns: usize,
    /// Middle x, y, width, height of each, in parts of the picture.
    pub boxes: Vec<[f32; 4]>,
}

/// A model that locates phrases. Several threads may use it at once.
pub struct GroundingDino {
    engine: Box<dyn Engine>,
    tokens: Tokens,
    canvas: CanvasConfig,
}

impl fmt::Debug for GroundingDino {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("GroundingDino").field("canvas", &self.canvas).finish_non_exhaustive()
    }
}

/// Longest prompt, tokens: the width of the model's scores.
const TOKENS_MAX: usize = 256;

impl GroundingDino {
    /// A model from its parts.
    ///
    /// # Errors
    /// [`PerceptionError::Graph`] if the graph lacks a tensor.
    pub fn new(
        engine: Box<dyn Engine>,
        tokens: Tokens,
        canvas: CanvasConfig,
    ) -> Result<Self, PerceptionError> {
        let expected = "pixel_values, input_ids, logits and pred_boxes";
        let inputs = ["pixel_values", "input_ids"];
        check_graph(&*engine, expected, &inputs, &["logits", "pred_boxes"])?;
        Ok(Self { engine, tokens, canvas })
    }

    /// Name of the engine that runs it.
    #[must_use]
    pub fn engine_name(&self) -> &str {
        self.engine.name()
    }

    /// The ids of a prompt, which may be a sentence.
    ///
    /// # Errors
    /// [`PerceptionError::Tokens`] if it cannot be spelled, [`PerceptionError::Setting`] if it is
    /// too long.
    pub fn spell(&self, prompt: &str) -> Result<Vec<u32>, PerceptionError> {
        let ids = self.tokens.encode_input(&prompt.to_lowercase())?;
        if ids.len() > TOKENS_MAX {
            let (setting, expected) = ("tokens of the prompt", "at most 256");
            return Err(PerceptionError::Setting { setting, expected, found: ids.len() as f64 });
        }
        Ok(ids)
    }

    /// Runs the model on a picture and the ids of a prompt.
    ///
    /// # Errors
    /// When the picture has no pixels or the graph fails.
    pub fn look(&self, image: &Image, ids: &[u32]) -> Result<GroundingOutput, PerceptionError> {
        check_image(image)?;
        let canvas = self.canvas.prepare(image);
        let row = |data: Vec<i64>| Tensor::I64 { shape: vec![1, ids.len()], data };
        let spelled = row(ids.iter().map(|id| i64::from(*id)).collect());
        let (types, attention) = (row(vec![0; ids.len()]), row(vec![1; ids.len()]));
        let all = [
            ("pixel_values", &canvas.pixels),
            ("input_ids", &spelled),
            ("token_type_ids", &types),
            ("attention_mask", &attention),
            ("pixel_mask", &canvas.mask),
        ];
        let wanted = |name: &str| self.engine.inputs().iter().any(|known| known == name);
        let inputs: Vec<_> = all.into_iter().filter(|(name, _)| wanted(name)).collect();
        let mut found = self.engine.run(&inputs, &["logits", "pred_boxes"])?;
        match (found.pop(), found.pop()) {
            (
                Some(Tensor::F32 { shape: box_shape, data: boxes }),
                Some(Tensor::F32 { shape, data: logits }),
            ) if shape.len() == 3 && box_shape.last() == Some(&4) => {
                let boxes = boxes.as_chunks::<4>().0.to_vec();
                Ok(GroundingOutput { logits, columns: shape[2], boxes })
            }
            (boxes, logits) => {
                let say = |t: Option<Tensor>| t.map_or("nothing".into(), |t| t.describe());
                let expected = "f32 [1, queries, columns], and boxes f32 [1, queries, 4]".into();
                let found = format!("{}, {}", say(logits), say(boxes));
                Err(PerceptionError::Output { name: "logits", expected, found })
            }
        }
    }

    /// The boxes above the threshold, in the model's order.
    ///
    /// # Errors
    /// When the tokens of a label cannot be read.
    pub fn grounded(
        &self,
        output: &GroundingOutput,
        ids: &[u32],
        size_px: [f64; 2],
        config: &GroundingConfig,
    ) -> Result<Vec<Grounded>, PerceptionError> {
        let phrases = self.phrases(ids)?;
        let mut found = Vec::new();
        for (row, bbox) in output.logits.chunks_exact(output.columns.max(1)).zip(&output.boxes) {
            let sure: Vec<f64> = row.iter().map(|logit| sigmoid(f64::from(*logit))).collect();
            let score = sure.iter().copied().fold(0.0, f64::max);
            if score > config.threshold {
                let named = |at: &usize| sure[*at] > config.text_threshold;
                let last = sure.len().saturating_sub(1).min(ids.len());
                let label: Vec<u32> = (1..last).filter(named).map(|at| ids[at]).collect();
                let tokens = self.tokens.decode(&label)?;
                let phrase = phrase(&sure, &phrases);
                found.push(Grounded { corners: corners(bbox, size_px), score, tokens, phrase });
            }
        }
        Ok(found)
    }

    /// Which phrase each token of a prompt belongs to; none for the marks around and the stops
    /// between.
    ///
    /// # Errors
    /// When the vocabulary has no stops.
    pub fn phrases(&self, ids: &[u32]) -> Result<Vec<Option<usize>>, PerceptionError> {
        let marks = [self.tokens.id("[CLS]")?, self.tokens.id("[SEP]")?];
        let stops = [self.tokens.id(".")?, self.tokens.id("?")?];
        let (mut phrase, mut is_open) = (0, false);
        let mut of = |id: &u32| {
            if marks.contains(id) {
                return None;
            }
            if stops.contains(id) {
                phrase += usize::from(is_open);
                is_open = false;
                return None;
            }
            is_open = true;
            Some(phrase)
        };
        Ok(ids.iter().map(&mut of).collect())
    }
}

/// The phrase whose tokens have the greatest total confidence; the first of equals.
fn phrase(sure: &[f64], phrases: &[Option<usize>]) -> usize {
    let count = phrases.iter().flatten().max().map_or(0, |last| last + 1);
    let mut sums = vec![0.0; count];
    for (confidence, phrase) in sure.iter().zip(phrases) {
        if let Some(phrase) = phrase {
            sums[*phrase] += confidence;
        }
    }
    (0..count).rev().max_by(|a, b| sums[*a].total_cmp(&sums[*b])).unwrap_or(0)
}

fn corners([x, y, w, h]: &[f32; 4], [width, height]: [f64; 2]) -> [f64; 4] {
    let [x, y, w, h] = [*x, *y, *w, *h].map(f64::from);
    [(x - w / 2.0) * width, (y - h / 2.0) * height, (x + w / 2.0) * width, (y + h / 2.0) * height]
}

fn sigmoid(logit: f64) -> f64 {
    1.0 / (1.0 + (-logit).exp())
}
