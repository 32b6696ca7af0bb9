//! What a folder is.

use std::collections::BTreeMap;
use std::path::Path;

use jrdb_types::with_causes;

use super::description::{Description, Kind};
use crate::{Dataset, Error, file};

/// Most sequences that are listed.
const MAX_SEQUENCES: usize = 20;

pub(super) fn describe(path: &Path) -> Result<Description, Error> {
    if let Ok(dataset) = Dataset::open(path) {
        return tree(&dataset);
    }
    let entries = file::list(path)?;
    let has_tables = |folder: &Path| folder.join("sample_data.json").is_file();
    if has_tables(path) || entries.iter().any(|entry| has_tables(entry)) {
        let tables = "the tables sensor, calibrated_sensor and sample_data";
        let description =
            Description::new(Kind::NuscenesFolder, "a folder of nuScenes").with(tables);
        return Ok(description.lacks("nuScenes' pictures and labels are not read from there: put pictures and sweeps into a tree of JRDB's form"));
    }
    let is_kitti =
        |folder: &Path| folder.join("velodyne").is_dir() || folder.join("calib").is_dir();
    if is_kitti(path) || entries.iter().any(|entry| is_kitti(entry)) {
        let mut description = Description::new(Kind::KittiFolder, "a folder of KITTI");
        for root in std::iter::once(path).chain(entries.iter().map(AsRef::as_ref)) {
            description.contains.extend(counts(root)?);
        }
        return Ok(description.lacks("KITTI's folders are not read as they are: put pictures and sweeps into a tree of JRDB's form"));
    }
    let mut endings: BTreeMap<String, usize> = BTreeMap::new();
    for entry in entries.iter().filter(|entry| entry.is_file()) {
        *endings.entry(file::extension(entry)).or_default() += 1;
    }
    let folders = entries.iter().filter(|entry| entry.is_dir()).count();
    let mut description = Description::new(Kind::Folder, "a folder");
    description.contains.push(format!("{folders} folders"));
    description
        .contains
        .extend(endings.iter().map(|(ending, count)| format!("{count} files .{ending}")));
    Ok(description.lacks("images/image_stitched or labels, which a tree of JRDB's form has"))
}

/// How many files each folder of KITTI's below another holds.
fn counts(root: &Path) -> Result<Vec<String>, Error> {
    const FOLDERS: [&str; 5] = ["calib", "velodyne", "image_2", "image_3", "label_2"];
    let found = FOLDERS.iter().filter(|name| root.join(name).is_dir());
    found
        .map(|name| Ok(format!("{name}: {}", plural(file::list(&root.join(name))?.len(), "file"))))
        .collect()
}

fn plural(count: usize, word: &str) -> String {
    format!("{count} {word}{}", if count == 1 { "" } else { "s" })
}

fn tree(dataset: &Dataset) -> Result<Description, Error> {
    let mut description = Description::new(Kind::Dataset, "a dataset in JRDB's form");
    match dataset.rig() {
        Ok(rig) => {
            let names = rig.cameras.iter().map(|camera| format!("camera {}", camera.name));
            let names = names.chain(rig.lidars.iter().map(|lidar| format!("lidar {}", lidar.name)));
            let names: Vec<String> = names.collect();
            description.contains.push(format!("a rig: {}", names.join(", ")));
        }
        Err(error) => {
            description.missing.push(format!("a calibration: {}", dataset.error_text(&error)));
        }
    }
    let sequences = dataset.sequences()?;
    for sequence in sequences.iter().take(MAX_SEQUENCES) {
        description = self::sequence(description, dataset, sequence);
    }
    if sequences.len() > MAX_SEQUENCES {
        description.contains.push(format!("{} more sequences", sequences.len() - MAX_SEQUENCES));
    }
    if sequences.is_empty() {
        description.missing.push("sequences: folders below images/image_stitched".into());
    }
    let questions = dataset.root().join("questions.json");
    if questions.is_file() {
        match crate::read_questions(&questions) {
            Ok(found) => description.contains.push(plural(found.questions.len(), "question")),
            Err(error) => description.missing.push(dataset.error_text(&error)),
        }
    }
    Ok(description)
}

fn sequence(mut description: Description, dataset: &Dataset, name: &str) -> Description {
    let frames = match dataset.frames(name) {
        Ok(frames) => frames,
        Err(error) => return description.lacks(dataset.error_text(&error)),
    };
    let span = match (frames.first(), frames.last()) {
        (Some(first), Some(last)) if first == last => format!(" ({first:06})"),
        (Some(first), Some(last)) => format!(" ({first:06} to {last:06})"),
        _ => String::new(),
    };
    description.contains.push(format!("sequence {name}: {}{span}", plural(frames.len(), "frame")));
    let pictures =
        frames.iter().filter(|frame| dataset.image_header(name, **frame).is_ok()).count();
    match (pictures, frames.first().map(|first| dataset.image_header(name, *first))) {
        (_, Some(Ok(header))) => {
            let [width, height] = header.size_px;
            let fact = format!("  {} of {width} x {height} px", plural(pictures, "picture"));
            description.contains.push(fact);
        }
        (0, _) => description.missing.push(format!("pictures of sequence {name}")),
        _ => description.contains.push(format!("  {}", plural(pictures, "picture"))),
    }
    for (lidar, count) in dataset.sweep_counts(name) {
        description.contains.push(format!("  {lidar}: {}", plural(count, "sweep")));
    }
    match dataset.labels(name) {
        Ok(labels) => {
            let fact = format!("  labels of {}", plural(labels.frames().len(), "frame"));
            description.contains.push(fact);
        }
        Err(Error::Absent { expected, .. }) => {
            description.missing.push(format!("labels of sequence {name}: {expected}"));
        }
        Err(error) => description.missing.push(with_causes(&error)),
    }
    description
}
