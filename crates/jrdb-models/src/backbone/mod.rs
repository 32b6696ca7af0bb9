//! Models that see: which ones, in which files, with which settings. Backbones are data.
//!
//! A backbone is a JSON file in the models folder, `NAME.json`, that names folders with graphs and the files beside them. What
//! `--perception NAME` means is all there; some are built in.

mod graphs;
mod light;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use jrdb_perception::florence2::{
    DecoderParts, Florence2, Florence2Config, Florence2Parts, FlorenceDetector,
    FlorenceDetectorConfig,
};
use jrdb_perception::generation::Tokens;
use jrdb_perception::grounding_dino::{
    CanvasConfig, GroundingDetector, GroundingDetectorConfig, GroundingDino,
};
use jrdb_perception::tiling::PanoramaConfig;
use jrdb_perception::vlm::{
    AttributeConfig, Family, InternVlConfig, Qwen25VlConfig, Vlm, VlmAttributes, VlmParts,
};
use jrdb_perception::{
    AttributeModel, Detector, Engine, Grounder, Models, PerceptionError, PhraseModel, SsdLiteConfig,
};
use serde::Deserialize;

use crate::Error;
use crate::demographics::Demographics;
use crate::loader::Loader;
use crate::options::PerceptionOptions;

pub use light::{AppearanceFiles, PairFiles, SingleFile};

/// Backbones that need no file of their own, only their models.
const BUILT_IN: [(&str, &str); 5] = [
    ("demo", include_str!("demo.json")),
    ("florence2-internvl", include_str!("florence2-internvl.json")),
    ("light", include_str!("light.json")),
    ("ssdlite", include_str!("ssdlite.json")),
    ("paper", include_str!("paper.json")),
];

/// A backbone as its file describes it.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Backbone {
    /// One line on what it is, said whenever it runs.
    pub about: String,
    /// What finds people and things.
    pub detector: DetectorFiles,
    /// The classes that the detector was trained for; those that it states itself if absent.
    #[serde(default)]
    pub categories: Option<Vec<String>>,
    /// What describes people; nobody does if absent.
    #[serde(default)]
    pub attributes: Option<AttributeFiles>,
    /// What judges phrases, where it is another model than what describes people.
    #[serde(default)]
    pub phrases: Option<AttributeFiles>,
}

/// A detector's files and settings.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum DetectorFiles {
    /// Florence-2.
    Florence2 {
        /// Where its graphs are.
        graphs: Graphs,
        /// How it looks.
        #[serde(default)]
        settings: FlorenceDetectorConfig,
    },
    /// MM-Grounding-DINO or LLMDet.
    GroundingDino {
        /// Where its graph is.
        graphs: Graphs,
        /// What it looks for, and how.
        #[serde(default)]
        settings: GroundingDetectorConfig,
    },
    /// SSDLite: people.
    Ssdlite(SingleFile<SsdLiteConfig>),
    /// SSDLite and NanoDet as one detector of people and objects.
    Pair(PairFiles),
}

/// An attribute model's files and settings.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum AttributeFiles {
    /// InternVL3.5.
    Internvl {
        /// Where its graphs are.
        graphs: Graphs,
        /// What is asked, and how.
        #[serde(default)]
        settings: AttributeConfig,
    },
    /// Qwen2.5-VL.
    #[serde(rename = "qwen2.5-vl")]
    Qwen25Vl {
        /// Where its graphs are.
        graphs: Graphs,
        /// What is asked, and how.
        #[serde(default)]
        settings: AttributeConfig,
    },
    /// Colours and posture from the box, facing, gender and age from the face.
    Appearance(AppearanceFiles),
}

/// Graphs of one model.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Graphs {
    /// Folder with `config.json`, `tokenizer.json` and the like, from the models folder.
    pub folder: PathBuf,
    /// What the graphs' names end with: `_q4` for `decoder_model_merged_q4.onnx`.
    #[serde(default)]
    pub variant: String,
}

