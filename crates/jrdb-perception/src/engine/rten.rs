//! rten: pure Rust, on the processor, needs nothing but this crate.

use std::borrow::Cow;
use std::fmt;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use rten::{Model, NodeId, RunOptions, ThreadPool, Value, ValueOrView, ValueView};
use rten_tensor::prelude::*;

use super::held::Inner;
use super::{Cause, Engine, EngineError, Held, Input, Tensor, check_call};

const NAME: &str = "rten";

/// A model run by rten. Integers are computed in 32 bits.
pub struct RtenEngine {
    model: Model,
    inputs: Vec<String>,
    outputs: Vec<String>,
    /// Pools of one thread that no run is using. Each run has a thread of its own, so that the caller
    /// decides how much runs at once and the sums do not depend on it.
    idle: Mutex<Vec<Arc<ThreadPool>>>,
}

impl fmt::Debug for RtenEngine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut shown = f.debug_struct("RtenEngine");
        shown.field("inputs", &self.inputs).field("outputs", &self.outputs).finish_non_exhaustive()
    }
}

impl RtenEngine {
    /// Reads an ONNX model.
    ///
    /// # Errors
    /// [`EngineError::Model`] if the bytes are no ONNX model or use an operator unknown to rten.
    pub fn from_onnx(bytes: &[u8]) -> Result<Self, EngineError> {
        Model::load(bytes.to_vec())
            .map(Self::new)
            .map_err(|e| EngineError::Model { engine: NAME, source: e.into() })
    }

    /// Reads an ONNX model from a file, and weights that it keeps in files beside it.
    ///
    /// # Errors
    /// [`EngineError::Model`] if the file is no ONNX model or uses an operator unknown to rten.
    pub fn from_file(path: &Path) -> Result<Self, EngineError> {
        Model::load_file(path)
            .map(Self::new)
            .map_err(|e| EngineError::Model { engine: NAME, source: e.into() })
    }

    fn new(model: Model) -> Self {
        let names = |ids: &[NodeId]| -> Vec<String> {
            ids.iter().filter_map(|id| Some(model.node_info(*id)?.name()?.to_owned())).collect()
        };
        let (inputs, outputs) = (names(model.input_ids()), names(model.output_ids()));
        Self { model, inputs, outputs, idle: Mutex::default() }
    }

    fn node(&self, name: &str) -> Result<NodeId, EngineError> {
        self.model.node_id(name).map_err(failed)
    }

    fn run_nodes(
        &self,
        inputs: Vec<(NodeId, ValueOrView<'_>)>,
        outputs: &[NodeId],
    ) -> Result<Vec<Value>, EngineError> {
        let idle = || self.idle.lock().unwrap_or_else(PoisonError::into_inner);
        let free = idle().pop();
        let pool = free.unwrap_or_else(|| Arc::new(ThreadPool::with_num_threads(1)));
        let options = RunOptions::default().with_thread_pool(Some(Arc::clone(&pool)));
        // A rayon worker that waits for another pool takes up further jobs of its own meanwhile: a caller
        // that runs many models in parallel would then start them all at once. A plain thread just waits.
        let result = std::thread::scope(|scope| {
            scope.spawn(|| self.model.run(inputs, outputs, Some(options))).join()
        });
        idle().push(pool);
        match result {
            Ok(values) => values.map_err(failed),
            Err(_) => Err(failed("the engine panicked")),
        }
    }
}

fn failed(source: impl Into<Cause>) -> EngineError {
    EngineError::Run { engine: NAME, source: source.into() }
}

impl Engine for RtenEngine {
    fn name(&self) -> &str {
        NAME
    }

    fn inputs(&self) -> &[String] {
        &self.inputs
    }

    fn outputs(&self) -> &[String] {
        &self.outputs
    }

    fn run(
        &self,
        inputs: &[(&str, &Tensor)],
        outputs: &[&str],
    ) -> Result<Vec<Tensor>, EngineError> {
        let inputs: Vec<(&str, Input<'_>)> =
            inputs.iter().map(|(name, tensor)| (*name, Input::Tensor(tensor))).collect();
        let found = self.run_values(&inputs, outputs)?;
        outputs.iter().zip(found).map(|(name, value)| tensor(name, value)).collect()
    }

    fn run_held(
        &self,
        inputs: &[(&str, Input<'_>)],
        outputs: &[&str],
    ) -> Result<Vec<Held>, EngineError> {
        let found = self.run_values(inputs, outputs)?;
        Ok(found.into_iter().map(|value| Held(Inner::Rten(value))).collect())
    }
}

impl RtenEngine {
    fn run_values(
        &self,
        inputs: &[(&str, Input<'_>)],
        outputs: &[&str],
    ) -> Result<Vec<Value>, EngineError> {
        check_call(inputs, outputs, &self.inputs, &self.outputs)?;
        let values = inputs
            .iter()
            .map(|(name, input)| Ok((self.node(name)?, given(name, *input)?)))
            .collect::<Result<Vec<(NodeId, ValueOrView<'_>)>, EngineError>>()?;
        let nodes = outputs.iter().map(|name| self.node(name)).collect::<Result<Vec<_>, _>>()?;
        self.run_nodes(values, &nodes)
    }
}

fn given<'a>(name: &str, input: Input<'a>) -> Result<ValueOrView<'a>, EngineError> {
    match input {
        Input::Tensor(tensor) => value(name, tensor),
        Input::Held(Held(Inner::Rten(value))) => Ok(value.into()),
        Input::Held(_) => Err(EngineError::Type {
            name: name.into(),
            source: "it is held by another engine".into(),
        }),
    }
}

fn value<'a>(name: &str, tensor: &'a Tensor) -> Result<ValueOrView<'a>, EngineError> {
    match tensor {
        Tensor::F32 { shape, data } => {
            ValueView::from_shape(shape, data).map(Into::into).map_err(failed)
        }
        Tensor::I64 { shape, data } => {
            let narrow = |&found: &i64| {
                i32::try_from(found).map_err(|_| EngineError::Integer { name: name.into(), found })
            };
            let data = data.iter().map(narrow).collect::<Result<Vec<i32>, _>>()?;
            Value::from_shape(shape, data).map(Into::into).map_err(failed)
        }
        Tensor::Bool { shape, data } => {
            let data: Vec<i32> = data.iter().map(|&truth| i32::from(truth)).collect();
            Value::from_shape(shape, data).map(Into::into).map_err(failed)
        }
    }
}

/// Shape and numbers of a value of 32-bit floats; none if it holds something else.
pub(super) fn floats(value: &Value) -> Option<(Vec<usize>, Cow<'_, [f32]>)> {
    let Value::FloatTensor(tensor) = value else { return None };
    Some((tensor.shape().to_vec(), tensor.to_slice()))
}

pub(super) fn tensor(name: &str, value: Value) -> Result<Tensor, EngineError> {
    match value {
        Value::FloatTensor(tensor) => {
            Ok(Tensor::F32 { shape: tensor.shape().to_vec(), data: tensor.into_data() })
        }
        Value::Int32Tensor(tensor) => {
            let shape = tensor.shape().to_vec();
            Ok(Tensor::I64 { shape, data: tensor.into_data().into_iter().map(i64::from).collect() })
        }
        other => Err(EngineError::Type {
            name: name.into(),
            source: format!("found {:?}", other.dtype()).into(),
        }),
    }
}
