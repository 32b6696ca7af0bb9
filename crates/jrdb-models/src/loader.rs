//! Which inference engine runs a model, and where ONNX Runtime is found.

use std::path::{Path, PathBuf};
use std::process::Command;

use jrdb_perception::{Engine, OrtEngine, OrtLibrary, RtenEngine, Sessions};

use crate::Error;
use crate::profile::Profile;

/// Which engine is wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum EngineChoice {
    /// ONNX Runtime where its library is found, else rten.
    #[default]
    Auto,
    /// Pure Rust, on the CPU.
    Rten,
    /// ONNX Runtime.
    Ort,
}

/// How to choose an engine.
#[derive(Debug, Clone, Default)]
pub struct EngineOptions {
    /// Which engine.
    pub choice: EngineChoice,
    /// ONNX Runtime's library, when the user names it.
    pub library: Option<PathBuf>,
    /// Counts what graphs take, where somebody wants to know.
    pub profile: Option<Profile>,
    /// Folder with models, which may hold `onnxruntime/libonnxruntime.so*`.
    pub models: PathBuf,
}

/// A graph in a file larger than this, bytes, is in memory once and uses all cores; smaller ones run several at once on one core each.
const LARGE: u64 = 64 << 20;

/// Opens graphs with one engine.
#[derive(Debug)]
pub struct Loader {
    library: Option<OrtLibrary>,
    note: String,
    profile: Option<Profile>,
}

impl Loader {
    /// Finds the engine that the options ask for.
    ///
    /// ONNX Runtime is looked for in this order: the path given, `ORT_DYLIB_PATH`, the models folder, the active
    /// Python environment, the system's library path. A path that the user gave must work; of the others the first
    /// that loads is taken.
    ///
    /// # Errors
    /// When a library that was asked for does not load.
    pub fn new(options: &EngineOptions) -> Result<Self, Error> {
        let found = find_library(options)?;
        if found.is_none() && options.choice == EngineChoice::Ort {
            return Err(Error::NoLibrary);
        }
        let note = found.as_ref().map_or_else(
            || "engine: rten (pure Rust, CPU)".into(),
            |(_, path)| format!("engine: ONNX Runtime on the CPU, {}", path.display()),
        );
        let library = found.map(|(library, _)| library);
        Ok(Self { library, note, profile: options.profile.clone() })
    }

    /// One line on which engine it is.
    #[must_use]
    pub fn note(&self) -> &str {
        &self.note
    }

    /// Loads a graph, and weights that it keeps in files beside it.
    ///
    /// # Errors
    /// When the file is missing or no graph that the engine knows.
    pub fn open(&self, path: &Path) -> Result<Box<dyn Engine>, Error> {
        let engine = self.load(path)?;
        Ok(match &self.profile {
            Some(profile) => profile.watch(engine, path),
            None => engine,
        })
    }

    fn load(&self, path: &Path) -> Result<Box<dyn Engine>, Error> {
        let wrap = |source| Error::Engine { what: format!("{}", path.display()), source };
        let size = std::fs::metadata(path).map_err(Error::read(path))?.len();
        let Some(library) = &self.library else {
            return Ok(Box::new(RtenEngine::from_file(path).map_err(wrap)?));
        };
        let sessions = if size > LARGE {
            Sessions::One { threads: 0 }
        } else {
            Sessions::PerCall { threads: 1 }
        };
        Ok(Box::new(OrtEngine::from_file(library, path, sessions).map_err(wrap)?))
    }
}

/// The library that the options name or that is found first.
fn find_library(options: &EngineOptions) -> Result<Option<(OrtLibrary, PathBuf)>, Error> {
    if options.choice == EngineChoice::Rten {
        return Ok(None);
    }
    let named =
        options.library.clone().or_else(|| std::env::var_os("ORT_DYLIB_PATH").map(PathBuf::from));
    if let Some(path) = named {
        let what = path.display().to_string();
        let library = OrtLibrary::load(&path).map_err(|source| Error::Engine { what, source })?;
        return Ok(Some((library, path)));
    }
    let load = |path: PathBuf| Some((OrtLibrary::load(&path).ok()?, path));
    // Each place is looked at only when the one before it has nothing: Python takes a while to start.
    let found = library_in(&options.models.join("onnxruntime")).and_then(load);
    let found = found.or_else(|| library_in(&python_package()?).and_then(load));
    Ok(found.or_else(|| load("libonnxruntime.so".into())))
}

/// The folder of ONNX Runtime's library in the active Python environment.
fn python_package() -> Option<PathBuf> {
    let script =
        "import importlib.util as u; s = u.find_spec('onnxruntime'); print(s.origin if s else '')";
    let output = Command::new("python3").args(["-I", "-c", script]).output().ok()?;
    let origin = String::from_utf8(output.stdout).ok()?;
    let package = Path::new(origin.trim()).parent()?.to_path_buf();
    Some(package.join("capi"))
}

/// The library in a folder; the last in order of name where there are several.
fn library_in(folder: &Path) -> Option<PathBuf> {
    let names = ["libonnxruntime.so", "libonnxruntime.dylib", "onnxruntime.dll"];
    let is_library = |path: &PathBuf| {
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        names.iter().any(|known| name.starts_with(known))
    };
    let entries = std::fs::read_dir(folder).ok()?;
    entries.filter_map(|entry| Some(entry.ok()?.path())).filter(is_library).max()
}
