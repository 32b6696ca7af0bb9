//! Which inference engine runs a model, and where ONNX Runtime is found.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Mutex, PoisonError};

use jrdb_perception::{Engine, OrtEngine, OrtLibrary, RtenEngine, Sessions};

use crate::Error;
use crate::catalogue::{Manifest, Model, State};
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
    /// Folder with models.
    pub models: PathBuf,
    /// Whether that folder may hold the library to load, as `onnxruntime/libonnxruntime.so*`.
    pub library_in_models: LibraryInModels,
}

/// Whether ONNX Runtime's library is looked for in the models folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LibraryInModels {
    /// It is not: the folder is where the process happens to be, and may be anybody's.
    #[default]
    Ignored,
    /// It is: the user named the folder. The library must be the catalogue's.
    Trusted,
}

/// A graph in a file larger than this, bytes, is in memory once and uses all cores; smaller ones run several at once on one core each.
const LARGE: u64 = 64 << 20;

/// Opens graphs with one engine.
#[derive(Debug)]
pub struct Loader {
    library: Option<OrtLibrary>,
    note: String,
    profile: Option<Profile>,
    models: PathBuf,
    warnings: Mutex<Vec<String>>,
}

impl Loader {
    /// Finds the engine that the options ask for.
    ///
    /// ONNX Runtime is looked for in this order: the path given, `ORT_DYLIB_PATH`, the models folder if the user named
    /// it, the active Python environment, the system's library path. A path that the user gave must work; of the others the first
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
        let (profile, models) = (options.profile.clone(), options.models.clone());
        Ok(Self { library, note, profile, models, warnings: Mutex::default() })
    }

    /// What is to be said of the files that were opened: those with other bytes than the catalogue lists.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        self.warnings.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Compares a file of the catalogue with its digest.
    fn check_digest(&self, path: &Path) -> Result<(), Error> {
        let manifest = Manifest::built_in()?;
        let is_here = |model: &&Model| self.models.join(&model.file) == path;
        let Some(model) = manifest.models.iter().find(is_here) else { return Ok(()) };
        if model.state(&self.models)? == State::Other {
            let (file, name) = (path.display(), &model.name);
            let warning = format!(
                "warning: {file} has other bytes than the catalogue lists for {name}: another \
                 conversion, or another model; jrdb models fetch {name} in an empty folder obtains it"
            );
            self.warnings.lock().unwrap_or_else(PoisonError::into_inner).push(warning);
        }
        Ok(())
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
        self.check_digest(path)?;
        Ok(match &self.profile {
            Some(profile) => profile.watch(engine, path),
            None => engine,
        })
    }

    fn load(&self, path: &Path) -> Result<Box<dyn Engine>, Error> {
        let wrap = |source| Error::Engine { what: format!("{}", path.display()), source };
        let file = std::fs::File::open(path).map_err(Error::read(path))?;
        let size = file.metadata().map_err(Error::read(path))?.len();
        jrdb_perception::check_onnx(file, size).map_err(wrap)?;
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
    let found = match options.library_in_models {
        LibraryInModels::Trusted => listed_library(&options.models)?.and_then(load),
        LibraryInModels::Ignored => None,
    };
    let found = found.or_else(|| library_in(&python_package()?).and_then(load));
    Ok(found.or_else(|| load("libonnxruntime.so".into())))
}

/// The library in the models folder. Its code would run, so it must be the one that the catalogue lists.
fn listed_library(models: &Path) -> Result<Option<PathBuf>, Error> {
    let Some(path) = library_in(&models.join("onnxruntime")) else { return Ok(None) };
    let manifest = Manifest::built_in()?;
    let is_listed = |model: &Model| {
        models.join(&model.file) == path
            && model.state(models).is_ok_and(|state| state == State::AsListed)
    };
    if manifest.models.iter().any(is_listed) {
        Ok(Some(path))
    } else {
        Err(Error::Unlisted { path })
    }
}

/// The folder of ONNX Runtime's library in the active Python environment. Python runs isolated and in an empty folder,
/// so that nothing of the current folder is executed.
fn python_package() -> Option<PathBuf> {
    let script =
        "import importlib.util as u; s = u.find_spec('onnxruntime'); print(s.origin if s else '')";
    let empty = tempfile::tempdir().ok()?;
    let mut python = Command::new("python3");
    let output = python.args(["-I", "-c", script]).current_dir(empty.path()).output().ok()?;
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

#[cfg(test)]
mod tests {
    use super::*;

    fn options(models: &Path, library_in_models: LibraryInModels) -> EngineOptions {
        EngineOptions { models: models.into(), library_in_models, ..EngineOptions::default() }
    }

    #[test]
    fn a_library_of_the_models_folder_is_the_catalogues_or_refused() {
        let folder = tempfile::tempdir().unwrap();
        assert!(listed_library(folder.path()).unwrap().is_none());
        let library = folder.path().join("onnxruntime/libonnxruntime.so.1");
        std::fs::create_dir(library.parent().unwrap()).unwrap();
        std::fs::write(&library, b"not the library").unwrap();
        let error = listed_library(folder.path()).unwrap_err().to_string();
        assert!(
            error.contains("libonnxruntime.so.1") && error.contains("--onnxruntime"),
            "{error}"
        );
        let trusted = options(folder.path(), LibraryInModels::Trusted);
        assert!(std::env::var_os("ORT_DYLIB_PATH").is_some() || find_library(&trusted).is_err());
    }

    #[test]
    fn a_model_with_other_bytes_is_warned_of() {
        let folder = tempfile::tempdir().unwrap();
        let rten = EngineOptions {
            choice: EngineChoice::Rten,
            ..options(folder.path(), LibraryInModels::Ignored)
        };
        let loader = Loader::new(&rten).unwrap();
        let model = Manifest::built_in().unwrap().models[0].clone();
        let path = folder.path().join(&model.file);
        std::fs::write(&path, b"mine").unwrap();
        loader.check_digest(&path).unwrap();
        loader.check_digest(&folder.path().join("own.onnx")).unwrap();
        let warnings = loader.warnings();
        assert!(warnings.len() == 1 && warnings[0].contains(&model.name), "{warnings:?}");
    }
}
