//! rten: pure Rust, on the processor, needs nothing but this crate.

use std::fmt;
use std::io::Cursor;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use jrdb_types::contained;
use rten::{Model, NodeId, RunOptions, ThreadPool, Value, ValueOrView};

use super::device_tensor::{DeviceTensor, Input};
use super::error::{Cause, EngineError};
use super::interface::{Engine, check_call};
use super::onnx_limits::check_onnx;
use super::rten_value::{NAME, RtenValue, failed, given};

/// A model run by rten. Integers are computed in 32 bits.
pub struct RtenEngine {
    model: Model,
    inputs: Vec<String>,
    outputs: Vec<String>,
    /// Pools of one thread that no run is using. Each run has a thread of its own, so that the
    /// caller decides how much runs at once and the sums do not depend on it.
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
    /// The errors of [`check_onnx`]; [`EngineError::Model`] if the model uses an operator unknown
    /// to rten.
    pub fn from_onnx(bytes: &[u8]) -> Result<Self, EngineError> {
        check_onnx(Cursor::new(bytes), bytes.len() as u64)?;
        Self::load(|| Model::load(bytes.to_vec()))
    }

    /// Reads an ONNX model from a file, and weights that it keeps in files beside it. The file is to
    /// be checked before, with [`check_onnx`]: rten reads some broken files forever.
    ///
    /// # Errors
    /// [`EngineError::Model`] if the file is not an ONNX model or uses an operator unknown to
    /// rten.
    pub fn from_file(path: &Path) -> Result<Self, EngineError> {
        Self::load(|| Model::load_file(path))
    }

    fn load<E: Into<Cause>>(load: impl FnOnce() -> Result<Model, E>) -> Result<Self, EngineError> {
        let refused = |source: Cause| EngineError::Model { engine: NAME, source };
        let loaded = contained(NAME, || load().map(Self::new).map_err(Into::into));
        loaded.map_err(|panic| refused(panic.into()))?.map_err(refused)
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
        // A rayon worker that waits for another pool takes up further jobs of its own meanwhile: a
        // caller that runs many models in parallel would then start them all at once. A plain
        // thread just waits.
        let result = std::thread::scope(|scope| {
            let run = || contained(NAME, || self.model.run(inputs, outputs, Some(options)));
            scope.spawn(run).join()
        });
        idle().push(pool);
        match result {
            Ok(values) => values.map_err(failed)?.map_err(failed),
            Err(_) => Err(failed("the engine panicked")),
        }
    }
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

    fn run_on_device(
        &self,
        inputs: &[(&str, Input<'_>)],
        outputs: &[&str],
    ) -> Result<Vec<DeviceTensor>, EngineError> {
        check_call(self, inputs, outputs)?;
        let values = inputs
            .iter()
            .map(|(name, input)| Ok((self.node(name)?, given(name, *input)?)))
            .collect::<Result<Vec<(NodeId, ValueOrView<'_>)>, EngineError>>()?;
        let nodes = outputs.iter().map(|name| self.node(name)).collect::<Result<Vec<_>, _>>()?;
        let found = self.run_nodes(values, &nodes)?;
        Ok(found.into_iter().map(|value| DeviceTensor::new(RtenValue(value))).collect())
    }
}
