//! An engine for unit tests: no graph, the same outputs always.

use crate::engine::{DeviceTensor, Engine, EngineError, Input, Tensor};

/// Answers every run with these outputs, whatever is asked.
#[derive(Debug)]
pub(crate) struct Fixed(pub Vec<Tensor>);

impl Engine for Fixed {
    fn name(&self) -> &str {
        "fixed"
    }

    fn inputs(&self) -> &[String] {
        &[]
    }

    fn outputs(&self) -> &[String] {
        &[]
    }

    fn run_on_device(
        &self,
        _: &[(&str, Input<'_>)],
        _: &[&str],
    ) -> Result<Vec<DeviceTensor>, EngineError> {
        Ok(self.0.iter().cloned().map(DeviceTensor::from).collect())
    }
}
