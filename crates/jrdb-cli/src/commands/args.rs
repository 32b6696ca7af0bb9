//! Flags that several commands share: which frames, which sensors, which perception, how people are placed.

use std::ops::Range;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use jrdb_cli::Error;
use jrdb_cli::source::{
    FrameSource, RigChoice, RobotOptions, Source, open_perception, sequence_names,
};
use jrdb_dataset::cloud::CloudColumns;
use jrdb_models::demographics::Demographics;
use jrdb_models::loader::{EngineChoice, EngineOptions, LibraryInModels};
use jrdb_models::profile::Profile;
use jrdb_models::{Perception, PerceptionSource};
use jrdb_pipeline::PipelineConfig;
use jrdb_types::score::IouKind;
use jrdb_types::{LateralConvention, Localizer};

/// Which frames.
#[derive(Debug, Args)]
pub(crate) struct SourceArgs {
    /// A scene folder, all its frames; may be given several times
    #[arg(long, value_name = "DIR", conflicts_with_all = ["dataset", "sequence"])]
    scene: Vec<PathBuf>,
    /// The root of a JRDB tree
    #[arg(long, value_name = "ROOT", requires = "sequence")]
    dataset: Option<PathBuf>,
    /// Sequences of the tree, with commas between them; all for every one, @FILE for a list with one
    /// per line; may be given several times
    #[arg(long, value_name = "NAME", requires = "dataset")]
    sequence: Vec<String>,
    /// Frame numbers, B exclusive; all when absent
    #[arg(long, value_name = "A..B", value_parser = frame_range)]
    pub(crate) frames: Option<Range<u32>>,
    #[command(flatten)]
    pub(crate) robot: RobotArgs,
}

/// Which sensors.
#[derive(Debug, Args)]
pub(crate) struct RobotArgs {
    /// A rig file; tree: the tree's own calibration (default); jrdb-refined: JRDB's panorama as the five
    /// views that it is
    #[arg(long, value_name = "RIG")]
    pub(crate) rig: Option<RigChoice>,
    /// The rig's camera that the images are from; its first when absent
    #[arg(long, value_name = "NAME")]
    camera: Option<String>,
    /// The columns of .bin and .pcd.bin clouds, such as x,y,z,intensity,ring or x:f64,y:f64,z:f64; by the name and the numbers when absent
    #[arg(long, value_name = "COLUMNS")]
    cloud_columns: Option<CloudColumns>,
}

impl RobotArgs {
    pub(crate) fn options(&self) -> RobotOptions {
        let (rig, camera) = (self.rig.clone().unwrap_or_default(), self.camera.clone());
        RobotOptions { rig, camera, cloud_columns: self.cloud_columns.clone() }
    }
}

impl SourceArgs {
    /// Whether any frames are named.
    pub(crate) fn is_given(&self) -> bool {
        self.dataset.is_some() || !self.scene.is_empty()
    }

    pub(crate) fn robot(&self) -> RobotOptions {
        self.robot.options()
    }

    pub(crate) fn sources(&self) -> Result<Vec<Source>, Error> {
        let of_tree = |root: &PathBuf| {
            let names = sequence_names(root, &self.sequence)?.into_iter();
            Ok(names.map(|name| Source::Sequence { root: root.clone(), name }).collect())
        };
        match &self.dataset {
            Some(root) => of_tree(root),
            None if self.scene.is_empty() => Err(Error::Usage(
                "expected --scene DIR, or --dataset ROOT and --sequence NAME".into(),
            )),
            None => Ok(self.scene.iter().cloned().map(Source::Scene).collect()),
        }
    }
}

fn frame_range(text: &str) -> Result<Range<u32>, String> {
    let expected = || format!("expected A..B with A < B, found {text:?}");
    let (start, end) = text.split_once("..").ok_or_else(expected)?;
    let [start, end] = [start, end].map(str::parse);
    match (start, end) {
        (Ok(start), Ok(end)) if start < end => Ok(start..end),
        _ => Err(expected()),
    }
}

/// Where detections come from.
#[derive(Debug, Args)]
pub(crate) struct PerceptionArgs {
    /// labels, file:PATH (our detections or COCO results), replay:PATH (an exchange), light (people and objects), ssdlite (people), or a backbone:
    /// demo, florence2-internvl, paper, or NAME for NAME.json in the models folder
    #[arg(long, default_value = "labels", value_name = "SOURCE")]
    pub(crate) perception: PerceptionSource,
    /// What light guesses from faces; the bare flag means gender
    #[arg(long, value_enum, default_value_t, num_args = 0..=1, default_missing_value = "gender", value_name = "WHAT")]
    pub(crate) demographics: DemographicsArg,
    #[command(flatten)]
    engine: EngineArgs,
}

impl PerceptionArgs {
    pub(crate) fn open(&self, frames: &[FrameSource]) -> Result<Perception, Error> {
        open_perception(&self.perception, frames, &self.engine(), self.demographics.into())
    }

