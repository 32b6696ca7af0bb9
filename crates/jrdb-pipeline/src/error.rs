//! What can go wrong around the stages.

use std::path::PathBuf;

/// Why a run could not be done.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file of the dataset, or a file given by flag, is unusable.
    #[error(transparent)]
    Dataset(#[from] jrdb_dataset::Error),
    /// A stage refused its input.
    #[error("{frame}: {source}")]
    Projection {
        /// Which frame.
        frame: String,
        /// Why.
        source: jrdb_projection::Error,
    },
    /// The rig is unusable.
    #[error("the rig is unusable: {}", with_causes(.0))]
    Rig(jrdb_projection::RigError),
    /// The labels of a frame's sequence cannot be read.
    #[error("{0}")]
    Labels(String),
    /// A model failed.
    #[error(transparent)]
    Perception(#[from] jrdb_perception::PerceptionError),
    /// A model or a file of detections cannot be used.
    #[error(transparent)]
    Models(#[from] jrdb_models::Error),
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
    /// A question of which nothing is understood, or notation that does not fit together.
    #[error("{0}")]
    Query(String),
    /// A flag or a combination of flags makes no sense.
    #[error("{0}")]
    Usage(String),
}

/// An error and its causes on one line; a cause that the error has already told is left out.
#[must_use]
pub fn with_causes(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(inner) = cause {
        let inner_text = inner.to_string();
        if !text.contains(&inner_text) {
            text = format!("{text}: {inner_text}");
        }
        cause = inner.source();
    }
    text
}

impl Error {
    /// The process exit code: 1 when the work failed, 2 for bad input or usage.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::File { action: "write", .. }
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
