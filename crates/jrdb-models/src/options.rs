//! What a source of detections may need to be opened.

use std::path::PathBuf;
use std::sync::Arc;

use jrdb_dataset::Dataset;
use jrdb_types::ImageGeometry;

use crate::demographics::Demographics;
use crate::loader::{EngineOptions, LibraryInModels};

/// A sequence that labels or detections are read for.
#[derive(Debug, Clone)]
pub struct SequenceSource {
    /// The tree that it is in.
    pub dataset: Arc<Dataset>,
    /// Its name.
    pub name: String,
    /// Size of its images.
    pub image: ImageGeometry,
}

/// What a source may need to be opened.
#[derive(Debug, Clone, Default)]
pub struct PerceptionOptions {
    /// Which engine runs models, and in which folder the models are.
    pub engine: EngineOptions,
    /// What small models may guess from faces.
    pub demographics: Demographics,
    /// The sequences whose labels or detections are read; models need none.
    pub sequences: Vec<SequenceSource>,
}

impl PerceptionOptions {
    /// Models of a folder, on whichever engine is found.
    #[must_use]
    pub fn models(folder: impl Into<PathBuf>) -> Self {
        let library_in_models = LibraryInModels::Trusted;
        let models = folder.into();
        let engine = EngineOptions { models, library_in_models, ..EngineOptions::default() };
        Self { engine, ..Self::default() }
    }
}
