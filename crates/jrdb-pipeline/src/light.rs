//! The light default perception: small models that come from package registries (docs/models.md).

use std::path::Path;

use jrdb_perception::{
    Detector, Engine, NanoDet, NanoDetConfig, PairConfig, PairDetector, SsdLite, SsdLiteConfig,
};

use crate::Error;
use crate::engine::{EngineOptions, open_engine};
use crate::perceive::SSDLITE_FILE;

/// The file of the NanoDet detector of people and objects in the models folder.
pub const NANODET_FILE: &str = "nanodet-g-416-coco.f16.onnx";

/// Confidence from which on the two detectors compare what they see; far below what is reported.
pub const COMPARED_MIN_SCORE: f64 = 0.05;

/// A detector, and what the user should know of it.
pub type Opened = (Box<dyn Detector + Send + Sync>, Vec<String>);

/// SSDLite and NanoDet as one detector of people and objects.
///
/// # Errors
/// When a model or its engine is unusable.
pub fn open(models: &Path, engine: &EngineOptions) -> Result<Opened, Error> {
    let (detector, note) = detector(models, engine, PairConfig::default())?;
    Ok((Box::new(detector), vec![note]))
}

/// The two detectors with another choice of what is reported.
///
/// # Errors
/// When a model or its engine is unusable.
pub fn detector(
    models: &Path,
    engine: &EngineOptions,
    config: PairConfig,
) -> Result<(PairDetector<SsdLite, NanoDet>, String), Error> {
    let (people_engine, note) = load(models, SSDLITE_FILE, engine)?;
    let (things_engine, _) = load(models, NANODET_FILE, engine)?;
    let min_score = COMPARED_MIN_SCORE;
    let people =
        SsdLite::new(people_engine, SsdLiteConfig { min_score, ..SsdLiteConfig::default() });
    let things =
        NanoDet::new(things_engine, NanoDetConfig { min_score, ..NanoDetConfig::default() });
    Ok((PairDetector::new(people, things, config), note))
}

/// Loads a model of the models folder, with one line on the engine.
pub(crate) fn load(
    models: &Path,
    file: &str,
    engine: &EngineOptions,
) -> Result<(Box<dyn Engine>, String), Error> {
    let path = models.join(file);
    let bytes = std::fs::read(&path).map_err(|source| Error::file("read", &path, source))?;
    open_engine(&bytes, &path, engine)
}
