//! Why a file of the outside world could not be used.

use std::path::{Path, PathBuf};

use jrdb_types::ArtefactError;

use crate::cloud::CloudError;
use crate::image_error::ImageError;

/// Why a file could not be read, written or understood; names the file where there is one.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The operating system could not read the file or folder.
    #[error("cannot read {path:?}")]
    Read {
        /// What was to be read.
        path: PathBuf,
        /// Why.
        #[source]
        source: std::io::Error,
    },
    /// The operating system could not write the file or folder.
    #[error("cannot write {path:?}")]
    Write {
        /// What was to be written.
        path: PathBuf,
        /// Why.
        #[source]
        source: std::io::Error,
    },
    /// Something that should be in the folder is not.
    #[error("expected {expected}, found nothing of the kind in {path:?}")]
    Absent {
        /// The files or folders of which at least one is needed.
        expected: String,
        /// Where they should be.
        path: PathBuf,
    },
    /// A name cannot be that of a folder and a file.
    #[error(
        "expected a sequence name without slashes, backslashes and control characters that is not \
         empty, \".\" or \"..\" and at most 200 bytes long, found {found:?}"
    )]
    Name {
        /// The name.
        found: String,
    },
    /// The file is not a picture that can be used.
    #[error("unusable image {path:?}")]
    Image {
        /// The file.
        path: PathBuf,
        /// Why.
        #[source]
        source: ImageError,
    },
    /// The file is not a point cloud that can be used.
    #[error("unusable point cloud {path:?}")]
    Cloud {
        /// The file.
        path: PathBuf,
        /// Why.
        #[source]
        source: CloudError,
    },
    /// The file is not JSON, or its outermost structure is not the expected one.
    #[error("expected {expected} in {path:?}")]
    Json {
        /// What the file should be.
        expected: &'static str,
        /// The file.
        path: PathBuf,
        /// Where and why it is not.
        #[source]
        source: serde_json::Error,
    },
    /// The file is not YAML of the expected structure.
    #[error("expected {expected} in {path:?}")]
    Yaml {
        /// What the file should be.
        expected: &'static str,
        /// The file.
        path: PathBuf,
        /// Where and why it is not.
        #[source]
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// The file is an artefact, but not one that this program reads.
    #[error("unusable artefact in {path:?}")]
    Artefact {
        /// The file.
        path: PathBuf,
        /// Why.
        #[source]
        source: ArtefactError,
    },
    /// The file is well-formed, but says something that it must not say.
    #[error("expected {expected}, found {found}, in {path:?}")]
    Content {
        /// What should be there.
        expected: String,
        /// What is there.
        found: String,
        /// The file.
        path: PathBuf,
    },
}

impl Error {
    pub(crate) fn content(
        path: &Path,
        expected: impl Into<String>,
        found: impl Into<String>,
    ) -> Self {
        Self::Content { expected: expected.into(), found: found.into(), path: path.into() }
    }
}
