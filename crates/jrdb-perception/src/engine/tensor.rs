//! Tensors in the memory of this process.

use super::error::EngineError;

/// A dense array, the last axis running fastest.
#[derive(Debug, Clone, PartialEq)]
pub enum Tensor {
    /// 32-bit floating point numbers.
    F32 {
        /// Length of each axis.
        shape: Vec<usize>,
        /// The numbers.
        data: Vec<f32>,
    },
    /// 64-bit integers.
    I64 {
        /// Length of each axis.
        shape: Vec<usize>,
        /// The numbers.
        data: Vec<i64>,
    },
    /// Booleans.
    Bool {
        /// Length of each axis.
        shape: Vec<usize>,
        /// The values.
        data: Vec<bool>,
    },
}

impl Tensor {
    /// Length of each axis.
    #[must_use]
    pub fn shape(&self) -> &[usize] {
        match self {
            Self::F32 { shape, .. } | Self::I64 { shape, .. } | Self::Bool { shape, .. } => shape,
        }
    }

    /// Type and shape as text, for messages: `f32 [1, 3]`.
    #[must_use]
    pub fn describe(&self) -> String {
        match self {
            Self::F32 { shape, .. } => format!("f32 {shape:?}"),
            Self::I64 { shape, .. } => format!("i64 {shape:?}"),
            Self::Bool { shape, .. } => format!("bool {shape:?}"),
        }
    }

    /// Whether the number of elements matches the shape.
    pub(super) fn check(&self, name: &str) -> Result<(), EngineError> {
        let found = match self {
            Self::F32 { data, .. } => data.len(),
            Self::I64 { data, .. } => data.len(),
            Self::Bool { data, .. } => data.len(),
        };
        let expected = self.shape().iter().try_fold(1_usize, |n, &axis| n.checked_mul(axis));
        if expected == Some(found) {
            return Ok(());
        }
        Err(EngineError::Length { name: name.into(), described: self.describe(), found })
    }
}
