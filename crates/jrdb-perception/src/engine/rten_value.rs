//! Tensors of rten.

use std::borrow::Cow;
use std::fmt;

use rten::{Value, ValueOrView, ValueView};
use rten_tensor::prelude::*;

use super::device_tensor::{DeviceValue, Input};
use super::error::{Cause, EngineError};
use super::tensor::Tensor;

pub(super) const NAME: &str = "rten";

/// A tensor in the memory of rten.
pub(super) struct RtenValue(pub(super) Value);

impl fmt::Debug for RtenValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("rten")
    }
}

impl DeviceValue for RtenValue {
    fn to_tensor(&self, name: &str) -> Result<Tensor, EngineError> {
        tensor(name, self.0.clone())
    }

    fn floats(&self, name: &str) -> Result<(Vec<usize>, Cow<'_, [f32]>), EngineError> {
        let Value::FloatTensor(tensor) = &self.0 else {
            return Err(EngineError::wrong_type(name, "expected f32, found another type"));
        };
        Ok((tensor.shape().to_vec(), tensor.to_slice()))
    }

    fn into_tensor(self: Box<Self>, name: &str) -> Result<Tensor, EngineError> {
        tensor(name, self.0)
    }
}

fn tensor(name: &str, value: Value) -> Result<Tensor, EngineError> {
    match value {
        Value::FloatTensor(tensor) => {
            Ok(Tensor::F32 { shape: tensor.shape().to_vec(), data: tensor.into_data() })
        }
        Value::Int32Tensor(tensor) => {
            let shape = tensor.shape().to_vec();
            Ok(Tensor::I64 { shape, data: tensor.into_data().into_iter().map(i64::from).collect() })
        }
        other => Err(EngineError::wrong_type(name, format!("found {:?}", other.dtype()))),
    }
}

/// The input as rten takes it. Floats are copied only if they are on the device of another engine;
/// integers and booleans become 32-bit integers.
pub(super) fn given<'a>(name: &str, input: Input<'a>) -> Result<ValueOrView<'a>, EngineError> {
    if let Some(RtenValue(value)) = input.on_device() {
        return Ok(value.into());
    }
    match input.to_tensor(name)? {
        Cow::Borrowed(Tensor::F32 { shape, data }) => {
            ValueView::from_shape(shape, data).map(Into::into).map_err(failed)
        }
        tensor => converted(name, &tensor).map(Into::into),
    }
}

fn converted(name: &str, tensor: &Tensor) -> Result<Value, EngineError> {
    match tensor {
        Tensor::F32 { shape, data } => Value::from_shape(shape, data.clone()).map_err(failed),
        Tensor::I64 { shape, data } => {
            Value::from_shape(shape, narrowed(name, data)?).map_err(failed)
        }
        Tensor::Bool { shape, data } => {
            let data: Vec<i32> = data.iter().map(|&truth| i32::from(truth)).collect();
            Value::from_shape(shape, data).map_err(failed)
        }
    }
}

fn narrowed(name: &str, data: &[i64]) -> Result<Vec<i32>, EngineError> {
    let narrow = |&found: &i64| {
        i32::try_from(found).map_err(|_| EngineError::Integer { name: name.into(), found })
    };
    data.iter().map(narrow).collect()
}

pub(super) fn failed(source: impl Into<Cause>) -> EngineError {
    EngineError::Run { engine: NAME, source: source.into() }
}