/// A backbone whose models are loaded.
pub struct Opened {
    /// The models.
    pub models: Models,
    /// What the user should know.
    pub notes: Vec<String>,
}

/// The names of the backbones that are built in.
#[must_use]
pub fn built_in() -> Vec<&'static str> {
    BUILT_IN.iter().map(|(name, _)| *name).collect()
}

impl Backbone {
    /// The backbone of a name: a file in the models folder, else a built-in one.
    ///
    /// # Errors
    /// When there is none, or it is not what a backbone should be.
    pub fn named(name: &str, models: &Path) -> Result<Self, Error> {
        let path = models.join(format!("{name}.json"));
        let built_in = BUILT_IN.iter().find(|(known, _)| *known == name);
        let text = match (std::fs::read_to_string(&path), built_in) {
            (Ok(text), _) => text,
            (Err(_), Some((_, text))) => (*text).into(),
            (Err(source), None) => {
                let known = self::built_in();
                return Err(Error::UnknownBackbone { name: name.into(), path, known, source });
            }
        };
        let wrong = |source| Error::Backbone { path: path.clone(), source };
        serde_json::from_str(&text).map_err(wrong)
    }

    /// The same models, looking at a picture as a single tile that does not wrap around; small models keep their tiles.
    #[must_use]
    pub fn one_tile(&self) -> Self {
        let mut single = self.clone();
        match &mut single.detector {
            DetectorFiles::Florence2 { settings: FlorenceDetectorConfig { tiles, .. }, .. }
            | DetectorFiles::GroundingDino {
                settings: GroundingDetectorConfig { tiles, .. },
                ..
            } => *tiles = PanoramaConfig::one_tile(),
            DetectorFiles::Ssdlite(_) | DetectorFiles::Pair(_) => {}
        }
        single
    }

    /// Loads the models.
    ///
    /// # Errors
    /// When a file is missing or unusable; it is named.
    pub fn open(&self, name: &str, options: &PerceptionOptions) -> Result<Opened, Error> {
        let folder = &options.engine.models;
        let loader = Loader::new(&options.engine)?;
        let mut notes = vec![format!("{name}: {}", self.about), loader.note().into()];
        let (detector, grounder) = self.detector.open(folder, &loader)?;
        let mut open = |files: &Option<AttributeFiles>| {
            let opened = files
                .as_ref()
                .map(|one| one.open(folder, &loader, options.demographics, &mut notes));
            Ok::<_, Error>(opened.transpose()?.unzip())
        };
        let (describing, attribute_config) = open(&self.attributes)?;
        let (judging, phrase_config) = open(&self.phrases)?;
        let Describing { attributes, phrases } = describing.unwrap_or_default();
        let phrases = judging.map_or(phrases, |judging: Describing| judging.phrases);
        let mut config = serde_json::json!({
            "perception": name,
            "about": self.about,
            "detector": detector.config(),
            "attributes": attribute_config,
        });
        if let Some(phrase_config) = phrase_config {
            config["phrases"] = phrase_config;
        }
        notes.extend(loader.warnings());
        let categories = self.categories.as_ref().map(|all| all.iter().cloned().collect());
        let models = Models { detector, attributes, grounder, phrases, categories, config };
        Ok(Opened { models, notes })
    }
}

type OpenDetector = (Arc<dyn Detector>, Option<Arc<dyn Grounder>>);
type OpenAttributes = (Describing, serde_json::Value);

/// What describes people, and what judges phrases.
#[derive(Default)]
struct Describing {
    attributes: Option<Arc<dyn AttributeModel>>,
    phrases: Option<Arc<dyn PhraseModel>>,
}

