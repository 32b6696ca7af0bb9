//! The text decoder, one token at a time, with its caches left in the engine's memory.

use crate::detector::PerceptionError;
use crate::engine::{DeviceTensor, Engine, Input, Tensor};
use crate::generation::Logits;

/// The graphs that decode.
#[derive(Debug)]
pub enum DecoderParts {
    /// `decoder_model` for the first token, which makes the caches, and `decoder_with_past_model`
    /// for the others.
    Split {
        /// Without caches.
        first: Box<dyn Engine>,
        /// With caches.
        next: Box<dyn Engine>,
    },
    /// `decoder_model_merged`, which does both.
    Merged(Box<dyn Engine>),
}

/// The decoder with the names of its caches.
pub(super) struct Decoder {
    parts: DecoderParts,
    /// Names of the caches without the prefix, those of the text first: `0.decoder.key`.
    own: Vec<String>,
    /// Those of the encoder's output: `0.encoder.key`.
    cross: Vec<String>,
    /// Names of all caches as inputs, those of the text first.
    past: Vec<String>,
    /// Names of the scores and of all caches as outputs, in the same order.
    outputs: Vec<String>,
    heads: usize,
    head_width: usize,
}

/// The state of a search: the encoder's output, and the caches after the last step.
pub(super) struct State<'a> {
    hidden: &'a Tensor,
    mask: &'a Tensor,
    own: Vec<DeviceTensor>,
    cross: Vec<DeviceTensor>,
    /// For how many sequences the mask and `cross` are repeated.
    rows: usize,
    repeated_mask: Option<Tensor>,
    repeated_hidden: Option<Tensor>,
    repeated: Vec<DeviceTensor>,
}

const PAST: &str = "past_key_values.";
const PRESENT: &str = "present.";

impl Decoder {
    pub(super) fn new(
        parts: DecoderParts,
        heads: usize,
        head_width: usize,
    ) -> Result<Self, PerceptionError> {
        let first = match &parts {
            DecoderParts::Split { first, .. } => first,
            DecoderParts::Merged(merged) => merged,
        };
        let caches = |kind: &str| -> Vec<String> {
            let names = first.outputs().iter().filter_map(|name| name.strip_prefix(PRESENT));
            names.filter(|name| name.contains(kind)).map(Into::into).collect()
        };
        let (own, cross) = (caches(".decoder."), caches(".encoder."));
        if own.is_empty() || own.len() != cross.len() {
            let known = first.outputs().to_vec();
            return Err(PerceptionError::Graph {
                expected: "outputs present.*.decoder.* and as many present.*.encoder.*",
                known,
            });
        }
        let all = || own.iter().chain(&cross);
        let past = all().map(|name| format!("{PAST}{name}")).collect();
        let present = all().map(|name| format!("{PRESENT}{name}"));
        let outputs = std::iter::once("logits".to_owned()).chain(present).collect();
        Ok(Self { parts, past, outputs, own, cross, heads, head_width })
    }

    /// The beginning of a search.
    pub(super) fn start<'a>(&self, hidden: &'a Tensor, mask: &'a Tensor) -> State<'a> {
        State {
            hidden,
            mask,
            own: Vec::new(),
            cross: Vec::new(),
            rows: 0,
            repeated_mask: None,
            repeated_hidden: None,
            repeated: Vec::new(),
        }
    }

    /// The scores after one more token of each sequence, which continues the given row of the last
    /// step.
    pub(super) fn step(
        &self,
        state: &mut State<'_>,
        embeds: &Tensor,
        rows: &[usize],
    ) -> Result<Logits, PerceptionError> {
        let mut outputs = if state.own.is_empty() {
            self.first(state, embeds)?
        } else {
            self.next(state, embeds, rows)?
        };
        let caches = outputs.split_off(1);
        let logits = last_rows(&outputs[0])?;
        if state.own.is_empty() {
            let mut caches = caches;
            state.cross = caches.split_off(self.own.len());
            state.own = caches;
        } else {
            state.own = caches;
        }
        Ok(logits)
    }

    fn first(
        &self,
        state: &State<'_>,
        embeds: &Tensor,
    ) -> Result<Vec<DeviceTensor>, PerceptionError> {
        let mut inputs: Vec<(&str, Input<'_>)> = vec![
            ("encoder_attention_mask", state.mask.into()),
            ("encoder_hidden_states", state.hidden.into()),
            ("inputs_embeds", embeds.into()),
        ];
        match &self.parts {
            DecoderParts::Split { first, .. } => run(&**first, &inputs, &self.outputs),
            DecoderParts::Merged(merged) => {
                let (empty, flag) = (self.empty(), truth(false));
                inputs.extend(self.past.iter().map(|name| (name.as_str(), Input::from(&empty))));
                inputs.push(("use_cache_branch", (&flag).into()));
                run(&**merged, &inputs, &self.outputs)
            }
        }
    }

