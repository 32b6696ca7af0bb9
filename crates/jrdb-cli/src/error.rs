//! What can go wrong around the stages.

use std::path::PathBuf;

/// Why a command could not do its work.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file of the dataset, or a file given by flag, is unusable.
    #[error(transparent)]
    Dataset(#[from] jrdb_dataset::Error),
    /// The pipeline refused its input.
    #[error(transparent)]
    Pipeline(#[from] jrdb_pipeline::Error),
    /// A model or a file of detections cannot be used.
    #[error(transparent)]
    Models(#[from] jrdb_models::Error),
    /// A model failed.
    #[error(transparent)]
    Perception(#[from] jrdb_perception::PerceptionError),
    /// People and objects are to be taken from labels, and there are none.
    #[error(
        "expected labels of {sequences} in {root:?}, found none: name another source of people and \
         objects with --perception, such as light (models, see jrdb models fetch), file:PATH \
         (detections) or replay:PATH (replies of a model)"
    )]
    NoLabels {
        /// Names of the sequences.
        sequences: String,
        /// The tree.
        root: PathBuf,
    },
    /// A file could not be read or written.
    #[error("cannot {action} {path:?}: {source}")]
    File {
        /// `read` or `write`.
        action: &'static str,
        /// Which file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file is not the artefact that was asked for.
    #[error("{path:?}: {source}")]
    Artefact {
        /// Which file.
        path: PathBuf,
        /// Why.
        source: jrdb_types::ArtefactError,
    },
    /// A flag or a combination of flags makes no sense.
    #[error("{0}")]
    Usage(String),
}

impl Error {
    /// The process exit code: 1 when the work failed, 2 for bad input or usage.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::File { action: "write", .. }
            | Self::Dataset(jrdb_dataset::Error::Write { .. })
            | Self::Models(jrdb_models::Error::Fetch { .. } | jrdb_models::Error::Write { .. }) => {
                1
            }
            _ => 2,
        }
    }

    pub(crate) fn file(
        action: &'static str,
        path: &std::path::Path,
        source: std::io::Error,
    ) -> Self {
        Self::File { action, path: path.into(), source }
    }
}
