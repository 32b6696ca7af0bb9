//! Which frames to work on, and what their files hold.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use jrdb_dataset::cloud::CloudColumns;
use jrdb_dataset::{Dataset, Decoded, check_sequence_name};
use jrdb_models::demographics::Demographics;
use jrdb_models::loader::EngineOptions;
use jrdb_models::{Perception, PerceptionOptions, PerceptionSource, SequenceSource};
use jrdb_pipeline::{CameraImage, Frame, Robot};
use jrdb_types::issue::IssueKind;
use jrdb_types::{FrameId, Image, Issue, PointCloud, Questions, Rig};

use crate::Error;

/// Where frames come from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Source {
    /// A folder in JRDB's form, all its sequences, with a `questions.json` of its own (what `jrdb synth`
    /// writes).
    Scene(PathBuf),
    /// One sequence of a JRDB tree.
    Sequence {
        /// The tree's root.
        root: PathBuf,
        /// The sequence's name.
        name: String,
    },
}

impl Source {
    fn root(&self) -> &Path {
        match self {
            Self::Scene(root) | Self::Sequence { root, .. } => root,
        }
    }

    /// The questions that come with a scene.
    ///
    /// # Errors
    /// When the file is there and unreadable.
    pub fn own_questions(&self) -> Result<Questions, Error> {
        let path = self.root().join("questions.json");
        match self {
            Self::Scene(_) if path.exists() => Ok(jrdb_dataset::read_questions(&path)?),
            _ => Ok(Questions::default()),
        }
    }
}

/// Which rig and which of its cameras to use, where not the tree's own.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct RobotOptions {
    /// A rig file, or a model of JRDB's own rig.
    pub rig: RigChoice,
    /// The camera that the images are from; the rig's first when absent.
    pub camera: Option<String>,
    /// The columns of clouds without a header; what their names and numbers say when absent.
    pub cloud_columns: Option<CloudColumns>,
}

/// Where a rig comes from.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum RigChoice {
    /// `calibration/rig.yaml` of the tree, else JRDB's official model.
    #[default]
    Tree,
    /// JRDB's stitched panorama as the five views that it is, fitted on one frame.
    JrdbRefined,
    /// A rig file.
    File(PathBuf),
}

impl std::str::FromStr for RigChoice {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(match text {
            "tree" => Self::Tree,
            "jrdb-refined" => Self::JrdbRefined,
            path => Self::File(path.into()),
        })
    }
}

/// The rig of a tree, or the one chosen instead.
///
/// # Errors
/// When its files cannot be read or it is unusable.
pub fn open_robot(dataset: &Dataset, options: &RobotOptions) -> Result<Robot, Error> {
    let rig = match &options.rig {
        RigChoice::Tree => dataset.rig()?,
        RigChoice::JrdbRefined => {
            jrdb_dataset::rig::jrdb_refined(&dataset.root().join("calibration"))?
        }
        RigChoice::File(path) => jrdb_dataset::rig::read(path)?,
    };
    Ok(Robot::new(rig, options.camera.clone())?)
}

/// A frame whose files have not been read yet.
#[derive(Debug, Clone)]
pub struct FrameSource {
    /// The tree it is in.
    pub dataset: std::sync::Arc<Dataset>,
    /// The robot's sensors.
    pub robot: std::sync::Arc<Robot>,
    /// Which frame.
    pub id: FrameId,
    /// What is odd about the rig.
    pub doubts: std::sync::Arc<[Issue]>,
}

/// What stands for every sequence of a tree.
const ALL: &str = "all";

/// The sequences that names stand for: names with commas between them, `all` for every sequence of
/// the tree, `@FILE` for a list with a name per line (`#` begins a remark). Each is listed once.
///
/// # Errors
/// When a list or the tree cannot be read.
pub fn sequence_names(root: &Path, names: &[String]) -> Result<Vec<String>, Error> {
    let mut wanted = Vec::new();
    for name in names.iter().flat_map(|names| names.split(',')).map(str::trim) {
        match name.strip_prefix('@') {
            Some(list) => wanted.extend(listed(Path::new(list))?),
            None if name == ALL => wanted.extend(Dataset::open(root)?.sequences()?),
            None => wanted.push(name.to_owned()),
        }
    }
    let mut seen = BTreeSet::new();
    wanted.retain(|name| seen.insert(name.clone()));
    Ok(wanted)
}

/// The names in a list.
fn listed(path: &Path) -> Result<Vec<String>, Error> {
    let text = std::fs::read_to_string(path).map_err(|error| Error::file("read", path, error))?;
    let names = text.lines().map(|line| line.split('#').next().unwrap_or_default().trim());
    Ok(names.filter(|name| !name.is_empty()).map(String::from).collect())
}