    fn next(
        &self,
        state: &mut State<'_>,
        embeds: &Tensor,
        rows: &[usize],
    ) -> Result<Vec<DeviceTensor>, PerceptionError> {
        state.follow(rows, &self.own)?;
        state.repeat(rows.len(), &self.cross)?;
        let outputs = &self.outputs[..=self.own.len()];
        let cross = if state.repeated.is_empty() { &state.cross } else { &state.repeated };
        let caches = state.own.iter().chain(cross);
        let mut inputs: Vec<(&str, Input<'_>)> = vec![
            ("encoder_attention_mask", state.repeated_mask.as_ref().unwrap_or(state.mask).into()),
            ("inputs_embeds", embeds.into()),
        ];
        inputs.extend(self.past.iter().map(String::as_str).zip(caches.map(Input::from)));
        match &self.parts {
            DecoderParts::Split { next, .. } => run(&**next, &inputs, outputs),
            DecoderParts::Merged(merged) => {
                let flag = truth(true);
                let hidden = state.repeated_hidden.as_ref().unwrap_or(state.hidden);
                inputs.push(("encoder_hidden_states", hidden.into()));
                inputs.push(("use_cache_branch", (&flag).into()));
                run(&**merged, &inputs, outputs)
            }
        }
    }

    /// A cache of nothing.
    fn empty(&self) -> Tensor {
        Tensor::F32 { shape: vec![1, self.heads, 0, self.head_width], data: Vec::new() }
    }
}

impl State<'_> {
    /// Puts the caches of the text into the order of the sequences that go on.
    fn follow(&mut self, rows: &[usize], names: &[String]) -> Result<(), PerceptionError> {
        let stays = rows.iter().copied().eq(0..self.rows.max(1));
        if !stays {
            let gather = |(cache, name): (&DeviceTensor, &String)| cache.gather_rows(name, rows);
            self.own = self.own.iter().zip(names).map(gather).collect::<Result<_, _>>()?;
        }
        Ok(())
    }

    /// Repeats the tensors of the picture for this many sequences.
    fn repeat(&mut self, rows: usize, names: &[String]) -> Result<(), PerceptionError> {
        if rows == self.rows.max(1) {
            self.rows = rows;
            return Ok(());
        }
        let gather =
            |(cache, name): (&DeviceTensor, &String)| cache.gather_rows(name, &vec![0; rows]);
        self.repeated = self.cross.iter().zip(names).map(gather).collect::<Result<_, _>>()?;
        self.repeated_mask = Some(repeat(self.mask, rows));
        self.repeated_hidden = Some(repeat(self.hidden, rows));
        self.rows = rows;
        Ok(())
    }
}

fn truth(value: bool) -> Tensor {
    Tensor::Bool { shape: vec![1], data: vec![value] }
}

fn run(
    engine: &dyn Engine,
    inputs: &[(&str, Input<'_>)],
    outputs: &[String],
) -> Result<Vec<DeviceTensor>, PerceptionError> {
    let outputs: Vec<&str> = outputs.iter().map(String::as_str).collect();
    Ok(engine.run_on_device(inputs, &outputs)?)
}

/// A tensor `[1, ..]`, repeated `rows` times.
fn repeat(tensor: &Tensor, rows: usize) -> Tensor {
    let longer = |shape: &[usize]| [&[rows], &shape[1..]].concat();
    match tensor {
        Tensor::F32 { shape, data } => {
            Tensor::F32 { shape: longer(shape), data: data.repeat(rows) }
        }
        Tensor::I64 { shape, data } => {
            Tensor::I64 { shape: longer(shape), data: data.repeat(rows) }
        }
        Tensor::Bool { shape, data } => {
            Tensor::Bool { shape: longer(shape), data: data.repeat(rows) }
        }
    }
}

/// The scores of the last place of each row, from f32 `[rows, places, vocabulary]`.
fn last_rows(logits: &DeviceTensor) -> Result<Logits, PerceptionError> {
    let (shape, data) = logits.floats("logits")?;
    let &[_, places, vocabulary] = shape.as_slice() else {
        let expected = "f32 [rows, places, vocabulary]".into();
        let found = format!("f32 {shape:?}");
        return Err(PerceptionError::Output { name: "logits", expected, found });
    };
    let width = (places * vocabulary).max(1);
    let mut last = Vec::with_capacity(data.len() / width * vocabulary);
    for row in data.chunks_exact(width) {
        last.extend_from_slice(&row[width - vocabulary..]);
    }
    Ok(last)
}
