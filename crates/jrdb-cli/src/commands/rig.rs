//! `jrdb rig`: other people's calibration files as a rig file.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Result, bail};
use clap::{Args, ValueEnum};
use jrdb_cli::Error;
use jrdb_dataset::{OfficialCalibration, rig};
use jrdb_pipeline::Robot;
use jrdb_types::Rig;
use serde_json::json;

use super::stage::OutputArgs;

#[derive(Debug, Args)]
pub(crate) struct RigArgs {
    /// What PATH is
    #[arg(value_enum)]
    kind: Kind,
    /// jrdb: a tree's calibration folder; kitti: a calib file; nuscenes: a folder with its tables; camera: a camera calibration;
    /// file: a rig file
    path: PathBuf,
    /// Size of KITTI's images, which its files do not say
    #[arg(long, value_name = "W H", num_args = 2, default_values_t = [1242, 375])]
    image_size: Vec<u32>,
    /// The nuScenes sample whose calibration to take; needed when sensors have several
    #[arg(long, value_name = "TOKEN")]
    sample: Option<String>,
    #[command(flatten)]
    output: OutputArgs,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Kind {
    /// JRDB's official panorama and its LiDARs
    Jrdb,
    /// JRDB's panorama as the five views that it is, fitted on one frame
    JrdbRefined,
    /// JRDB's five single cameras
    JrdbCameras,
    /// A KITTI calib file: object, tracking, odometry, or raw calib_cam_to_cam.txt
    Kitti,
    /// nuScenes' sensor, calibrated_sensor and sample_data tables
    Nuscenes,
    /// A ROS camera_info, a Kalibr camchain or an OpenCV calibration: lenses without their places
    Camera,
    /// A rig file, to check it
    File,
}

pub(crate) fn rig(args: &RigArgs) -> Result<ExitCode> {
    let found = read(args)?;
    for doubt in rig::doubts(&found) {
        eprintln!("warning: {}: {doubt}", args.path.display());
    }
    let robot = Robot::new(found, None)?;
    let Rig { base, transforms, cameras, lidars } = robot.rig();
    let camera = |c: &jrdb_types::Camera| {
        let image = c.lens.image();
        format!(
            "camera {} in frame {}, {} x {} px",
            c.name, c.frame, image.width_px, image.height_px
        )
    };
    let lidar = |l: &jrdb_types::Lidar| format!("lidar {} in frame {}", l.name, l.frame);
    let head = format!("base {base}, {} transforms", transforms.len());
    let lines = cameras.iter().map(camera).chain(lidars.iter().map(lidar));
    let summary = std::iter::once(head).chain(lines).collect::<Vec<_>>().join("\n");
    args.output.give(json!({}), robot.rig(), &summary)
}

fn read(args: &RigArgs) -> Result<Rig> {
    let path = args.path.as_path();
    let found = match args.kind {
        Kind::Jrdb => OfficialCalibration::read(path).map(|official| official.rig()),
        Kind::JrdbRefined => rig::jrdb_refined(path),
        Kind::JrdbCameras => rig::jrdb_cameras(path),
        Kind::Kitti => {
            let [width, height] = args.image_size[..] else {
                bail!(Error::Usage("expected --image-size W H".into()));
            };
            rig::kitti(path, [width, height])
        }
        Kind::Nuscenes => {
            let calibrations = args.sample.as_deref();
            rig::nuscenes(
                path,
                calibrations.map_or(rig::Calibrations::Only, rig::Calibrations::OfSample),
            )
        }
        Kind::Camera => rig::camera_file(path).map(|found| {
            eprintln!("warning: {}: {}", path.display(), found.missing);
            found.rig
        }),
        Kind::File => rig::read(path),
    };
    Ok(found.map_err(Error::from)?)
}
