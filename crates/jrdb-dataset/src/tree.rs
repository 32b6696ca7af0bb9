//! A JRDB tree: which sequences and frames there are, and their images, clouds, labels and rig.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use jrdb_types::{Image, Issue, IssueKind, PointCloud, Rig};

use crate::calibration::{self, LIDARS};
use crate::error::chain;
use crate::labels::{self, SequenceLabels};
use crate::{Error, file, image, pcd};

/// Folders of a tree, below its root.
pub(crate) const IMAGES: &str = "images/image_stitched";
pub(crate) const CLOUDS: &str = "pointclouds";
pub(crate) const CALIBRATION: &str = "calibration";
pub(crate) const LABELS: &str = "labels";

const IMAGE_EXTENSIONS: [&str; 3] = ["jpg", "jpeg", "png"];
const CLOUD_EXTENSIONS: [&str; 1] = ["pcd"];

/// A JRDB tree on disk, for example `train_dataset_with_activity`.
///
/// Nothing is kept in memory: every call reads the files that it names.
#[derive(Debug, Clone)]
pub struct Dataset {
    root: PathBuf,
}

impl Dataset {
    /// The tree with this root folder.
    ///
    /// # Errors
    /// [`Error::Absent`] when there are neither stitched images nor labels.
    pub fn open(root: &Path) -> Result<Self, Error> {
        if [IMAGES, LABELS].iter().any(|folder| root.join(folder).is_dir()) {
            Ok(Self { root: root.into() })
        } else {
            let expected = format!("{IMAGES} or {LABELS}");
            Err(Error::Absent { expected, path: root.into() })
        }
    }

    /// The root folder.
    #[must_use]
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Names of the sequences, sorted: the folders of stitched images, or the label files where there
    /// are no images.
    ///
    /// # Errors
    /// [`Error::Read`] when a folder cannot be listed.
    pub fn sequences(&self) -> Result<Vec<String>, Error> {
        let images = self.root.join(IMAGES);
        if images.is_dir() {
            let folders = file::list(&images)?.into_iter().filter(|path| path.is_dir());
            return Ok(folders.filter_map(|path| name(path.file_name())).collect());
        }
        let mut names = BTreeSet::new();
        for folder in [labels::BOXES, labels::SPACE, labels::SOCIAL] {
            let files = file::list(&self.root.join(LABELS).join(folder))?;
            let files = files.into_iter().filter(|path| has_extension(path, &["json"]));
            names.extend(files.filter_map(|path| name(path.file_stem())));
        }
        Ok(names.into_iter().collect())
    }

    /// Numbers of the frames of a sequence that have a stitched image or a cloud, sorted.
    ///
    /// # Errors
    /// [`Error::Absent`] when the sequence has no folder of either, [`Error::Read`] when one cannot be
    /// listed.
    pub fn frames(&self, sequence: &str) -> Result<Vec<u32>, Error> {
        let images = self.images(sequence);
        let clouds = LIDARS.map(|(sensor, _)| self.sweeps(sensor, sequence));
        if !images.is_dir() && !clouds.iter().any(|folder| folder.is_dir()) {
            let expected = format!("images or clouds of sequence {sequence:?}");
            return Err(Error::Absent { expected, path: self.root.clone() });
        }
        let mut frames = BTreeSet::from_iter(numbered(&images, &IMAGE_EXTENSIONS)?);
        for folder in clouds {
            frames.extend(numbered(&folder, &CLOUD_EXTENSIONS)?);
        }
        Ok(frames.into_iter().collect())
    }

    /// The rig by JRDB's official model, from `calibration/cameras.yaml` and `defaults.yaml`.
    ///
    /// The panorama's size is that of `defaults.yaml`; its focal length and horizon are the medians of
    /// K\[1,1\] and K\[1,2\] over the sensors 0, 2, 4, 6 and 8. Of the cameras only K is read.
    ///
    /// # Errors
    /// [`Error::Read`], [`Error::Yaml`], or [`Error::Content`] for missing sensors, wrong counts,
    /// numbers that are not finite, and LiDARs turned about x or y.
    pub fn rig(&self) -> Result<Rig, Error> {
        calibration::read_rig(&self.root.join(CALIBRATION))
    }

