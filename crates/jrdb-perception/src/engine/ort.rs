//! ONNX Runtime, loaded from a library that the user has.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use ort::environment::Environment;
use ort::session::{Session, SessionInputValue, SessionOutputs};
use ort::value::TensorRef;

use super::{Cause, Engine, EngineError, Tensor, check_call};

const NAME: &str = "onnxruntime";

/// An ONNX Runtime library in use by this process. Copies refer to the same library.
#[derive(Clone)]
pub struct OrtLibrary {
    environment: Environment,
    path: PathBuf,
}

/// The one library of this process: ONNX Runtime can be started once, so it is never let go.
static LOADED: Mutex<Option<OrtLibrary>> = Mutex::new(None);

impl fmt::Debug for OrtLibrary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("OrtLibrary").field("path", &self.path).finish_non_exhaustive()
    }
}

impl OrtLibrary {
    /// Loads the library from a file (`libonnxruntime.so`, `.dylib`, `onnxruntime.dll`). Loading the same
    /// path again gives the same library.
    ///
    /// # Errors
    /// [`EngineError::Library`] if the file cannot be used, [`EngineError::SecondLibrary`] if another one
    /// is in use.
    pub fn load(path: &Path) -> Result<Self, EngineError> {
        let mut loaded = LOADED.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(library) = loaded.as_ref() {
            if library.path == path {
                return Ok(library.clone());
            }
            let (loaded, asked) = (library.path.clone(), path.to_owned());
            return Err(EngineError::SecondLibrary { loaded, asked });
        }
        let refused = |source: Cause| EngineError::Library { path: path.to_owned(), source };
        let builder = ort::init_from(path).map_err(|e| refused(e.into()))?;
        let environment = builder.build().map_err(|e| refused(e.into()))?;
        let library = Self { environment, path: path.to_owned() };
        *loaded = Some(library.clone());
        Ok(library)
    }

    /// The file, as it was given.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }
}

/// A model run by ONNX Runtime on the processor.
pub struct OrtEngine {
    library: OrtLibrary,
    model: Vec<u8>,
    intra_threads: usize,
    inputs: Vec<String>,
    outputs: Vec<String>,
    /// Sessions that no run is using. A session runs one call at a time; a further one is opened whenever
    /// more calls come at once than there are sessions.
    idle: Mutex<Vec<Session>>,
}

impl fmt::Debug for OrtEngine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut shown = f.debug_struct("OrtEngine");
        shown.field("inputs", &self.inputs).field("outputs", &self.outputs).finish_non_exhaustive()
    }
}

impl OrtEngine {
    /// Reads an ONNX model. Each run uses `intra_threads` threads (0: as many as there are cores); with 1 the
    /// caller decides how much runs at once.
    ///
    /// # Errors
    /// [`EngineError::Model`] if the bytes are no ONNX model that the library knows.
    pub fn from_onnx(
        library: &OrtLibrary,
        bytes: &[u8],
        intra_threads: usize,
    ) -> Result<Self, EngineError> {
        let session = open(library, bytes, intra_threads)?;
        let names = |outlets: &[ort::value::Outlet]| -> Vec<String> {
            outlets.iter().map(|outlet| outlet.name().to_owned()).collect()
        };
        Ok(Self {
            library: library.clone(),
            model: bytes.to_vec(),
            intra_threads,
            inputs: names(session.inputs()),
            outputs: names(session.outputs()),
            idle: Mutex::new(vec![session]),
        })
    }

    fn idle(&self) -> MutexGuard<'_, Vec<Session>> {
        self.idle.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn open(library: &OrtLibrary, model: &[u8], threads: usize) -> Result<Session, EngineError> {
    let refused = |source: Cause| EngineError::Model { engine: NAME, source };
    // The builder's errors carry the builder, which may not leave this thread: only their text goes on.
    Session::builder(&library.environment)
        .map_err(|e| refused(e.into()))?
        .with_intra_threads(threads)
        .map_err(|e| refused(e.to_string().into()))?
        .commit_from_memory(model)
        .map_err(|e| refused(e.into()))
}

fn failed(source: impl Into<Cause>) -> EngineError {
    EngineError::Run { engine: NAME, source: source.into() }
}

impl Engine for OrtEngine {
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
            .map(|(name, tensor)| Ok(((*name).to_owned(), value(tensor).map_err(failed)?)))
            .collect::<Result<Vec<(String, SessionInputValue<'_>)>, EngineError>>()?;
        let free = self.idle().pop();
        let mut session = match free {
            Some(session) => session,
            None => open(&self.library, &self.model, self.intra_threads)?,
        };
        let result = session.run(values).map_err(failed).and_then(|found| {
            outputs.iter().map(|name| tensor(&found, name, &self.outputs)).collect()
        });
        self.idle().push(session);
        result
    }
}

fn value(tensor: &Tensor) -> ort::Result<SessionInputValue<'_>> {
    Ok(match tensor {
        Tensor::F32 { shape, data } => {
            TensorRef::from_array_view((shape.clone(), data.as_slice()))?.into()
        }
        Tensor::I64 { shape, data } => {
            TensorRef::from_array_view((shape.clone(), data.as_slice()))?.into()
        }
    })
}

fn tensor(found: &SessionOutputs<'_>, name: &str, known: &[String]) -> Result<Tensor, EngineError> {
    let Some(value) = found.get(name) else {
        return Err(EngineError::Name { kind: "output", name: name.into(), known: known.to_vec() });
    };
    let lengths = |shape: &[i64]| shape.iter().map(|&axis| axis.unsigned_abs() as usize).collect();
    if let Ok((shape, data)) = value.try_extract_tensor::<i64>() {
        return Ok(Tensor::I64 { shape: lengths(shape), data: data.to_vec() });
    }
    let (shape, data) = value
        .try_extract_tensor::<f32>()
        .map_err(|e| EngineError::Type { name: name.into(), source: e.into() })?;
    Ok(Tensor::F32 { shape: lengths(shape), data: data.to_vec() })
}
