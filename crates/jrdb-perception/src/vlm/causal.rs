//! The text decoder: embeddings in, scores out, with caches that stay in the engine's memory.

use super::text_model::TextModel;
use crate::detector::PerceptionError;
use crate::engine::{DeviceTensor, Engine, Input, Tensor};

const PAST: &str = "past_key_values.";
const PRESENT: &str = "present.";

/// Caches of rows that are read at once may together be this large, bytes.
const CACHES_MAX: usize = 256 << 20;

/// The place of a token: in time, row and column. Words count alike on all three.
pub type Position = [i64; 3];

/// A decoder that takes embeddings and caches of what it read before.
pub(super) struct Causal {
    engine: Box<dyn Engine>,
    /// Names of the caches as inputs: `past_key_values.0.key`.
    past: Vec<String>,
    /// Names of the scores and of the caches as outputs, in the same order.
    outputs: Vec<String>,
    heads: usize,
    head_width: usize,
    /// Whether tokens have places in rows and columns, too.
    is_spatial: bool,
}

/// The caches of the tokens that a decoder has read.
#[derive(Debug)]
pub struct Cache {
    tensors: Vec<DeviceTensor>,
    /// How many tokens.
    length: usize,
    /// The place of the next one, which is smaller where a picture's tokens share places.
    next: i64,
}

impl Cache {
    /// The same, repeated for this many rows.
    pub(super) fn repeated(&self, rows: usize) -> Result<Self, PerceptionError> {
        let gather = |cache: &DeviceTensor| cache.gather_rows("a cache", &vec![0; rows]);
        Ok(Self { tensors: self.tensors.iter().map(gather).collect::<Result<_, _>>()?, ..*self })
    }
}

impl Causal {
    pub(super) fn new(engine: Box<dyn Engine>, text: &TextModel) -> Result<Self, PerceptionError> {
        let caches = engine.inputs().iter().filter_map(|name| name.strip_prefix(PAST));
        let past: Vec<String> = caches.clone().map(|name| format!("{PAST}{name}")).collect();
        let present = caches.map(|name| format!("{PRESENT}{name}"));
        let outputs: Vec<String> = std::iter::once("logits".to_owned()).chain(present).collect();
        if past.is_empty() || !outputs.iter().all(|name| engine.outputs().contains(name)) {
            let known = [engine.inputs(), engine.outputs()].concat();
            let expected = "inputs past_key_values.* and an output present.* for each";
            return Err(PerceptionError::Graph { expected, known });
        }
        let (heads, head_width) = (text.cache_heads, text.cache_width);
        Ok(Self { engine, past, outputs, heads, head_width, is_spatial: text.is_spatial })
    }

    /// How many rows with such a cache fit into the memory that may be used.
    pub(super) fn rows_at_once(&self, cache: &Cache) -> usize {
        let numbers = self.past.len() * self.heads * self.head_width * cache.length;
        CACHES_MAX / (size_of::<f32>() * numbers.max(1))
    }

    /// Reads embeddings f32 `[rows, tokens, width]` after what the cache holds. Their positions
    /// continue from there unless given. The scores cover at least the `wanted` last tokens.
    pub(super) fn run(
        &self,
        before: Option<&Cache>,
        embeds: &Tensor,
        places: Option<&[Position]>,
        wanted: usize,
    ) -> Result<(DeviceTensor, Cache), PerceptionError> {
        let [rows, tokens] = [embeds.shape()[0], embeds.shape()[1]];
        let total = before.map_or(0, |cache| cache.length) + tokens;
        let next = before.map_or(0, |cache| cache.next);
        let in_a_row: Vec<Position> = (next..).map(|place| [place; 3]).take(tokens).collect();
        let places = places.unwrap_or(&in_a_row);
        let next = places.iter().flatten().max().map_or(next, |last| last + 1);
        let mask = Tensor::I64 { shape: vec![rows, total], data: vec![1; rows * total] };
        let positions = self.positions(rows, places);
        let empty = self.empty(rows);
        let keep = Tensor::I64 { shape: Vec::new(), data: vec![wanted as i64] };
        let flag = Tensor::Bool { shape: vec![1], data: vec![before.is_some()] };
        let mut inputs: Vec<(&str, Input<'_>)> = vec![("inputs_embeds", embeds.into())];
        let optional = [
            ("attention_mask", &mask),
            ("position_ids", &positions),
            ("num_logits_to_keep", &keep),
            ("use_cache_branch", &flag),
        ];
        let has = |name: &str| self.engine.inputs().iter().any(|known| known == name);
        inputs.extend(
            optional
                .into_iter()
                .filter(|(name, _)| has(name))
                .map(|(n, tensor)| (n, tensor.into())),
        );
        for (index, name) in self.past.iter().enumerate() {
            let tensor = before.and_then(|cache| cache.tensors.get(index));
            inputs.push((name, tensor.map_or_else(|| (&empty).into(), Input::from)));
        }
        let outputs: Vec<&str> = self.outputs.iter().map(String::as_str).collect();
        let mut found = self.engine.run_on_device(&inputs, &outputs)?;
        let tensors = found.split_off(1);
        Ok((found.remove(0), Cache { tensors, length: total, next }))
    }

    /// The places of tokens, i64 `[rows, tokens]`, or `[3, rows, tokens]` for models with positions
    /// in rows and columns.
    fn positions(&self, rows: usize, places: &[Position]) -> Tensor {
        let axes = if self.is_spatial { 3 } else { 1 };
        let of_axis = |axis: usize| places.iter().map(|p| p[axis]).collect::<Vec<_>>().repeat(rows);
        let data = (0..axes).flat_map(of_axis).collect();
        let shape =
            if self.is_spatial { vec![3, rows, places.len()] } else { vec![rows, places.len()] };
        Tensor::I64 { shape, data }
    }

    /// A cache of nothing.
    fn empty(&self, rows: usize) -> Tensor {
        Tensor::F32 { shape: vec![rows, self.heads, 0, self.head_width], data: Vec::new() }
    }
}
