//! Tensors of ONNX Runtime.

use std::borrow::Cow;
use std::fmt;

use ort::session::SessionInputValue;
use ort::value::{DynValue, Tensor as OrtTensor, TensorRef};

use super::device_tensor::{DeviceValue, Input};
use super::error::{Cause, EngineError};
use super::tensor::Tensor;

pub(super) const NAME: &str = "onnxruntime";

/// A tensor in the memory of ONNX Runtime.
pub(super) struct OrtValue(pub(super) DynValue);

impl fmt::Debug for OrtValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("onnxruntime")
    }
}

impl DeviceValue for OrtValue {
    fn to_tensor(&self, name: &str) -> Result<Tensor, EngineError> {
        if let Ok((shape, data)) = self.0.try_extract_tensor::<i64>() {
            return Ok(Tensor::I64 { shape: lengths(shape), data: data.to_vec() });
        }
        if let Ok((shape, data)) = self.0.try_extract_tensor::<bool>() {
            return Ok(Tensor::Bool { shape: lengths(shape), data: data.to_vec() });
        }
        let (shape, data) = self.floats(name)?;
        Ok(Tensor::F32 { shape, data: data.into_owned() })
    }

    fn floats(&self, name: &str) -> Result<(Vec<usize>, Cow<'_, [f32]>), EngineError> {
        let (shape, data) =
            self.0.try_extract_tensor::<f32>().map_err(|e| EngineError::wrong_type(name, e))?;
        Ok((lengths(shape), Cow::Borrowed(data)))
    }
}

fn lengths(shape: &[i64]) -> Vec<usize> {
    shape.iter().map(|&axis| axis.unsigned_abs() as usize).collect()
}

/// The input as ONNX Runtime takes it; copied only if it is on the device of another engine.
pub(super) fn given<'a>(
    name: &str,
    input: Input<'a>,
) -> Result<SessionInputValue<'a>, EngineError> {
    if let Some(OrtValue(value)) = input.on_device() {
        return Ok(value.into());
    }
    match input.to_tensor(name)? {
        Cow::Borrowed(tensor) => view(tensor),
        Cow::Owned(tensor) => owned(tensor),
    }
    .map_err(failed)
}

pub(super) fn failed(source: impl Into<Cause>) -> EngineError {
    EngineError::Run { engine: NAME, source: source.into() }
}

fn view(tensor: &Tensor) -> ort::Result<SessionInputValue<'_>> {
    Ok(match tensor {
        Tensor::F32 { shape, data } => {
            TensorRef::from_array_view((shape.clone(), data.as_slice()))?.into()
        }
        Tensor::I64 { shape, data } => {
            TensorRef::from_array_view((shape.clone(), data.as_slice()))?.into()
        }
        Tensor::Bool { shape, data } => {
            TensorRef::from_array_view((shape.clone(), data.as_slice()))?.into()
        }
    })
}

fn owned(tensor: Tensor) -> ort::Result<SessionInputValue<'static>> {
    Ok(match tensor {
        Tensor::F32 { shape, data } => OrtTensor::from_array((shape, data))?.into(),
        Tensor::I64 { shape, data } => OrtTensor::from_array((shape, data))?.into(),
        Tensor::Bool { shape, data } => OrtTensor::from_array((shape, data))?.into(),
    })
}