    /// The stitched image of a frame.
    ///
    /// # Errors
    /// [`Error::Absent`], [`Error::Read`] or [`Error::Image`].
    pub fn image(&self, sequence: &str, frame: u32) -> Result<Image, Error> {
        let folder = self.images(sequence);
        let path = find(&folder, frame, &IMAGE_EXTENSIONS).ok_or_else(|| Error::Absent {
            expected: format!("{frame:06}.{}", IMAGE_EXTENSIONS.join(", .")),
            path: folder,
        })?;
        image::read_image(&path)
    }

    /// The sweeps of a frame, upper LiDAR first.
    ///
    /// A cloud that is absent or broken, and points without a finite position, are issues; the rest
    /// goes on.
    #[must_use]
    pub fn clouds(&self, sequence: &str, frame: u32) -> (Vec<PointCloud>, Vec<Issue>) {
        let (mut clouds, mut issues) = (Vec::new(), Vec::new());
        for (sensor, _) in LIDARS {
            let place = format!("{CLOUDS}/{sensor}/{sequence}/{frame:06}.pcd");
            match self.cloud(sensor, sequence, frame) {
                Ok(cloud) => {
                    if cloud.skipped > 0 {
                        let points = cloud.skipped;
                        let message = format!("{place}: {points} points without a finite position");
                        issues.push(Issue::new(IssueKind::SkippedPoints, message));
                    }
                    clouds.push(cloud);
                }
                Err(message) => {
                    let message = format!("{place}: {message}");
                    issues.push(Issue::new(IssueKind::MissingInput, message));
                }
            }
        }
        (clouds, issues)
    }

    /// One sweep, or why there is none, without host paths.
    fn cloud(&self, sensor: &str, sequence: &str, frame: u32) -> Result<PointCloud, String> {
        let path = find(&self.sweeps(sensor, sequence), frame, &CLOUD_EXTENSIONS)
            .ok_or_else(|| String::from("no such file"))?;
        let bytes = std::fs::read(path).map_err(|error| error.to_string())?;
        pcd::parse(&bytes, sensor).map_err(|error| chain(&error))
    }

    /// The labels of a sequence, from whichever of `labels_2d_stitched`, `labels_3d` and
    /// `labels_2d_activity_social_stitched` have it.
    ///
    /// # Errors
    /// [`Error::Absent`] when none has, [`Error::Read`], or [`Error::Json`] for a file that is not JSON
    /// or has no `labels`.
    pub fn labels(&self, sequence: &str) -> Result<SequenceLabels, Error> {
        SequenceLabels::read(&self.root.join(LABELS), sequence)
    }

    fn images(&self, sequence: &str) -> PathBuf {
        self.root.join(IMAGES).join(sequence)
    }

    fn sweeps(&self, sensor: &str, sequence: &str) -> PathBuf {
        self.root.join(CLOUDS).join(sensor).join(sequence)
    }
}

fn name(part: Option<&std::ffi::OsStr>) -> Option<String> {
    part?.to_str().map(String::from)
}

fn has_extension(path: &Path, extensions: &[&str]) -> bool {
    path.extension().is_some_and(|found| extensions.iter().any(|known| found == *known))
}

/// The frame numbers of a folder's files of a kind.
fn numbered(folder: &Path, extensions: &[&str]) -> Result<Vec<u32>, Error> {
    let files = file::list(folder)?.into_iter().filter(|path| has_extension(path, extensions));
    Ok(files.filter_map(|path| frame_of(&path)).collect())
}

/// A frame's file: six digits as in JRDB, else any file whose integer stem is the frame's number.
fn find(folder: &Path, frame: u32, extensions: &[&str]) -> Option<PathBuf> {
    let usual = extensions.iter().map(|extension| folder.join(format!("{frame:06}.{extension}")));
    usual.into_iter().find(|path| path.is_file()).or_else(|| {
        let mut files = file::list(folder).ok()?.into_iter();
        files.find(|path| has_extension(path, extensions) && frame_of(path) == Some(frame))
    })
}

fn frame_of(path: &Path) -> Option<u32> {
    file::frame_number(path.file_name()?.to_str()?)
}