impl DetectorFiles {
    fn open(&self, models: &Path, loader: &Loader) -> Result<OpenDetector, Error> {
        Ok(match self {
            Self::Florence2 { graphs, settings } => {
                let model = florence2(graphs, models, loader)?;
                let refused = Folder::new(models, graphs);
                let detector = FlorenceDetector::new(model, settings.clone());
                let detector = Arc::new(detector.map_err(refused.refused())?);
                (detector.clone(), Some(detector))
            }
            Self::GroundingDino { graphs, settings } => {
                let folder = Folder::new(models, graphs);
                let detector = Arc::new(grounding_dino(&folder, loader, settings)?);
                (detector.clone(), Some(detector))
            }
            Self::Ssdlite(files) => (Arc::new(light::ssdlite(files, models, loader)?), None),
            Self::Pair(files) => (Arc::new(light::pair(files, models, loader)?), None),
        })
    }
}

impl AttributeFiles {
    fn open(
        &self,
        models: &Path,
        loader: &Loader,
        demographics: Demographics,
        notes: &mut Vec<String>,
    ) -> Result<OpenAttributes, Error> {
        let ((vlm, family), graphs, settings) = match self {
            Self::Internvl { graphs, settings } => {
                (internvl(graphs, models, loader)?, graphs, settings)
            }
            Self::Qwen25Vl { graphs, settings } => {
                (qwen25vl(graphs, models, loader)?, graphs, settings)
            }
            Self::Appearance(files) => {
                let model = light::appearance(files, models, loader, demographics, notes)?;
                let config = model.config();
                return Ok((Describing { attributes: Some(model), phrases: None }, config));
            }
        };
        let folder = Folder::new(models, graphs);
        let model = VlmAttributes::new(vlm, family, settings.clone()).map_err(folder.refused())?;
        let (config, model) = (model.config(), Arc::new(model));
        Ok((Describing { attributes: Some(model.clone()), phrases: Some(model) }, config))
    }
}

/// A model's folder.
struct Folder {
    path: PathBuf,
    variant: String,
}

impl Folder {
    fn new(models: &Path, graphs: &Graphs) -> Self {
        Self { path: models.join(&graphs.folder), variant: graphs.variant.clone() }
    }

    fn text(&self, file: &str) -> Result<String, Error> {
        let path = self.path.join(file);
        std::fs::read_to_string(&path).map_err(Error::read(&path))
    }

    /// A graph's file: in `onnx/`, or in the folder itself.
    fn graph(&self, name: &str) -> Result<PathBuf, Error> {
        let place = self.place(name);
        let missing = || Error::read(&place)(std::io::ErrorKind::NotFound.into());
        if place.is_file() { Ok(place) } else { Err(missing()) }
    }

    /// Where a graph is, or where it is missing.
    fn place(&self, name: &str) -> PathBuf {
        let file = format!("{name}{}.onnx", self.variant);
        let [usual, other] = [self.path.join("onnx").join(&file), self.path.join(&file)];
        if !usual.is_file() && other.is_file() { other } else { usual }
    }

    fn open(&self, name: &str, loader: &Loader) -> Result<Box<dyn Engine>, Error> {
        loader.open(&self.graph(name)?)
    }

    /// An error of one of its files.
    fn refused(&self) -> impl Fn(PerceptionError) -> Error + '_ {
        |source| Error::Model { path: self.path.clone(), source: Box::new(source) }
    }
}

