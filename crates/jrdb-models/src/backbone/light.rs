//! Small models from package registries: one file each, and attributes from faces and colours.

use std::path::Path;
use std::sync::Arc;

use jrdb_perception::{
    Appearance, AppearanceConfig, FaceFinder, FaceModels, FaceReader, NanoDet, NanoDetConfig,
    PairConfig, PairDetector, SsdLite, SsdLiteConfig,
};
use serde::Deserialize;

use crate::Error;
use crate::demographics::Demographics;
use crate::loader::Loader;

/// A model that is a single file of the models folder.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, bound = "C: Deserialize<'de> + Default")]
pub struct SingleFile<C> {
    /// The file, from the models folder.
    pub file: String,
    /// Settings of the code around it.
    #[serde(default)]
    pub settings: C,
}

/// Two detectors as one: the first finds people, the second objects, and people again.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PairFiles {
    /// SSDLite.
    pub people: SingleFile<SsdLiteConfig>,
    /// NanoDet.
    pub objects: SingleFile<NanoDetConfig>,
    /// How their findings become one.
    #[serde(default)]
    pub settings: PairConfig,
}

/// Models that look at people's faces; colours and posture need none.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AppearanceFiles {
    /// Finds faces.
    pub faces: String,
    /// Guesses gender.
    pub gender: String,
    /// Guesses age.
    pub age: String,
    /// How people are described.
    #[serde(default)]
    pub settings: AppearanceConfig,
}

pub(super) fn ssdlite(
    files: &SingleFile<SsdLiteConfig>,
    models: &Path,
    loader: &Loader,
) -> Result<SsdLite, Error> {
    Ok(SsdLite::new(loader.open(&models.join(&files.file))?, files.settings.clone()))
}

pub(super) fn pair(
    files: &PairFiles,
    models: &Path,
    loader: &Loader,
) -> Result<PairDetector<SsdLite, NanoDet>, Error> {
    let people = ssdlite(&files.people, models, loader)?;
    let objects = loader.open(&models.join(&files.objects.file))?;
    let objects = NanoDet::new(objects, files.objects.settings.clone());
    Ok(PairDetector::new(people, objects, files.settings.clone()))
}

/// What describes people, with the models that the demographics ask for. A models folder without the model that finds
/// faces is fine: then nothing is said that needs one, and a note says so.
pub(super) fn appearance(
    files: &AppearanceFiles,
    models: &Path,
    loader: &Loader,
    demographics: Demographics,
    notes: &mut Vec<String>,
) -> Result<Arc<Appearance>, Error> {
    let wants_gender = matches!(demographics, Demographics::Gender | Demographics::All);
    let mut faces = FaceModels::default();
    if !wants_gender && !models.join(&files.faces).exists() {
        notes.push(format!("no {}: which way faces look is unknown", files.faces));
    } else {
        let reader = |file: &str| Ok::<_, Error>(FaceReader::new(loader.open(&models.join(file))?));
        faces.gender = wants_gender.then(|| reader(&files.gender)).transpose()?;
        let wants_age = demographics == Demographics::All;
        faces.age = wants_age.then(|| reader(&files.age)).transpose()?;
        faces.finder = Some(FaceFinder::new(loader.open(&models.join(&files.faces))?));
    }
    Ok(Arc::new(Appearance::new(faces, files.settings.clone())))
}
