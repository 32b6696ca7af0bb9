//! Which files a run reads, by their digests.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use jrdb_models::PerceptionSource;
use jrdb_models::sha256_hex;
use serde::{Deserialize, Serialize};

use crate::source::{FrameSource, RigChoice};

/// Folders of a tree with files that all frames share.
const CALIBRATION: &str = "calibration";
const LABELS: [&str; 3] =
    ["labels/labels_2d_stitched", "labels/labels_3d", "labels/labels_2d_activity_social_stitched"];

/// SHA-256 of files, by names without folders of the machine.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Inputs(BTreeMap<String, String>);

impl Inputs {
    /// The image and the sweeps of a frame, by their places in the tree.
    #[must_use]
    pub fn of_frame(frame: &FrameSource) -> Self {
        let lidars = &frame.robot.rig().lidars;
        let files = frame.dataset.frame_files(&frame.id.sequence, frame.id.frame, lidars);
        let mut inputs = Self::default();
        for path in files {
            inputs.add(&path, &place(&path, frame.dataset.root()));
        }
        inputs
    }

    /// The sizes of the images and sweeps of frames, by their places in the tree: of thousands of
    /// frames these are known at once, and digests are not.
    #[must_use]
    pub fn sizes(frames: &[FrameSource]) -> BTreeMap<String, u64> {
        let files = frames.iter().flat_map(|frame| {
            let lidars = &frame.robot.rig().lidars;
            let files = frame.dataset.frame_files(&frame.id.sequence, frame.id.frame, lidars);
            files.into_iter().map(|path| (place(&path, frame.dataset.root()), path))
        });
        let size = |path: &Path| std::fs::metadata(path).map_or(0, |file| file.len());
        files.map(|(name, path)| (name, size(&path))).collect()
    }

    /// What the frames of a run share: calibration, labels, a rig file, a file of detections or replies.
    #[must_use]
    pub fn shared(frames: &[FrameSource], rig: &RigChoice, perception: &PerceptionSource) -> Self {
        let mut inputs = Self::default();
        let mut last = None;
        for frame in frames {
            let sequence = &frame.id.sequence;
            if last != Some(sequence) {
                last = Some(sequence);
                inputs.add_sequence(frame, perception);
            }
        }
        if let RigChoice::File(path) = rig {
            inputs.add(path, "rig");
        }
        if let PerceptionSource::File(path) | PerceptionSource::Replay(path) = perception {
            inputs.add(path, "perception");
        }
        inputs
    }

    fn add_sequence(&mut self, frame: &FrameSource, perception: &PerceptionSource) {
        let (root, sequence) = (frame.dataset.root(), &frame.id.sequence);
        let mut files = listed(&root.join(CALIBRATION));
        if *perception == PerceptionSource::Labels {
            let file = format!("{sequence}.json");
            files.extend(LABELS.iter().map(|folder| root.join(folder).join(&file)));
        }
        for path in files {
            // Two trees may have files of one name; two sequences of a run have not.
            self.add(&path, &format!("{sequence}: {}", place(&path, root)));
        }
    }

    /// Adds a file's digest; what is no readable file has none. Pipes are not read: they can be read only once.
    fn add(&mut self, path: &Path, name: &str) {
        if path.is_file()
            && let Ok(bytes) = std::fs::read(path)
        {
            self.0.insert(name.into(), sha256_hex(&bytes));
        }
    }
}

fn listed(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten();
    let mut files: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    files.sort();
    files
}

/// A file's place in its tree.
fn place(path: &Path, root: &Path) -> String {
    let below = path.strip_prefix(root).unwrap_or(path);
    let parts = below.components().map(|part| part.as_os_str().to_string_lossy());
    parts.collect::<Vec<_>>().join("/")
}
