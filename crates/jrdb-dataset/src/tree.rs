//! A JRDB tree: which sequences and frames there are, and their images, clouds, labels and rig.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use jrdb_types::{Image, Issue, IssueKind, Lidar, PointCloud, Rig, with_causes};

use crate::cloud::{CloudColumns, Reader};
use crate::image::{Decoded, ImageHeader};
use crate::labels::{self, SequenceLabels};
use crate::names::{
    CLOUD_EXTENSIONS, IMAGE_EXTENSIONS, absent_sweep, find, near, numbered, stem, unnumbered,
};
use crate::times::Timeline;
use crate::{Error, OfficialCalibration, file, image, rig, sweeps};

/// Folders of a tree, below its root.
pub(crate) const IMAGES: &str = "images/image_stitched";
pub(crate) const CLOUDS: &str = "pointclouds";
pub(crate) const CALIBRATION: &str = "calibration";
pub(crate) const LABELS: &str = "labels";

/// A rig in our own form, of which there may be one in the calibration folder.
const RIG_FILES: [&str; 3] = ["rig.json", "rig.yaml", "rig.yml"];

/// A JRDB tree on disk, for example `train_dataset_with_activity`.
///
/// Nothing is kept in memory: every call reads the files that it names.
#[derive(Debug, Clone)]
pub struct Dataset {
    root: PathBuf,
    /// The columns of clouds without a header, where somebody stated them.
    columns: Option<CloudColumns>,
}

impl Dataset {
    /// The tree with this root folder.
    ///
    /// # Errors
    /// [`Error::Absent`] when there are neither stitched images nor labels.
    pub fn open(root: &Path) -> Result<Self, Error> {
        if [IMAGES, LABELS].iter().any(|folder| root.join(folder).is_dir()) {
            Ok(Self { root: root.into(), columns: None })
        } else {
            let expected = format!("{IMAGES} or {LABELS}");
            Err(Error::Absent { expected, path: root.into() })
        }
    }

