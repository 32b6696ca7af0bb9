//! The trait that every engine implements.

use std::fmt;

use super::device_tensor::{DeviceTensor, Input};
use super::error::EngineError;
use super::tensor::Tensor;

/// Runs one model. Several threads may call it at once.
pub trait Engine: Send + Sync + fmt::Debug {
    /// Name of the engine, for reports: `rten`, `onnxruntime`.
    fn name(&self) -> &str;

    /// Names of the model's inputs.
    fn inputs(&self) -> &[String];

    /// Names of the model's outputs.
    fn outputs(&self) -> &[String];

    /// Runs the model and returns the named outputs, in that order, in the memory of the engine.
    ///
    /// An output that is only passed to the engine again, such as a cache, is never copied.
    ///
    /// # Errors
    /// When a name, type or shape does not match the model, or an operator fails.
    fn run_on_device(
        &self,
        inputs: &[(&str, Input<'_>)],
        outputs: &[&str],
    ) -> Result<Vec<DeviceTensor>, EngineError>;

    /// Runs the model and returns the named outputs, in that order.
    ///
    /// # Errors
    /// As [`Engine::run_on_device`].
    fn run(
        &self,
        inputs: &[(&str, &Tensor)],
        outputs: &[&str],
    ) -> Result<Vec<Tensor>, EngineError> {
        let inputs: Vec<(&str, Input<'_>)> =
            inputs.iter().map(|(name, tensor)| (*name, Input::Host(tensor))).collect();
        let found = self.run_on_device(&inputs, outputs)?;
        outputs.iter().zip(found).map(|(name, value)| value.into_tensor(name)).collect()
    }
}

/// Checks that the engine knows every name, that no input is missing, and that every tensor has as
/// many elements as its shape requires. Engines call it before a run.
///
/// # Errors
/// [`EngineError::Name`], [`EngineError::MissingInput`] or [`EngineError::Length`].
pub fn check_call(
    engine: &impl Engine,
    inputs: &[(&str, Input<'_>)],
    outputs: &[&str],
) -> Result<(), EngineError> {
    for (name, input) in inputs {
        check_name("input", name, engine.inputs())?;
        if let Input::Host(tensor) = input {
            tensor.check(name)?;
        }
    }
    for known in engine.inputs() {
        if inputs.iter().all(|(name, _)| name != known) {
            let (name, known) = (known.clone(), engine.inputs().to_vec());
            return Err(EngineError::MissingInput { name, known });
        }
    }
    outputs.iter().try_for_each(|name| check_name("output", name, engine.outputs()))
}

fn check_name(kind: &'static str, name: &str, known: &[String]) -> Result<(), EngineError> {
    if known.iter().any(|k| k == name) {
        return Ok(());
    }
    Err(EngineError::Name { kind, name: name.into(), known: known.to_vec() })
}