/// Lists the frames of all sources, in the order of the sources, then by sequence and number.
///
/// `range` keeps frames whose number lies in it.
///
/// # Errors
/// When a tree, its calibration or the sequence asked for is not there, no frame is left, or two sources
/// have a sequence of one name (questions and output folders go by it).
pub fn list_frames(
    sources: &[Source],
    range: Option<&std::ops::Range<u32>>,
    robot: &RobotOptions,
) -> Result<Vec<FrameSource>, Error> {
    let mut frames = Vec::new();
    let mut seen = BTreeSet::new();
    for source in sources {
        let dataset = Dataset::open(source.root())?;
        let dataset = std::sync::Arc::new(match &robot.cloud_columns {
            Some(columns) => dataset.with_cloud_columns(columns.clone()),
            None => dataset,
        });
        let robot = std::sync::Arc::new(open_robot(&dataset, robot)?);
        let doubts: std::sync::Arc<[Issue]> = rig_doubts(robot.rig()).into();
        let sequences = match source {
            Source::Scene(_) => dataset.sequences()?,
            Source::Sequence { name, .. } => vec![name.clone()],
        };
        for sequence in sequences {
            // Folders of --out are named like the sequences.
            check_sequence_name(&sequence)?;
            if !seen.insert(sequence.clone()) {
                let message =
                    format!("expected every sequence once, found {sequence:?} in two sources");
                return Err(Error::Usage(message));
            }
            for frame in dataset.frames(&sequence)? {
                if range.is_none_or(|range| range.contains(&frame)) {
                    let id = FrameId { sequence: sequence.clone(), frame };
                    let (dataset, robot) = (dataset.clone(), robot.clone());
                    frames.push(FrameSource { dataset, robot, id, doubts: doubts.clone() });
                }
            }
        }
    }
    if frames.is_empty() {
        let asked = range.map_or("any frame".into(), |r| format!("frames {}..{}", r.start, r.end));
        return Err(Error::Usage(format!("expected {asked} in {sources:?}, found none")));
    }
    Ok(frames)
}

/// What is odd about a rig, as issues.
fn rig_doubts(rig: &Rig) -> Vec<Issue> {
    let doubts = jrdb_dataset::rig::doubts(rig).into_iter();
    doubts.map(|doubt| Issue::new(IssueKind::DoubtfulInput, format!("rig: {doubt}"))).collect()
}

impl FrameSource {
    /// The frame with its sweeps; the image is decoded when something needs it.
    #[must_use]
    pub fn read(&self) -> Frame {
        let (sweeps, issues) = self.clouds();
        let mut frame = self.image_only();
        frame.sweeps = sweeps;
        frame.issues = issues;
        frame.issues.extend_from_slice(&self.doubts);
        frame
    }

    /// The frame without sweeps.
    #[must_use]
    pub fn image_only(&self) -> Frame {
        let mut frame = Frame::without_image(self.id.clone(), Vec::new());
        frame.images.push(self.camera_image());
        frame
    }

    /// The image, decoded when something needs it. What its file's header and end tell against it is known at once.
    fn camera_image(&self) -> CameraImage {
        let size_px = self.size_px();
        let header = self.dataset.image_header_of(&self.id.sequence, self.id.frame, size_px);
        match header.map_err(|error| self.missing(&error)) {
            Err(issue) => CameraImage::missing(issue),
            Ok(header) if header.is_complete => {
                let source = self.clone();
                CameraImage::on_demand(move || source.decoded())
            }
            Ok(_) => CameraImage::known(self.decoded()),
        }
    }

    /// Reads the frame's panorama.
    ///
    /// # Errors
    /// An issue when it is absent, broken, or of another size than the calibration's.
    pub fn image(&self) -> Result<Image, Issue> {
        self.decoded().map(|(image, _)| image)
    }

    /// The panorama, with what there is to remark about it.
    fn decoded(&self) -> Result<(Image, Option<Issue>), Issue> {
        let FrameId { sequence, frame } = &self.id;
        let decoded = self.dataset.image_of(sequence, *frame, self.size_px());
        let Decoded { image, remark } = decoded.map_err(|error| self.missing(&error))?;
        let about = |remark| {
            let path = self.dataset.image_path(sequence, *frame).unwrap_or_default();
            let place = path.strip_prefix(self.dataset.root()).unwrap_or(&path).display();
            Issue::new(IssueKind::MissingInput, format!("{place}: {remark}"))
        };
        Ok((image, remark.map(about)))
    }

    fn missing(&self, error: &jrdb_dataset::Error) -> Issue {
        Issue::new(IssueKind::MissingInput, self.dataset.error_text(error))
    }

    /// Columns and rows of the robot's camera.
    fn size_px(&self) -> [usize; 2] {
        let geometry = self.robot.image();
        [geometry.width_px, geometry.height_px].map(|side| side as usize)
    }

    /// Reads the frame's sweeps, one per LiDAR; what is missing or broken is an issue.
    #[must_use]
    pub fn clouds(&self) -> (Vec<PointCloud>, Vec<Issue>) {
        self.dataset.clouds(&self.id.sequence, self.id.frame, &self.robot.rig().lidars)
    }
}

/// Opens a source of detections for some frames.
///
/// # Errors
/// As [`Perception::open`].
pub fn open_perception(
    source: &PerceptionSource,
    frames: &[FrameSource],
    engine: &EngineOptions,
    demographics: Demographics,
) -> Result<Perception, Error> {
    let mut sequences: Vec<SequenceSource> = Vec::new();
    for frame in frames {
        if sequences.last().is_none_or(|last| last.name != frame.id.sequence) {
            sequences.push(SequenceSource {
                dataset: frame.dataset.clone(),
                name: frame.id.sequence.clone(),
                image: frame.robot.image(),
            });
        }
    }
    let is_labelled = |one: &SequenceSource| one.dataset.has_labels(&one.name);
    if let (PerceptionSource::Labels, false) = (source, sequences.iter().any(is_labelled)) {
        let names: Vec<&str> = sequences.iter().map(|one| one.name.as_str()).collect();
        let root = frames[0].dataset.root().into();
        return Err(Error::NoLabels { sequences: names.join(", "), root });
    }
    let options = PerceptionOptions { engine: engine.clone(), demographics, sequences };
    Ok(Perception::open_source(source, &options)?)
}