    /// The same tree, whose `.bin` and `.pcd.bin` clouds have these columns.
    #[must_use]
    pub fn with_cloud_columns(self, columns: CloudColumns) -> Self {
        Self { columns: Some(columns), ..self }
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
    /// Where all files are named by times, the pictures are numbered in the order of time, and the sweep of a frame is the one
    /// nearest in time.
    ///
    /// # Errors
    /// [`Error::Content`] when the sequence has no folder of either, with the sequences of names alike, or when no file of it
    /// is named by a number; [`Error::Read`] when a folder cannot be listed.
    pub fn frames(&self, sequence: &str) -> Result<Vec<u32>, Error> {
        let images = self.images(sequence);
        let sensors = file::list(&self.root.join(CLOUDS))?;
        let clouds: Vec<PathBuf> = sensors
            .iter()
            .map(|sensor| sensor.join(sequence))
            .filter(|path| path.is_dir())
            .collect();
        if !images.is_dir() && clouds.is_empty() {
            return Err(self.no_sequence(sequence));
        }
        let mut frames = BTreeSet::from_iter(numbered(&images, &IMAGE_EXTENSIONS)?);
        for folder in &clouds {
            frames.extend(numbered(folder, &CLOUD_EXTENSIONS)?);
        }
        if !frames.is_empty() {
            return Ok(frames.into_iter().collect());
        }
        if let Some(timeline) = self.timeline(sequence) {
            return Ok((0..timeline.len() as u32).collect());
        }
        let folders = std::iter::once((&images, &IMAGE_EXTENSIONS[..]))
            .chain(clouds.iter().map(|folder| (folder, &CLOUD_EXTENSIONS[..])));
        let odd = folders.filter_map(|(folder, e)| Some((folder, unnumbered(folder, e)?))).next();
        odd.map_or(Ok(Vec::new()), |(folder, name)| {
            let expected = "files named by the numbers of their frames, such as 000012.png or \
                            000012.pcd, equal for all sensors, or all by times";
            Err(Error::content(folder, expected, format!("{name:?}")))
        })
    }

    /// The pictures of a sequence in the order of time, where no file of the sequence is named by a number; without pictures,
    /// the sweeps of the first LiDAR.
    fn timeline(&self, sequence: &str) -> Option<Timeline> {
        let images = self.images(sequence);
        let sensors = file::list(&self.root.join(CLOUDS)).unwrap_or_default();
        let sweeps: Vec<PathBuf> = sensors.iter().map(|sensor| sensor.join(sequence)).collect();
        let has_numbers = |folder: &Path, extensions: &[&str]| {
            numbered(folder, extensions).is_ok_and(|numbers| !numbers.is_empty())
        };
        let has_numbers = has_numbers(&images, &IMAGE_EXTENSIONS)
            || sweeps.iter().any(|folder| has_numbers(folder, &CLOUD_EXTENSIONS));
        if has_numbers {
            return None;
        }
        if unnumbered(&images, &IMAGE_EXTENSIONS).is_some() {
            return Timeline::of(&images, &IMAGE_EXTENSIONS);
        }
        sweeps.iter().find_map(|folder| Timeline::of(folder, &CLOUD_EXTENSIONS))
    }

    /// A LiDAR's sweep nearest in time to a frame of a sequence whose files are named by times, or why there is none.
    fn sweep_by_time(
        &self,
        folder: &Path,
        sequence: &str,
        frame: u32,
    ) -> Option<Result<PathBuf, String>> {
        let timeline = self.timeline(sequence)?;
        let (time_ns, picture) = timeline.get(frame)?;
        let sweeps = Timeline::of(folder, &CLOUD_EXTENSIONS)?;
        let (apart_ns, path) = sweeps.nearest(time_ns)?;
        if apart_ns <= timeline.max_apart_ns() {
            return Some(Ok(path.into()));
        }
        let [picture, path] = [picture, path].map(|path| path.file_name().unwrap_or_default());
        let seconds = apart_ns as f64 * 1e-9;
        Some(Err(format!("no sweep near {picture:?} in time; {path:?} is {seconds:.3} s apart")))
    }

    fn no_sequence(&self, sequence: &str) -> Error {
        let expected = format!("images or clouds of sequence {sequence:?}");
        let known = self.sequences().unwrap_or_default();
        if known.is_empty() {
            return Error::Absent { expected, path: self.root.clone() };
        }
        let found = near(sequence, &known).into_iter().map(|name| format!("{name:?}"));
        let found = format!("the sequences {}", found.collect::<Vec<_>>().join(", "));
        Error::content(&self.root, expected, found)
    }

    /// The rig: from `calibration/rig.json`, `rig.yaml` or `rig.yml` where one is there
    /// (see [`rig::read`]), else from JRDB's own files by the official model.
    ///
    /// # Errors
    /// Those of [`rig::read`] or [`OfficialCalibration::read`], and [`Error::Content`] when there are two
    /// rig files.
    pub fn rig(&self) -> Result<Rig, Error> {
        let folder = self.root.join(CALIBRATION);
        let paths = RIG_FILES.into_iter().map(|name| file::named(&folder, name));
        let found: Vec<PathBuf> = paths.filter(|path| path.is_file()).collect();
        match &found[..] {
            [] => {
                let rig = OfficialCalibration::read(&folder)?.rig();
                rig::check(&rig, &folder)?;
                Ok(rig)
            }
            [path] => rig::read(path),
            _ => {
                let names: Vec<String> = found.iter().filter_map(|p| name(p.file_name())).collect();
                Err(Error::content(&folder, "one rig file", names.join(" and ")))
            }
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

    /// What the stitched image of a frame, of any size, tells without being decoded.
    ///
    /// # Errors
    /// [`Error::Absent`], or an image's error as far as the file's header tells.
    pub(crate) fn image_header(&self, sequence: &str, frame: u32) -> Result<ImageHeader, Error> {
        image::read_header(&self.image_path(sequence, frame)?)
    }

    /// The file that holds the stitched image of a frame.
    ///
    /// # Errors
    /// [`Error::Absent`].
    pub fn image_path(&self, sequence: &str, frame: u32) -> Result<PathBuf, Error> {
        let folder = self.images(sequence);
        let by_time = || {
            let timeline = self.timeline(sequence)?;
            let (_, path) = timeline.get(frame)?;
            path.starts_with(&folder).then(|| path.to_path_buf())
        };
        find(&folder, frame, &IMAGE_EXTENSIONS).or_else(by_time).ok_or_else(|| Error::Absent {
            expected: format!("{frame:06}.{}", IMAGE_EXTENSIONS.join(", .")),
            path: folder.clone(),
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
        let (mut clouds, mut issues) = (Vec::new(), Vec::new());
        let mut reader = self.columns.clone().map_or_else(Reader::default, Reader::with_columns);
        let place =
            |path: &Path| path.strip_prefix(&self.root).unwrap_or(path).display().to_string();
        for lidar in lidars {
            let folder = self.sweeps(&lidar.name, sequence);
            let numbered = find(&folder, frame, &CLOUD_EXTENSIONS).map(Ok);
            let by_time = || self.sweep_by_time(&folder, sequence, frame);
            let missing = |(path, why): (PathBuf, String)| {
                Issue::new(IssueKind::MissingInput, format!("{}: {why}", place(&path)))
            };
            let path = match numbered.or_else(by_time) {
                Some(Ok(path)) => path,
                Some(Err(why)) => {
                    issues.push(missing((folder, why)));
                    continue;
                }
                None => {
                    issues.push(missing(absent_sweep(&folder, frame)));
                    continue;
                }
            };
            let (cloud, more) = sweeps::read(&mut reader, &path, &lidar.name, &place(&path));
            clouds.extend(cloud);
            issues.extend(more);
        }
        (clouds, issues)
    }

    /// How many sweeps of a sequence each folder of a LiDAR has, sorted by the folders' names.
    pub(crate) fn sweep_counts(&self, sequence: &str) -> Vec<(String, usize)> {
        let folders = file::list(&self.root.join(CLOUDS)).unwrap_or_default();
        let count = |folder: &PathBuf| {
            let numbers = numbered(&folder.join(sequence), &CLOUD_EXTENSIONS).ok()?;
            Some((name(folder.file_name())?, numbers.len()))
        };
        folders.iter().filter_map(count).collect()
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

fn name(part: Option<&std::ffi::OsStr>) -> Option<String> {
    part?.to_str().map(String::from)
}