    pub(crate) fn engine(&self) -> EngineOptions {
        self.engine.options()
    }
}

/// What runs models.
#[derive(Debug, Args)]
pub(crate) struct EngineArgs {
    #[command(flatten)]
    models: ModelsFolder,
    /// Which engine runs models
    #[arg(long, value_enum, default_value_t)]
    engine: EngineArg,
    /// ONNX Runtime's shared library
    #[arg(long, value_name = "PATH")]
    onnxruntime: Option<PathBuf>,
    /// Tell on stderr how long every graph of a model took, and the peak memory
    #[arg(long)]
    profile: bool,
}

impl EngineArgs {
    pub(crate) fn options(&self) -> EngineOptions {
        let (choice, library) = (self.engine.into(), self.onnxruntime.clone());
        let profile = self.profile.then(Profile::default);
        EngineOptions { choice, library, profile, ..self.models.engine() }
    }
}

/// The folder with model files.
#[derive(Debug, Args)]
pub(crate) struct ModelsFolder {
    /// Folder with model files; ./models when absent. ONNX Runtime's library is taken from it only when it is named
    #[arg(long, visible_alias = "dir", value_name = "DIR")]
    models: Option<PathBuf>,
}

/// The models folder when none is named.
const MODELS: &str = "models";

impl ModelsFolder {
    pub(crate) fn path(&self) -> PathBuf {
        self.models.clone().unwrap_or_else(|| MODELS.into())
    }

    /// An engine's options as far as they follow from the folder.
    pub(crate) fn engine(&self) -> EngineOptions {
        let library_in_models = match &self.models {
            Some(_) => LibraryInModels::Trusted,
            None => LibraryInModels::Ignored,
        };
        EngineOptions { models: self.path(), library_in_models, ..EngineOptions::default() }
    }
}

/// Which engine runs models.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub(crate) enum EngineArg {
    /// ONNX Runtime where its library is found, else rten
    #[default]
    Auto,
    /// Pure Rust, on the CPU
    Rten,
    /// ONNX Runtime
    Ort,
}

impl From<EngineArg> for EngineChoice {
    fn from(engine: EngineArg) -> Self {
        match engine {
            EngineArg::Auto => Self::Auto,
            EngineArg::Rten => Self::Rten,
            EngineArg::Ort => Self::Ort,
        }
    }
}

/// What `light` guesses from faces.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub(crate) enum DemographicsArg {
    /// Gender where a question needs it, else none
    #[default]
    Auto,
    /// None
    None,
    /// Gender
    Gender,
    /// Gender and age; age is unreliable
    All,
}

impl From<DemographicsArg> for Demographics {
    fn from(wanted: DemographicsArg) -> Self {
        match wanted {
            DemographicsArg::Auto => Self::Auto,
            DemographicsArg::None => Self::None,
            DemographicsArg::Gender => Self::Gender,
            DemographicsArg::All => Self::All,
        }
    }
}

/// How people are placed.
#[derive(Debug, Args)]
pub(crate) struct ProjectionArgs {
    /// Which side "left" names; engine-head mirrors it, as the benchmark's engine does
    #[arg(long, value_enum, default_value_t)]
    lateral: Lateral,
    /// How positions are found
    #[arg(long, value_enum, default_value_t)]
    localizer: LocalizerArg,
}

impl ProjectionArgs {
    pub(crate) fn apply(&self, config: &mut PipelineConfig) {
        config.projection.lateral = match self.lateral {
            Lateral::Physical => LateralConvention::Physical,
            Lateral::EngineHead => LateralConvention::BenchmarkMirrored,
        };
        config.projection.localizer = match self.localizer {
            LocalizerArg::DensestRange => Localizer::DensestRange,
            LocalizerArg::Mean => Localizer::Mean,
            LocalizerArg::Given => Localizer::Given,
        };
    }
}

#[derive(Debug, Clone, Copy, Default, ValueEnum)]
enum Lateral {
    #[default]
    Physical,
    EngineHead,
}

#[derive(Debug, Clone, Copy, Default, ValueEnum)]
enum LocalizerArg {
    /// Densest range bin in the core of the box
    #[default]
    DensestRange,
    /// Mean of all points in the box (the paper)
    Mean,
    /// The 3D box that came with the detection
    Given,
}

/// Which IoU scores use.
#[derive(Debug, Clone, Copy, Default, ValueEnum)]
pub(crate) enum Iou {
    /// On the plane, as the official evaluators
    #[default]
    Planar,
    /// On the circle of the panorama
    Circular,
}

impl Iou {
    pub(crate) fn apply(self, config: &mut PipelineConfig) {
        config.metrics.iou = match self {
            Self::Planar => IouKind::Planar,
            Self::Circular => IouKind::Circular,
        };
    }
}
