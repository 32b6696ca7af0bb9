//! What is said of a file or a folder.

use serde::Serialize;

/// What a file or a folder is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Kind {
    /// A tree in JRDB's form.
    Dataset,
    /// A folder of KITTI's object benchmark.
    KittiFolder,
    /// nuScenes' tables, or a folder with them.
    NuscenesFolder,
    /// A folder of anything else.
    Folder,
    /// A point cloud.
    Cloud,
    /// A picture.
    Image,
    /// A rig file.
    Rig,
    /// An artefact of this program other than a rig.
    Artefact,
    /// COCO results, a COCO dataset, or JRDB's own detections.
    Detections,
    /// A label file.
    Labels,
    /// JRDB-Reasoning data points.
    Questions,
    /// A camera calibration of ROS, Kalibr or OpenCV.
    CameraCalibration,
    /// A KITTI calibration file.
    KittiCalibration,
    /// Anything else.
    Unknown,
}

/// What a file or a folder is and contains, in words.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Description {
    /// What it is.
    pub kind: Kind,
    /// The kind in words.
    pub title: String,
    /// What it contains, one fact each.
    pub contains: Vec<String>,
    /// What is missing or odd, one fact each.
    pub missing: Vec<String>,
}

impl Description {
    pub(super) fn new(kind: Kind, title: impl Into<String>) -> Self {
        Self { kind, title: title.into(), contains: Vec::new(), missing: Vec::new() }
    }

    pub(super) fn with(mut self, fact: impl Into<String>) -> Self {
        self.contains.push(fact.into());
        self
    }

    pub(super) fn lacks(mut self, fact: impl Into<String>) -> Self {
        self.missing.push(fact.into());
        self
    }
}
