//! Writing a JRDB tree: the counterpart of [`Dataset`](crate::Dataset).

mod calibration;
mod frame;
mod labels;

use std::path::{Path, PathBuf};

use jrdb_types::{FrameId, Image, PointCloud};

use crate::calibration::{LIDARS, OfficialCalibration};
use crate::labels::{BOXES, SOCIAL, SPACE};
use crate::tree::{CALIBRATION, CLOUDS, IMAGES, LABELS};
use crate::{Error, check_sequence_name, file, image, pcd};
use frame::file_name;

pub use frame::LabelledFrame;

/// Writes a tree in JRDB's form, which [`Dataset`](crate::Dataset) and JRDB's own tools read.
///
/// The same values give the same bytes. Files that are there are replaced.
#[derive(Debug, Clone)]
pub struct TreeWriter {
    root: PathBuf,
}

impl TreeWriter {
    /// A writer below this root folder; folders are made as files need them.
    #[must_use]
    pub fn new(root: &Path) -> Self {
        Self { root: root.into() }
    }

    /// Writes `images/image_stitched/<sequence>/<frame>.png`.
    ///
    /// # Errors
    /// [`Error::Name`], [`Error::Write`], or [`Error::Content`] for an image without pixels or with a wrong number of
    /// samples.
    pub fn image(&self, frame: &FrameId, image: &Image) -> Result<(), Error> {
        check_sequence_name(&frame.sequence)?;
        let path = self.root.join(IMAGES).join(&frame.sequence).join(file_name(frame, "png"));
        let samples = 3 * image.width * image.height;
        if samples == 0 || image.rgb.len() != samples {
            let expected = format!("{} x {} rgb pixels", image.width, image.height);
            return Err(Error::content(&path, expected, format!("{} bytes", image.rgb.len())));
        }
        file::write(&path, &image::encode_png(image, image::PngCompression::Small))
    }

    /// Writes `pointclouds/<sensor>/<sequence>/<frame>.pcd`, compressed as JRDB's are.
    ///
    /// # Errors
    /// [`Error::Name`], [`Error::Write`], or [`Error::Content`] when the cloud's sensor is not one of JRDB's.
    pub fn cloud(&self, frame: &FrameId, cloud: &PointCloud) -> Result<(), Error> {
        check_sequence_name(&frame.sequence)?;
        let path = self.root.join(CLOUDS).join(&cloud.sensor).join(&frame.sequence);
        let path = path.join(file_name(frame, "pcd"));
        if !LIDARS.iter().any(|(name, _)| *name == cloud.sensor) {
            let expected = format!("{} or {} as sensor", LIDARS[0].0, LIDARS[1].0);
            return Err(Error::content(&path, expected, format!("{:?}", cloud.sensor)));
        }
        file::write(&path, &pcd::write(cloud, pcd::Encoding::BinaryCompressed))
    }

    /// Writes `calibration/cameras.yaml` and `calibration/defaults.yaml`, from which
    /// [`Dataset::official_calibration`](crate::Dataset::official_calibration) reads exactly this.
    ///
    /// # Errors
    /// [`Error::Write`], or [`Error::Content`] when the LiDARs are not the upper and the lower Velodyne.
    pub fn calibration(&self, official: &OfficialCalibration) -> Result<(), Error> {
        let folder = self.root.join(CALIBRATION);
        let path = folder.join("defaults.yaml");
        let names: Vec<&str> = official.lidars.iter().map(|lidar| lidar.name.as_str()).collect();
        if names != LIDARS.map(|(name, _)| name) {
            let expected = format!("lidars {} and {}", LIDARS[0].0, LIDARS[1].0);
            return Err(Error::content(&path, expected, format!("{names:?}")));
        }
        file::write(&path, calibration::defaults(official).as_bytes())?;
        file::write(&folder.join("cameras.yaml"), calibration::cameras(official).as_bytes())
    }

    /// Writes the three label files of a sequence: `labels/labels_2d_stitched/<sequence>.json`,
    /// `labels/labels_3d/` and `labels/labels_2d_activity_social_stitched/`.
    ///
    /// Numbers are rounded to 5 decimals. 3D boxes get `rot_z` = π - heading. An interaction is written
    /// on both partners when both are people of the frame. The social file holds people only; a person
    /// who takes part in no interaction is a social group of one.
    ///
    /// # Errors
    /// [`Error::Name`] or [`Error::Write`].
    pub fn labels(&self, sequence: &str, frames: &[LabelledFrame]) -> Result<(), Error> {
        check_sequence_name(sequence)?;
        let write = |folder: &str, text: String| {
            let path = self.root.join(LABELS).join(folder).join(format!("{sequence}.json"));
            file::write(&path, text.as_bytes())
        };
        write(BOXES, labels::boxes(frames))?;
        write(SPACE, labels::space(frames))?;
        write(SOCIAL, labels::social(frames))
    }
}
