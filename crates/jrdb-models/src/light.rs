//! The light default perception: small models that come from package registries (docs/models.md).

use std::path::Path;

use jrdb_perception::{
    Appearance, AppearanceConfig, Detector, Engine, FaceFinder, FaceModels, FaceReader, NanoDet,
    NanoDetConfig, PairConfig, PairDetector, SsdLite, SsdLiteConfig,
};
use jrdb_types::Query;

use crate::Error;
use crate::backbone::Opened;
use crate::loader::{EngineOptions, open_engine};

/// The file of the SSDLite person detector in the models folder.
pub const SSDLITE_FILE: &str = "ssdlite-mbv2-300-person.f16.onnx";
/// The file of the NanoDet detector of people and objects in the models folder.
pub const NANODET_FILE: &str = "nanodet-g-416-coco.f16.onnx";

/// Confidence from which on the two detectors compare what they see; far below what is reported.
pub const COMPARED_MIN_SCORE: f64 = 0.05;

/// The files of the models that look at faces.
pub const CENTERFACE_FILE: &str = "centerface-480.onnx";
/// Guesses gender.
pub const GENDER_FILE: &str = "gender-v1.onnx";
/// Guesses age.
pub const AGE_FILE: &str = "age-v1.onnx";

/// Which demographic attributes are guessed from faces.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Demographics {
    /// Gender where a question needs it, else none.
    #[default]
    Auto,
    /// None.
    None,
    /// Gender.
    Gender,
    /// Gender and age; age is unreliable.
    All,
}

impl Demographics {
    /// What is meant, given the questions that will be asked.
    #[must_use]
    pub fn for_queries<'a>(self, queries: impl IntoIterator<Item = &'a Query>) -> Self {
        match self {
            Self::Auto if queries.into_iter().any(speaks_of_gender) => Self::Gender,
            Self::Auto => Self::None,
            chosen => chosen,
        }
    }
}

/// Whether a query has a condition on, or asks for, somebody's gender, however deep. Its JSON form names every part.
fn speaks_of_gender(query: &Query) -> bool {
    let bare = Query { text: String::new(), issues: Vec::new(), ..query.clone() };
    serde_json::to_string(&bare).is_ok_and(|json| json.contains("\"gender\""))
}

/// SSDLite and NanoDet as one detector of people and objects, with an attribute model behind it. A models folder without the model
/// that finds faces is fine: then nothing is said that needs one.
///
/// # Errors
/// When a model or its engine is unusable, or a model is missing that was asked for.
pub fn open(
    models: &Path,
    engine: &EngineOptions,
    demographics: Demographics,
) -> Result<Opened, Error> {
    let (detector, note) = detector(models, engine, PairConfig::default())?;
    let mut notes = vec![note];
    let faces = faces(models, engine, demographics, &mut notes)?;
    let appearance = Appearance::new(faces, AppearanceConfig::default());
    let config = serde_json::json!({
        "perception": "light",
        "detector": detector.config(),
        "attributes": appearance.config(),
    });
    Ok(Opened {
        detector: Box::new(detector),
        attributes: Some(Box::new(appearance)),
        notes,
        config,
    })
}

fn faces(
    models: &Path,
    engine: &EngineOptions,
    demographics: Demographics,
    notes: &mut Vec<String>,
) -> Result<FaceModels, Error> {
    let wants_gender = matches!(demographics, Demographics::Gender | Demographics::All);
    if !wants_gender && !models.join(CENTERFACE_FILE).exists() {
        notes.push(format!("no {CENTERFACE_FILE}: which way faces look is unknown"));
        return Ok(FaceModels::default());
    }
    let reader = |file: &str| Ok::<_, Error>(FaceReader::new(load(models, file, engine)?.0));
    let gender = wants_gender.then(|| reader(GENDER_FILE)).transpose()?;
    let age = (demographics == Demographics::All).then(|| reader(AGE_FILE)).transpose()?;
    let finder = Some(FaceFinder::new(load(models, CENTERFACE_FILE, engine)?.0));
    Ok(FaceModels { finder, gender, age })
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
    let bytes = std::fs::read(&path).map_err(Error::read(&path))?;
    open_engine(&bytes, &path, engine)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn meant(text: &str) -> Demographics {
        Demographics::Auto.for_queries([&jrdb_parser::parse(text)])
    }

    #[test]
    fn gender_is_guessed_for_questions_that_need_it_only() {
        assert_eq!(meant("Who is left of the woman?"), Demographics::Gender);
        assert_eq!(meant("Who is left of the sitting person?"), Demographics::None);
        let off = Demographics::None.for_queries([&jrdb_parser::parse("Find the man")]);
        assert_eq!(off, Demographics::None);
    }
}
