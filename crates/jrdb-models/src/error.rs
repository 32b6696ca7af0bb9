//! What can go wrong with models and the files around them.

use std::path::{Path, PathBuf};

/// Why a source of perception could not be opened, or a model not obtained.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file of detections cannot be used.
    #[error(transparent)]
    Dataset(#[from] jrdb_dataset::Error),
    /// A model failed.
    #[error(transparent)]
    Perception(#[from] jrdb_perception::PerceptionError),
    /// An inference engine or its model failed.
    #[error("{what}: {source}")]
    Engine {
        /// Which file.
        what: String,
        /// Why.
        source: jrdb_perception::EngineError,
    },
    /// A model's folder holds another model than its name says, or a broken one.
    #[error("{path:?}: {source}")]
    Model {
        /// The folder.
        path: PathBuf,
        /// Why.
        source: Box<jrdb_perception::PerceptionError>,
    },
    /// ONNX Runtime was asked for and is not there.
    #[error(
        "expected an ONNX Runtime library, found none in ORT_DYLIB_PATH, the models folder, Python and the system"
    )]
    NoLibrary,
    /// The library in the models folder is not the one that the catalogue lists; its code would run.
    #[error(
        "expected the catalogue's ONNX Runtime library, found other bytes in {path:?}: obtain it with \
         jrdb models fetch onnxruntime, or name this one with --onnxruntime PATH"
    )]
    Unlisted {
        /// The file.
        path: PathBuf,
    },
    /// A text does not name a source of detections.
    #[error(
        "expected labels, file:PATH, replay:PATH or the name of a backbone ({}), found {found:?}",
        known.join(", ")
    )]
    UnknownSource {
        /// The text.
        found: String,
        /// Names of the built-in backbones.
        known: Vec<&'static str>,
    },
    /// A name is neither that of a built-in backbone nor of a file in the models folder.
    #[error("expected a backbone {path:?} or one of {}, found none called {name:?}: {source}", known.join(", "))]
    UnknownBackbone {
        /// The name.
        name: String,
        /// The file that it would be in.
        path: PathBuf,
        /// Names of the built-in backbones.
        known: Vec<&'static str>,
        /// Why the file cannot be read.
        source: std::io::Error,
    },
    /// A file does not describe a backbone.
    #[error("expected a backbone in {path:?}: {source}")]
    Backbone {
        /// Which file.
        path: PathBuf,
        /// What is wrong with it.
        source: serde_json::Error,
    },
    /// No model of the catalogue has this name.
    #[error("expected one of {known:?}, found {name:?}")]
    UnknownModel {
        /// The name.
        name: String,
        /// Names of the catalogue.
        known: Vec<String>,
    },
    /// The built-in catalogue of models does not hold together, which a test rules out.
    #[error("the built-in catalogue of models is malformed: {0}")]
    Catalogue(String),
    /// A package or a model could not be obtained or converted.
    #[error("{message}")]
    Fetch {
        /// What happened, and what is missing.
        message: String,
        /// The package file that can be obtained by other means and given instead.
        package_file: Option<String>,
    },
    /// A folder holds no model.
    #[error("expected ONNX files in {path:?}, found none")]
    NoModels {
        /// The folder.
        path: PathBuf,
    },
    /// A file could not be read.
    #[error("cannot read {path:?}: {source}")]
    Read {
        /// Which file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file could not be written.
    #[error("cannot write {path:?}: {source}")]
    Write {
        /// Which file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
}

impl Error {
    /// A maker of [`Error::Read`] for `map_err`.
    pub(crate) fn read(path: &Path) -> impl FnOnce(std::io::Error) -> Self + '_ {
        |source| Self::Read { path: path.into(), source }
    }

    /// A maker of [`Error::Write`] for `map_err`.
    pub(crate) fn write(path: &Path) -> impl FnOnce(std::io::Error) -> Self + '_ {
        |source| Self::Write { path: path.into(), source }
    }

    /// A package or a model could not be obtained, and nothing but the message helps.
    pub(crate) fn fetch(message: String) -> Self {
        Self::Fetch { message, package_file: None }
    }
}
