//! `jrdb info`: what a file or a folder is, and what to do with it.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Result;
use clap::Args;
use jrdb_cli::Error;
use jrdb_dataset::{Description, Kind, describe};
use serde_json::json;

use super::print::{Format, say};

#[derive(Debug, Args)]
pub(crate) struct InfoArgs {
    /// A cloud, picture, JSON or YAML file, calibration, dataset, or a folder of KITTI or nuScenes
    path: PathBuf,
    /// How it is printed
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

pub(crate) fn info(args: &InfoArgs) -> Result<ExitCode> {
    let found = describe(&args.path).map_err(Error::from)?;
    let next = next(found.kind, &args.path);
    match args.format {
        Format::Text => say(&text(&found, next.as_deref()))?,
        Format::Json => {
            let Description { kind, title, contains, missing } = &found;
            let value = json!({
                "kind": kind, "title": title, "contains": contains, "missing": missing, "next": next,
            });
            say(&(serde_json::to_string_pretty(&value)? + "\n"))?;
        }
    }
    Ok(ExitCode::SUCCESS)
}

fn text(found: &Description, next: Option<&str>) -> String {
    let contains = found.contains.iter().map(|fact| format!("  {fact}\n"));
    let missing = found.missing.iter().map(|fact| format!("missing or odd: {fact}\n"));
    let next = next.map(|command| format!("next: {command}\n"));
    std::iter::once(format!("{}\n", found.title))
        .chain(contains)
        .chain(missing)
        .chain(next)
        .collect()
}

/// The command to use next, or where to put the file.
fn next(kind: Kind, path: &Path) -> Option<String> {
    let path = path.display();
    let words = match kind {
        Kind::Dataset => format!("jrdb run --scene {path} --query \"who is closest to me\""),
        Kind::KittiFolder => "jrdb rig kitti CALIB.txt --out rig.json".into(),
        Kind::NuscenesFolder => format!("jrdb rig nuscenes {path} --out rig.json"),
        Kind::Cloud => {
            "put it at pointclouds/LIDAR/SEQUENCE/000000 with its ending, then: jrdb run --scene ROOT".into()
        }
        Kind::Image => "put it at images/image_stitched/SEQUENCE/000000 with its ending".into(),
        Kind::Rig => format!("jrdb rig file {path}; jrdb run --scene ROOT --rig {path}"),
        Kind::Detections => format!("jrdb run --dataset ROOT --sequence NAME --perception file:{path}"),
        Kind::Labels => "put it at labels/labels_2d_stitched, labels_3d or labels_2d_activity_social_stitched, \
                         named like the sequence"
            .into(),
        Kind::Questions => format!("jrdb run --scene ROOT --questions {path}"),
        Kind::CameraCalibration => format!("jrdb rig camera {path} --out rig.json"),
        Kind::KittiCalibration => format!("jrdb rig kitti {path} --out rig.json"),
        _ => return None,
    };
    Some(words)
}
