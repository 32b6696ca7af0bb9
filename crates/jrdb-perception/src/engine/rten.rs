//! rten: pure Rust, on the processor, needs nothing but this crate.

use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use rten::{
    Model, NodeId, RunOptions, ThreadPool, TryFromValueError, Value, ValueOrView, ValueView,
};

use super::{Cause, Engine, EngineError, Tensor, check_call};

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
        let model = Model::load(bytes.to_vec())
            .map_err(|e| EngineError::Model { engine: NAME, source: e.into() })?;
        let names = |ids: &[NodeId]| -> Vec<String> {
            ids.iter().filter_map(|id| Some(model.node_info(*id)?.name()?.to_owned())).collect()
        };
        let (inputs, outputs) = (names(model.input_ids()), names(model.output_ids()));
        Ok(Self { model, inputs, outputs, idle: Mutex::default() })
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

    fn run(
        &self,
        inputs: &[(&str, &Tensor)],
        outputs: &[&str],
    ) -> Result<Vec<Tensor>, EngineError> {
        check_call(inputs, outputs, &self.inputs, &self.outputs)?;
        let values = inputs
            .iter()
            .map(|(name, tensor)| Ok((self.node(name)?, value(name, tensor)?)))
            .collect::<Result<Vec<(NodeId, ValueOrView<'_>)>, EngineError>>()?;
        let nodes = outputs.iter().map(|name| self.node(name)).collect::<Result<Vec<_>, _>>()?;
        let found = self.run_nodes(values, &nodes)?;
        outputs.iter().zip(found).map(|(name, value)| tensor(name, value)).collect()
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
    }
}

/// Shape and numbers of a value of any rank up to 6: rten gives them for a known rank only, and tells the
/// rank when asked for a scalar.
macro_rules! shape_and_data {
    ($value:expr, $number:ty) => {
        shape_and_data!($value, $number, 1 2 3 4 5 6)
    };
    ($value:expr, $number:ty, $($rank:literal)+) => {
        match $value.clone().into_shape_vec::<$number, 0>() {
            Ok((_, data)) => Ok((Vec::new(), data)),
            $(Err(TryFromValueError::WrongRank { actual: $rank, .. }) => {
                $value.into_shape_vec::<$number, $rank>().map(|(shape, data)| (shape.to_vec(), data))
            })+
            Err(error) => Err(error),
        }
    };
}

fn tensor(name: &str, value: Value) -> Result<Tensor, EngineError> {
    let wrong = |e: TryFromValueError| EngineError::Type { name: name.into(), source: e.into() };
    if matches!(value, Value::Int32Tensor(_)) {
        let (shape, data) = shape_and_data!(value, i32).map_err(wrong)?;
        return Ok(Tensor::I64 { shape, data: data.into_iter().map(i64::from).collect() });
    }
    let (shape, data) = shape_and_data!(value, f32).map_err(wrong)?;
    Ok(Tensor::F32 { shape, data })
}
