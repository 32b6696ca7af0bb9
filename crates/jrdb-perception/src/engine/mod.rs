//! Named tensors in, named tensors out: the interface through which every model runs.
//!
//! [`Engine`] is the seam. Tensors that an engine returns stay on its device as [`DeviceTensor`]s
//! until they are read, so that a decoder passes its caches back without a copy. An engine outside
//! this crate implements [`Engine`], and [`DeviceValue`] for its own tensors.

mod device_tensor;
mod error;
mod interface;
mod onnx_limits;
mod onnx_parameters;
mod onnx_structure;
mod onnx_wire;
#[cfg(feature = "ort")]
mod ort;
#[cfg(feature = "ort")]
mod ort_value;
#[cfg(feature = "rten")]
mod rten;
#[cfg(feature = "rten")]
mod rten_value;
mod tensor;

pub use self::device_tensor::{DeviceTensor, DeviceValue, Input};
pub use self::error::{Cause, EngineError};
pub use self::interface::{Engine, check_call};
pub use self::onnx_limits::check_onnx;
pub use self::onnx_parameters::{Parameters, Weight, count_parameters};
#[cfg(feature = "ort")]
pub use self::ort::{OrtEngine, OrtLibrary, Sessions};
#[cfg(feature = "rten")]
pub use self::rten::RtenEngine;
pub use self::tensor::Tensor;
