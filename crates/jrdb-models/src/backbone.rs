//! Models that see: which ones, in which files, with which settings. Backbones are data.
//!
//! A backbone is a JSON file in the models folder, `NAME.json`, that names folders with graphs and the files beside them. What
//! `--perception NAME` means is all there; some are built in.

use std::path::{Path, PathBuf};

use jrdb_perception::florence2::{
    DecoderParts, Florence2, Florence2Config, Florence2Parts, FlorenceDetector,
    FlorenceDetectorConfig,
};
use jrdb_perception::grounding_dino::{
    CanvasConfig, GroundingDetector, GroundingDetectorConfig, GroundingDino,
};
use jrdb_perception::sweep::SweepConfig;
use jrdb_perception::tokens::Tokens;
use jrdb_perception::vlm::{
    AttributeConfig, Family, InternVlConfig, Qwen25VlConfig, Vlm, VlmAttributes, VlmParts,
};
use jrdb_perception::{AttributeModel, Detector, Engine, PerceptionError};
use serde::Deserialize;

use crate::Error;
use crate::loader::{EngineOptions, Loader};

/// Backbones that need no file of their own, only their models.
const BUILT_IN: [(&str, &str); 3] = [
    ("demo", include_str!("backbone/demo.json")),
    ("florence2-internvl", include_str!("backbone/florence2-internvl.json")),
    ("paper", include_str!("backbone/paper.json")),
];

/// A backbone as its file describes it.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Backbone {
    /// One line on what it is, said whenever it runs.
    pub about: String,
    /// What finds people and things.
    pub detector: DetectorFiles,
    /// What describes people; nobody does if absent.
    #[serde(default)]
    pub attributes: Option<AttributeFiles>,
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
    /// Finds people and things.
    pub detector: Box<dyn Detector + Send + Sync>,
    /// Describes people.
    pub attributes: Option<Box<dyn AttributeModel + Send + Sync>>,
    /// What the user should know.
    pub notes: Vec<String>,
    /// All that shapes the detections.
    pub config: serde_json::Value,
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

    /// The same models, looking at a picture as a single tile that does not wrap around.
    #[must_use]
    pub fn one_tile(&self) -> Self {
        let mut single = self.clone();
        let (DetectorFiles::Florence2 { settings: FlorenceDetectorConfig { tiles, .. }, .. }
        | DetectorFiles::GroundingDino {
            settings: GroundingDetectorConfig { tiles, .. }, ..
        }) = &mut single.detector;
        *tiles = SweepConfig::one_tile();
        single
    }

    /// Loads the models.
    ///
    /// # Errors
    /// When a file is missing or unusable; it is named.
    pub fn open(&self, name: &str, models: &Path, engine: &EngineOptions) -> Result<Opened, Error> {
        let loader = Loader::new(engine)?;
        let detector = self.detector.open(models, &loader)?;
        let attributes = match &self.attributes {
            Some(files) => Some(files.open(models, &loader)?),
            None => None,
        };
        let attribute_config = attributes.as_ref().map(VlmAttributes::config);
        let config = serde_json::json!({
            "perception": name,
            "about": self.about,
            "detector": detector.config(),
            "attributes": attribute_config,
        });
        let attributes = attributes.map(|model| Box::new(model) as _);
        let notes = vec![format!("{name}: {}", self.about), loader.note().into()];
        Ok(Opened { detector, attributes, notes, config })
    }
}

impl DetectorFiles {
    fn open(
        &self,
        models: &Path,
        loader: &Loader,
    ) -> Result<Box<dyn Detector + Send + Sync>, Error> {
        Ok(match self {
            Self::Florence2 { graphs, settings } => {
                let model = florence2(graphs, models, loader)?;
                let refused = Folder::new(models, graphs);
                let detector = FlorenceDetector::new(model, settings.clone());
                Box::new(detector.map_err(refused.refused())?)
            }
            Self::GroundingDino { graphs, settings } => {
                Box::new(grounding_dino(&Folder::new(models, graphs), loader, settings)?)
            }
        })
    }
}

impl AttributeFiles {
    fn open(&self, models: &Path, loader: &Loader) -> Result<VlmAttributes, Error> {
        let ((vlm, family), settings) = match self {
            Self::Internvl { graphs, settings } => (internvl(graphs, models, loader)?, settings),
            Self::Qwen25Vl { graphs, settings } => (qwen25vl(graphs, models, loader)?, settings),
        };
        let (Self::Internvl { graphs, .. } | Self::Qwen25Vl { graphs, .. }) = self;
        let folder = Folder::new(models, graphs);
        VlmAttributes::new(vlm, family, settings.clone()).map_err(folder.refused())
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
        let file = format!("{name}{}.onnx", self.variant);
        let places = [self.path.join("onnx").join(&file), self.path.join(&file)];
        let found = places.iter().find(|path| path.is_file()).cloned();
        found.ok_or_else(|| Error::read(&places[0])(std::io::ErrorKind::NotFound.into()))
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
            assert!(!found.about.is_empty() && found.attributes.is_some(), "{name}");
        }
    }

    #[test]
    fn unknown_names_are_told_with_the_known_ones() {
        let error = Backbone::named("eyes", Path::new("/nowhere")).unwrap_err().to_string();
        assert!(error.contains("demo, florence2-internvl, paper"), "{error}");
    }
}