/// The Florence-2 of a folder.
///
/// # Errors
/// When a file is missing or unusable; it is named.
pub fn florence2(graphs: &Graphs, models: &Path, loader: &Loader) -> Result<Florence2, Error> {
    let folder = Folder::new(models, graphs);
    let [config, generation, picture] = texts(&folder)?;
    let processor = folder.text("processor_config.json").ok();
    let config = Florence2Config::from_json(&config, &generation, &picture, processor.as_deref());
    // The merged graph holds the weights once; where the two single ones are there instead, they are as good.
    let decoder = match folder.graph("decoder_model_merged") {
        Ok(path) => DecoderParts::Merged(loader.open(&path)?),
        Err(missing) => match folder.graph("decoder_model") {
            Ok(first) => DecoderParts::Split {
                first: loader.open(&first)?,
                next: folder.open("decoder_with_past_model", loader)?,
            },
            Err(_) => return Err(missing),
        },
    };
    let model = Florence2::new(Florence2Parts {
        config: config.map_err(folder.refused())?,
        tokens: Tokens::from_json(&folder.text("tokenizer.json")?).map_err(folder.refused())?,
        vision_encoder: folder.open("vision_encoder", loader)?,
        embed_tokens: folder.open("embed_tokens", loader)?,
        encoder: folder.open("encoder_model", loader)?,
        decoder,
    });
    model.map_err(folder.refused())
}

fn grounding_dino(
    folder: &Folder,
    loader: &Loader,
    settings: &GroundingDetectorConfig,
) -> Result<GroundingDetector, Error> {
    let canvas = CanvasConfig::from_json(&folder.text("preprocessor_config.json")?);
    let tokens = Tokens::from_json(&folder.text("tokenizer.json")?).map_err(folder.refused())?;
    let engine = folder.open("model", loader)?;
    let model = GroundingDino::new(engine, tokens, canvas.map_err(folder.refused())?)
        .map_err(folder.refused())?;
    GroundingDetector::new(model, settings.clone()).map_err(folder.refused())
}

/// The texts of `config.json`, `generation_config.json` and `preprocessor_config.json`.
fn texts(folder: &Folder) -> Result<[String; 3], Error> {
    Ok([
        folder.text("config.json")?,
        folder.text("generation_config.json")?,
        folder.text("preprocessor_config.json")?,
    ])
}

/// The InternVL of a folder, with its sizes and rules.
///
/// # Errors
/// When a file is missing or unusable; it is named.
pub fn internvl(graphs: &Graphs, models: &Path, loader: &Loader) -> Result<(Vlm, Family), Error> {
    let folder = Folder::new(models, graphs);
    let [config, generation, picture] = texts(&folder)?;
    let family = InternVlConfig::from_json(&config, &generation, &picture).map(Family::InternVl);
    vlm(&folder, loader, family)
}

/// The Qwen2.5-VL of a folder, with its sizes and rules.
///
/// # Errors
/// When a file is missing or unusable; it is named.
pub fn qwen25vl(graphs: &Graphs, models: &Path, loader: &Loader) -> Result<(Vlm, Family), Error> {
    let folder = Folder::new(models, graphs);
    let [config, generation, picture] = texts(&folder)?;
    let family = Qwen25VlConfig::from_json(&config, &generation, &picture).map(Family::Qwen25Vl);
    vlm(&folder, loader, family)
}

fn vlm(
    folder: &Folder,
    loader: &Loader,
    family: Result<Family, PerceptionError>,
) -> Result<(Vlm, Family), Error> {
    let family = family.map_err(folder.refused())?;
    let tokens = Tokens::from_json(&folder.text("tokenizer.json")?).map_err(folder.refused())?;
    let made = Vlm::new(VlmParts {
        text: family.text().clone(),
        tokens,
        vision_encoder: folder.open("vision_encoder", loader)?,
        embed_tokens: folder.open("embed_tokens", loader)?,
        decoder: folder.open("decoder_model_merged", loader)?,
    });
    Ok((made.map_err(folder.refused())?, family))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_built_in_is_read() {
        for (name, _) in BUILT_IN {
            let found = Backbone::named(name, Path::new("/nowhere")).unwrap();
            assert!(!found.about.is_empty(), "{name}");
        }
    }

    #[test]
    fn unknown_names_are_told_with_the_known_ones() {
        let error = Backbone::named("eyes", Path::new("/nowhere")).unwrap_err().to_string();
        assert!(error.contains("demo, florence2-internvl, light, ssdlite, paper"), "{error}");
    }
}
