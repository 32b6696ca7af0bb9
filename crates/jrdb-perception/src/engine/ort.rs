//! ONNX Runtime, loaded from a library that the user has.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use jrdb_types::contained;
use ort::environment::Environment;
use ort::session::{Session, SessionInputValue, SessionOutputs};

use super::device_tensor::{DeviceTensor, Input};
use super::error::{Cause, EngineError};
use super::interface::{Engine, check_call};
use super::ort_value::{NAME, OrtValue, failed, given};

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
    /// Loads the library from a file (`libonnxruntime.so`, `.dylib`, `onnxruntime.dll`). Loading
    /// the same path again returns the same library.
    ///
    /// # Errors
    /// [`EngineError::Library`] if the file cannot be used, [`EngineError::SecondLibrary`] if
    /// another one is in use.
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

    /// The path from which it was loaded.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }
}

/// How concurrent calls share a model. A session runs one call at a time and has its own memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sessions {
    /// One session per concurrent call, each with this many threads (0: one per core). With 1 the
    /// caller controls the parallelism. For small models.
    PerCall {
        /// Threads of each session.
        threads: usize,
    },
    /// One session; concurrent calls wait for it. For models whose weights should be in memory only
    /// once.
    One {
        /// Its threads (0: one per core).
        threads: usize,
    },
}

/// Where a model is read from whenever a session is opened.
enum Source {
    Bytes(Vec<u8>),
    File(PathBuf),
}

/// A model run by ONNX Runtime on the processor.
pub struct OrtEngine {
    library: OrtLibrary,
    source: Source,
    sessions: Sessions,
    inputs: Vec<String>,
    outputs: Vec<String>,
    /// Sessions that no run is using.
    idle: Mutex<Vec<Session>>,
    /// Wakes calls that wait for a session.
    freed: Condvar,
}

impl fmt::Debug for OrtEngine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut shown = f.debug_struct("OrtEngine");
        shown.field("inputs", &self.inputs).field("outputs", &self.outputs).finish_non_exhaustive()
    }
}

impl OrtEngine {
    /// Reads an ONNX model. Each run uses `intra_threads` threads (0: one per core); with 1 the
    /// caller controls the parallelism.
    ///
    /// # Errors
    /// [`EngineError::Model`] if the library cannot load the bytes as an ONNX model.
    pub fn from_onnx(
        library: &OrtLibrary,
        bytes: &[u8],
        intra_threads: usize,
    ) -> Result<Self, EngineError> {
        let sessions = Sessions::PerCall { threads: intra_threads };
        Self::open(library, Source::Bytes(bytes.to_vec()), sessions)
    }

    /// Reads an ONNX model from a file, and weights that it keeps in files beside it. The file must
    /// stay.
    ///
    /// # Errors
    /// [`EngineError::Model`] if the library cannot load the file as an ONNX model.
    pub fn from_file(
        library: &OrtLibrary,
        path: &Path,
        sessions: Sessions,
    ) -> Result<Self, EngineError> {
        Self::open(library, Source::File(path.into()), sessions)
    }

    fn open(library: &OrtLibrary, source: Source, sessions: Sessions) -> Result<Self, EngineError> {
        let session = open(library, &source, sessions)?;
        let names = |outlets: &[ort::value::Outlet]| -> Vec<String> {
            outlets.iter().map(|outlet| outlet.name().to_owned()).collect()
        };
        Ok(Self {
            library: library.clone(),
            source,
            sessions,
            inputs: names(session.inputs()),
            outputs: names(session.outputs()),
            idle: Mutex::new(vec![session]),
            freed: Condvar::new(),
        })
    }

    fn idle(&self) -> MutexGuard<'_, Vec<Session>> {
        self.idle.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A session that no other call uses: an idle one, else another one or the next that is freed.
    fn take(&self) -> Result<Session, EngineError> {
        let mut idle = self.idle();
        loop {
            match (idle.pop(), self.sessions) {
                (Some(session), _) => return Ok(session),
                (None, Sessions::PerCall { .. }) => {
                    drop(idle);
                    return open(&self.library, &self.source, self.sessions);
                }
                (None, Sessions::One { .. }) => {
                    idle = self.freed.wait(idle).unwrap_or_else(PoisonError::into_inner);
                }
            }
        }
    }

    /// Runs a session and passes its outputs to `read`.
    fn with_outputs<T>(
        &self,
        inputs: &[(&str, Input<'_>)],
        outputs: &[&str],
        read: impl FnOnce(SessionOutputs<'_>) -> Result<T, EngineError>,
    ) -> Result<T, EngineError> {
        check_call(self, inputs, outputs)?;
        let values = inputs
            .iter()
            .map(|(name, input)| Ok(((*name).to_owned(), given(name, *input)?)))
            .collect::<Result<Vec<(String, SessionInputValue<'_>)>, EngineError>>()?;
        let mut session = self.take()?;
        let result = contained(NAME, || session.run(values).map_err(failed).and_then(read));
        self.idle().push(session);
        self.freed.notify_one();
        result.map_err(failed)?
    }

    fn unknown(&self, name: &str) -> EngineError {
        EngineError::Name { kind: "output", name: name.into(), known: self.outputs.clone() }
    }
}

fn open(library: &OrtLibrary, source: &Source, sessions: Sessions) -> Result<Session, EngineError> {
    let refused = |source: Cause| EngineError::Model { engine: NAME, source };
    let (Sessions::PerCall { threads } | Sessions::One { threads }) = sessions;
    // The builder's errors carry the builder, which may not leave this thread: only their text goes
    // on.
    let mut builder = Session::builder(&library.environment)
        .map_err(|e| refused(e.into()))?
        .with_intra_threads(threads)
        .map_err(|e| refused(e.to_string().into()))?;
    match source {
        Source::Bytes(bytes) => builder.commit_from_memory(bytes),
        Source::File(path) => builder.commit_from_file(path),
    }
    .map_err(|e| refused(e.into()))
}

impl Engine for OrtEngine {
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
        self.with_outputs(inputs, outputs, |mut found| {
            let mut take = |name: &&str| {
                let value = found.remove(name).ok_or_else(|| self.unknown(name))?;
                Ok(DeviceTensor::new(OrtValue(value)))
            };
            outputs.iter().map(&mut take).collect()
        })
    }
}
