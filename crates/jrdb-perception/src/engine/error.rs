//! Errors of engines.

use std::error::Error;
use std::path::PathBuf;

/// The cause of an error inside an engine.
pub type Cause = Box<dyn Error + Send + Sync>;

/// Why a model could not be loaded or run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EngineError {
    /// The file is not an ONNX Runtime library, is too old, or needs a library that is missing.
    #[error("expected an ONNX Runtime library of version 1.17 or later at {path:?}")]
    Library {
        /// The file.
        path: PathBuf,
        /// The error of the loader.
        #[source]
        source: Cause,
    },
    /// A process can use one ONNX Runtime library only.
    #[error("ONNX Runtime is already loaded from {loaded:?}, cannot load it from {asked:?}")]
    SecondLibrary {
        /// The library in use.
        loaded: PathBuf,
        /// The library that was requested.
        asked: PathBuf,
    },
    /// The bytes are not an ONNX model, or use an operator that the engine does not support.
    #[error("{engine} cannot load the model")]
    Model {
        /// Name of the engine.
        engine: &'static str,
        /// The error of the engine.
        #[source]
        source: Cause,
    },
    /// The file is no ONNX model, or not a complete one.
    #[error("{found}")]
    Broken {
        /// Where it stops being one.
        found: String,
    },
    /// The file asks for more memory than a model needs.
    #[error("{found}")]
    TooLarge {
        /// What is too large, and how large it may be.
        found: String,
    },
    /// The model has no tensor with this name.
    #[error("the model has no {kind} {name:?}; it has {known:?}")]
    Name {
        /// `input` or `output`.
        kind: &'static str,
        /// The requested name.
        name: String,
        /// Names in the model.
        known: Vec<String>,
    },
    /// An input of the model is missing.
    #[error("expected the inputs {known:?}, found no {name:?}")]
    MissingInput {
        /// The input.
        name: String,
        /// All inputs of the model.
        known: Vec<String>,
    },
    /// The number of elements of a tensor does not match its shape.
    #[error("tensor {name:?} is {described} but holds {found} numbers")]
    Length {
        /// Name of the tensor.
        name: String,
        /// Its type and shape.
        described: String,
        /// Number of elements.
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
    /// The run failed: a shape or type does not match the model, or an operator failed.
    #[error("{engine} failed to run the model")]
    Run {
        /// Name of the engine.
        engine: &'static str,
        /// The error of the engine.
        #[source]
        source: Cause,
    },
    /// An output holds NaN or infinity, as half-precision weights that overflow compute it.
    #[error("expected numbers in output {name:?}, found NaN or infinity in {found} of {of}")]
    NotANumber {
        /// Name of the tensor.
        name: String,
        /// How many of its elements are no numbers.
        found: usize,
        /// How many elements it has.
        of: usize,
    },
    /// A tensor holds neither 32-bit floats nor integers, or has more axes than the engine returns.
    #[error("expected output {name:?} to hold 32-bit floats or integers on at most 6 axes")]
    Type {
        /// Name of the tensor.
        name: String,
        /// What it holds instead.
        #[source]
        source: Cause,
    },
}

impl EngineError {
    /// A tensor of a type that cannot be used, with the reason.
    pub fn wrong_type(name: &str, source: impl Into<Cause>) -> Self {
        Self::Type { name: name.into(), source: source.into() }
    }
}
