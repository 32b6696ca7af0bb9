//! A JRDB tree: which sequences and frames there are, and their images, clouds, labels and rig.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use jrdb_types::{Image, Issue, IssueKind, Lidar, PointCloud, Rig, with_causes};

use crate::cloud::{Fields, Reader};
use crate::image::{Decoded, ImageHeader};
use crate::labels::{self, SequenceLabels};
use crate::{Error, OfficialCalibration, file, image, rig};

/// Folders of a tree, below its root.
pub(crate) const IMAGES: &str = "images/image_stitched";
pub(crate) const CLOUDS: &str = "pointclouds";
pub(crate) const CALIBRATION: &str = "calibration";
pub(crate) const LABELS: &str = "labels";

const IMAGE_EXTENSIONS: [&str; 3] = ["jpg", "jpeg", "png"];
const CLOUD_EXTENSIONS: [&str; 5] = ["pcd", "bin", "npy", "ply", "pcd.bin"];

/// A rig in our own form, of which there may be one in the calibration folder.
const RIG_FILES: [&str; 3] = ["rig.json", "rig.yaml", "rig.yml"];

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

    /// An error's text with its causes, its paths relative to the root: artefacts name no folders of the machine.
    #[must_use]
    pub fn error_text(&self, error: &dyn std::error::Error) -> String {
        with_causes(error).replace(&format!("{}/", self.root.display()), "")
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
            names.extend(files.iter().filter_map(|path| stem(path, &["json"])).map(String::from));
        }
        Ok(names.into_iter().collect())
    }

    /// Numbers of the frames of a sequence that have a stitched image or a cloud of any LiDAR, sorted.
    ///
    /// # Errors
    /// [`Error::Absent`] when the sequence has no folder of either, [`Error::Read`] when one cannot be
    /// listed.
    pub fn frames(&self, sequence: &str) -> Result<Vec<u32>, Error> {
        let images = self.images(sequence);
        let sensors = file::list(&self.root.join(CLOUDS))?;
        let clouds: Vec<PathBuf> = sensors
            .iter()
            .map(|sensor| sensor.join(sequence))
            .filter(|path| path.is_dir())
            .collect();
        if !images.is_dir() && clouds.is_empty() {
            let expected = format!("images or clouds of sequence {sequence:?}");
            return Err(Error::Absent { expected, path: self.root.clone() });
        }
        let mut frames = BTreeSet::from_iter(numbered(&images, &IMAGE_EXTENSIONS)?);
        for folder in clouds {
            frames.extend(numbered(&folder, &CLOUD_EXTENSIONS)?);
        }
        Ok(frames.into_iter().collect())
    }

    /// The rig: from `calibration/rig.json`, `rig.yaml` or `rig.yml` where one is there
    /// (see [`rig::read`]), else from JRDB's own files by the official model.
    ///
    /// # Errors
    /// Those of [`rig::read`] or [`OfficialCalibration::read`], and [`Error::Content`] when there are two
    /// rig files.
    pub fn rig(&self) -> Result<Rig, Error> {
        let folder = self.root.join(CALIBRATION);
        let found: Vec<&str> =
            RIG_FILES.into_iter().filter(|name| folder.join(name).is_file()).collect();
        match found[..] {
            [] => Ok(OfficialCalibration::read(&folder)?.rig()),
            [name] => rig::read(&folder.join(name)),
            _ => Err(Error::content(&folder, "one rig file", found.join(" and "))),
        }
    }

    /// What `calibration/cameras.yaml` and `defaults.yaml` say by JRDB's official model.
    ///
    /// # Errors
    /// See [`OfficialCalibration::read`].
    pub fn official_calibration(&self) -> Result<OfficialCalibration, Error> {
        OfficialCalibration::read(&self.root.join(CALIBRATION))
    }

    /// The stitched image of a frame.
    ///
    /// # Errors
    /// [`Error::Absent`], [`Error::Read`] or [`Error::Image`].
    pub fn image(&self, sequence: &str, frame: u32) -> Result<Image, Error> {
        image::read_image(&self.image_path(sequence, frame)?)
    }

    /// The stitched image of a frame, which must have a size: columns and rows of its camera. The size is compared
    /// with the file's header before anything is decoded.
    ///
    /// # Errors
    /// As [`Dataset::image`].
    pub fn image_of(
        &self,
        sequence: &str,
        frame: u32,
        size_px: [usize; 2],
    ) -> Result<Decoded, Error> {
        image::read_image_of(&self.image_path(sequence, frame)?, size_px)
    }

    /// What the stitched image of a frame, which must have a size, tells without being decoded.
    ///
    /// # Errors
    /// As [`Dataset::image_of`], as far as the file's header tells.
    pub fn image_header_of(
        &self,
        sequence: &str,
        frame: u32,
        size_px: [usize; 2],
    ) -> Result<ImageHeader, Error> {
        image::read_header_of(&self.image_path(sequence, frame)?, size_px)
    }

    /// The file that holds the stitched image of a frame.
    ///
    /// # Errors
    /// [`Error::Absent`].
    pub fn image_path(&self, sequence: &str, frame: u32) -> Result<PathBuf, Error> {
        let folder = self.images(sequence);
        find(&folder, frame, &IMAGE_EXTENSIONS).ok_or_else(|| Error::Absent {
            expected: format!("{frame:06}.{}", IMAGE_EXTENSIONS.join(", .")),
            path: folder,
        })
    }

    /// The sweeps of a frame, one for each of the rig's LiDARs and in their order, from
    /// `pointclouds/<lidar>/<sequence>/<frame>` with the name of a format that [`crate::cloud::read`] knows. Positions only: no
    /// stage asks for intensities.
    ///
    /// A cloud that is absent or broken, and points without a finite position, are issues; the rest
    /// goes on.
    #[must_use]
    pub fn clouds(
        &self,
        sequence: &str,
        frame: u32,
        lidars: &[Lidar],
    ) -> (Vec<PointCloud>, Vec<Issue>) {
        let (mut clouds, mut issues, mut reader) = (Vec::new(), Vec::new(), Reader::default());
        for lidar in lidars {
            let folder = self.sweeps(&lidar.name, sequence);
            let file = find(&folder, frame, &CLOUD_EXTENSIONS)
                .unwrap_or_else(|| folder.join(format!("{frame:06}.pcd")));
            let place = file.strip_prefix(&self.root).unwrap_or(&file).display();
            match cloud(&mut reader, &file, &lidar.name) {
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

    /// Whether a file of labels is there for a sequence.
    #[must_use]
    pub fn has_labels(&self, sequence: &str) -> bool {
        let labels = self.root.join(LABELS);
        let folders = [labels::BOXES, labels::SPACE, labels::SOCIAL];
        folders.iter().any(|folder| labels.join(folder).join(format!("{sequence}.json")).is_file())
    }

    /// The files that hold a frame's stitched image and sweeps, as far as they are there.
    #[must_use]
    pub fn frame_files(&self, sequence: &str, frame: u32, lidars: &[Lidar]) -> Vec<PathBuf> {
        let image = self.image_path(sequence, frame).ok();
        let sweep =
            |lidar: &Lidar| find(&self.sweeps(&lidar.name, sequence), frame, &CLOUD_EXTENSIONS);
        image.into_iter().chain(lidars.iter().filter_map(sweep)).collect()
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

/// One sweep, or why there is none, without host paths.
fn cloud(reader: &mut Reader, path: &Path, sensor: &str) -> Result<PointCloud, String> {
    if !path.is_file() {
        return Err("no such file".into());
    }
    match reader.read(path, sensor, Fields::Positions) {
        Ok(cloud) => Ok(cloud),
        Err(Error::Cloud { source, .. }) => Err(with_causes(&source)),
        Err(Error::Read { source, .. }) => Err(source.to_string()),
        Err(error) => Err(with_causes(&error)),
    }
}

fn name(part: Option<&std::ffi::OsStr>) -> Option<String> {
    part?.to_str().map(String::from)
}

/// The name before its extension, which may have a dot of its own, if it is one of these.
fn stem<'a>(path: &'a Path, extensions: &[&str]) -> Option<&'a str> {
    let name = path.file_name()?.to_str()?;
    let stem = |extension: &&str| name.strip_suffix(extension)?.strip_suffix('.');
    extensions.iter().filter_map(stem).min_by_key(|stem| stem.len())
}

fn frame_of(path: &Path, extensions: &[&str]) -> Option<u32> {
    file::number(stem(path, extensions)?)
}

/// The frame numbers of a folder's files of a kind.
fn numbered(folder: &Path, extensions: &[&str]) -> Result<Vec<u32>, Error> {
    let files = file::list(folder)?;
    Ok(files.iter().filter_map(|path| frame_of(path, extensions)).collect())
}

/// A frame's file: six digits as in JRDB, else any file whose integer stem is the frame's number.
fn find(folder: &Path, frame: u32, extensions: &[&str]) -> Option<PathBuf> {
    let usual = extensions.iter().map(|extension| folder.join(format!("{frame:06}.{extension}")));
    usual.into_iter().find(|path| path.is_file()).or_else(|| {
        let mut files = file::list(folder).ok()?.into_iter();
        files.find(|path| frame_of(path, extensions) == Some(frame))
    })
}
