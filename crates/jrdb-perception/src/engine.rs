//! Named tensors in, named tensors out: what every model is run through.

mod held;
mod ort;
mod rten;

use std::error::Error;
use std::path::PathBuf;

pub use self::held::{Held, Input};
pub use self::ort::{OrtEngine, OrtLibrary, Sessions};
pub use self::rten::RtenEngine;

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
    /// Truth values.
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

    /// Type and shape in words, for messages: `f32 [1, 3]`.
    #[must_use]
    pub fn describe(&self) -> String {
        match self {
            Self::F32 { shape, .. } => format!("f32 {shape:?}"),
            Self::I64 { shape, .. } => format!("i64 {shape:?}"),
            Self::Bool { shape, .. } => format!("bool {shape:?}"),
        }
    }

    /// Whether there are as many numbers as the shape says.
    fn check(&self, name: &str) -> Result<(), EngineError> {
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

/// Runs one model. May be called from several threads at once.
pub trait Engine: Send + Sync + std::fmt::Debug {
    /// Name of the engine, for reports: `rten`, `onnxruntime`.
    fn name(&self) -> &str;

    /// Names of the model's inputs.
    fn inputs(&self) -> &[String];

    /// Names of the model's outputs.
    fn outputs(&self) -> &[String];

    /// Runs the model and gives back the outputs named, in that order.
    ///
    /// # Errors
    /// When a name, type or shape does not fit the model, or an operator fails.
    fn run(&self, inputs: &[(&str, &Tensor)], outputs: &[&str])
    -> Result<Vec<Tensor>, EngineError>;

    /// The same, leaving the outputs where the engine has them: what is only given to it again, a cache, need not be copied.
    ///
    /// # Errors
    /// As [`Engine::run`].
    fn run_held(
        &self,
        inputs: &[(&str, Input<'_>)],
        outputs: &[&str],
    ) -> Result<Vec<Held>, EngineError> {
        let owned = inputs
            .iter()
            .map(|(name, input)| Ok((*name, input.to_tensor(name)?)))
            .collect::<Result<Vec<_>, EngineError>>()?;
        let inputs: Vec<(&str, &Tensor)> =
            owned.iter().map(|(name, tensor)| (*name, tensor.as_ref())).collect();
        Ok(self.run(&inputs, outputs)?.into_iter().map(Held::from).collect())
    }
}

/// The cause of an error inside an engine.
pub type Cause = Box<dyn Error + Send + Sync>;

/// Why a model could not be loaded or run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EngineError {
    /// The file is no ONNX Runtime library, is too old, or depends on one that is missing.
    #[error("expected an ONNX Runtime library of version 1.17 or later at {path:?}")]
    Library {
        /// The file.
        path: PathBuf,
        /// What the loader says.
        #[source]
        source: Cause,
    },
    /// A process can use one ONNX Runtime library only.
    #[error("ONNX Runtime is already loaded from {loaded:?}, cannot load it from {asked:?}")]
    SecondLibrary {
        /// In use.
        loaded: PathBuf,
        /// Asked for.
        asked: PathBuf,
    },
    /// The bytes are no ONNX model, or use an operator that the engine does not know.
    #[error("{engine} cannot load the model")]
    Model {
        /// Name of the engine.
        engine: &'static str,
        /// What the engine says.
        #[source]
        source: Cause,
    },
    /// The model has no tensor of that name.
    #[error("the model has no {kind} {name:?}; it has {known:?}")]
    Name {
        /// `input` or `output`.
        kind: &'static str,
        /// Name asked for.
        name: String,
        /// Names in the model.
        known: Vec<String>,
    },
    /// An input of the model was not given.
    #[error("expected the inputs {known:?}, found no {name:?}")]
    MissingInput {
        /// The input.
        name: String,
        /// All inputs of the model.
        known: Vec<String>,
    },
    /// A tensor's shape and its data do not fit.
    #[error("tensor {name:?} is {described} but holds {found} numbers")]
    Length {
        /// Name of the tensor.
        name: String,
        /// Its type and shape.
        described: String,
        /// Length of its data.
        found: usize,
    },
    /// An integer is too large for the engine, which computes in 32 bits.
    #[error("expected integers of 32 bits in {name:?}, found {found}")]
    Integer {
        /// Name of the tensor.
        name: String,
        /// The integer.
        found: i64,
    },
    /// The model did not run: a shape or type does not fit, or an operator failed.
    #[error("{engine} failed to run the model")]
    Run {
        /// Name of the engine.
        engine: &'static str,
        /// What the engine says.
        #[source]
        source: Cause,
    },
    /// An output is neither of 32-bit floats nor of integers, or has more axes than the engine gives out.
    #[error("expected output {name:?} to hold 32-bit floats or integers on at most 6 axes")]
    Type {
        /// Name of the tensor.
        name: String,
        /// What it holds.
        #[source]
        source: Cause,
    },
}

/// Whether the model knows the name.
fn check_name(kind: &'static str, name: &str, known: &[String]) -> Result<(), EngineError> {
    if known.iter().any(|k| k == name) {
        return Ok(());
    }
    Err(EngineError::Name { kind, name: name.into(), known: known.to_vec() })
}

/// Whether every tensor is well formed and known to the model, and no input is missing.
fn check_call(
    inputs: &[(&str, Input<'_>)],
    outputs: &[&str],
    known_inputs: &[String],
    known_outputs: &[String],
) -> Result<(), EngineError> {
    for (name, input) in inputs {
        check_name("input", name, known_inputs)?;
        if let Input::Tensor(tensor) = input {
            tensor.check(name)?;
        }
    }
    for known in known_inputs {
        if inputs.iter().all(|(name, _)| name != known) {
            let (name, known) = (known.clone(), known_inputs.to_vec());
            return Err(EngineError::MissingInput { name, known });
        }
    }
    outputs.iter().try_for_each(|name| check_name("output", name, known_outputs))
}
