//! What a file is.

use std::collections::BTreeMap;
use std::path::Path;

use jrdb_types::{PointCloud, with_causes};
use serde_json::Value;

use super::description::{Description, Kind};
use crate::cloud::{Fields, Format, Reader, implausible};
use crate::names::{IMAGE_EXTENSIONS, stem};
use crate::{Error, file, image, json, rig};

/// Most categories that are listed.
const MAX_CATEGORIES: usize = 20;

pub(super) fn describe(path: &Path) -> Description {
    let extension = file::extension(path);
    if Format::of(path).is_some() {
        return cloud(path);
    }
    if stem(path, &IMAGE_EXTENSIONS).is_some() {
        return picture(path);
    }
    match extension.as_str() {
        "json" => structured(path, json::read(path, "JSON")),
        "yaml" | "yml" => structured(path, file::read_yaml(path, "YAML")),
        "txt" => kitti(path),
        _ => Description::new(Kind::Unknown, "a file of another kind").lacks(format!(
            "expected a cloud (.pcd .bin .npy .ply), a picture (.jpg .png), .json, .yaml or .txt, found .{extension}"
        )),
    }
}

fn cloud(path: &Path) -> Description {
    let description = Description::new(Kind::Cloud, "a point cloud");
    let mut reader = Reader::default();
    match reader.read(path, "lidar", Fields::All) {
        Ok(cloud) => {
            let notes = reader.notes().iter().cloned();
            let mut description = points(description, &cloud);
            description.missing.extend(notes);
            description.missing.extend(implausible(&cloud).map(|why| why.to_string()));
            description
        }
        Err(error) => description.lacks(with_causes(&error)),
    }
}

fn points(description: Description, cloud: &PointCloud) -> Description {
    let count = cloud.len();
    let mut description = description.with(format!("{count} points"));
    if cloud.skipped > 0 {
        let fact = format!("{} points without a finite position", cloud.skipped);
        description.missing.push(fact);
    }
    let columns =
        [("x", &cloud.x), ("y", &cloud.y), ("z", &cloud.z), ("intensity", &cloud.intensity)];
    for (name, numbers) in columns.into_iter().filter(|(_, numbers)| !numbers.is_empty()) {
        let least = numbers.iter().copied().fold(f32::INFINITY, f32::min);
        let most = numbers.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        description.contains.push(format!("{name} from {least:.2} to {most:.2}"));
    }
    let is_zero = |i: &usize| cloud.x[*i] == 0.0 && cloud.y[*i] == 0.0 && cloud.z[*i] == 0.0;
    let zeros = (0..count).filter(is_zero).count();
    if zeros > 0 {
        description
            .contains
            .push(format!("{zeros} points at the sensor itself, which are no returns"));
    }
    description
}

fn picture(path: &Path) -> Description {
    let description = Description::new(Kind::Image, "a picture");
    match image::read_header(path) {
        Ok(header) => {
            let [width, height] = header.size_px;
            let description = description.with(format!("{width} x {height} pixels"));
            if header.is_complete { description } else { description.lacks("the file breaks off") }
        }
        Err(error) => description.lacks(with_causes(&error)),
    }
}

/// A JSON or YAML file.
fn structured(path: &Path, read: Result<Value, Error>) -> Description {
    let value = match read {
        Ok(value) => value,
        Err(error) => {
            return Description::new(Kind::Unknown, "a file that cannot be read")
                .lacks(with_causes(&error));
        }
    };
    let key = |key: &str| value.get(key);
    if let Some(schema) = key("schema").and_then(Value::as_str) {
        return artefact(path, schema, &value);
    }
    if let Some(first) = value.as_array().and_then(|list| list.first()) {
        return list(first, &value);
    }
    if let Some(annotations) = key("annotations") {
        let mut description = Description::new(Kind::Detections, "a COCO dataset");
        description.contains.push(format!("{} images", length(key("images"))));
        description.contains.extend(categories(annotations, key("categories")));
        return description;
    }
    if let Some(frames) = key("detections").and_then(Value::as_object) {
        let title = "JRDB's own detections (detections_2d_stitched)";
        return of_frames(Description::new(Kind::Detections, title), frames);
    }
    if let Some(frames) = key("labels").and_then(Value::as_object) {
        return of_frames(Description::new(Kind::Labels, "a label file"), frames);
    }
    if let Ok(found) = rig::camera_file(path) {
        let lenses = found.rig.cameras.iter().map(|camera| {
            let image = camera.lens.image();
            format!("camera {}: {} x {} px", camera.name, image.width_px, image.height_px)
        });
        let mut description = Description::new(Kind::CameraCalibration, "a camera calibration");
        description.contains.extend(lenses);
        return description.lacks(found.missing);
    }
    let keys = value.as_object().into_iter().flatten().map(|(key, _)| key.as_str());
    let keys = keys.collect::<Vec<_>>().join(" ");
    if key("camera_matrix").is_some() {
        return Description::new(Kind::CameraCalibration, "a camera calibration")
            .lacks("its lens could not be read");
    }
    Description::new(Kind::Unknown, "a file of another kind").with(format!("the keys {keys}"))
}

fn length(list: Option<&Value>) -> usize {
    list.and_then(Value::as_array).map_or(0, Vec::len)
}

fn artefact(path: &Path, schema: &str, value: &Value) -> Description {
    let version = value.get("schema_version").map(Value::to_string).unwrap_or_default();
    if schema != "jrdb.rig" {
        return Description::new(
            Kind::Artefact,
            format!("an artefact {schema}, version {version}"),
        );
    }
    let description = Description::new(Kind::Rig, "a rig file");
    match rig::read(path) {
        Ok(found) => {
            let cameras = found.cameras.iter().map(|camera| format!("camera {}", camera.name));
            let lidars = found.lidars.iter().map(|lidar| format!("lidar {}", lidar.name));
            let mut description = description.with(format!("base {}", found.base));
            description.contains.extend(cameras.chain(lidars));
            description.missing.extend(rig::doubts(&found));
            description
        }
        Err(error) => description.lacks(with_causes(&error)),
    }
}

/// A list, by its first element.
fn list(first: &Value, all: &Value) -> Description {
    if first.get("image_id").is_some() {
        let mut description = Description::new(Kind::Detections, "COCO results");
        description.contains.extend(categories(all, None));
        return description;
    }
    let count = length(Some(all));
    if first.get("question").is_some() {
        let title = "JRDB-Reasoning data points";
        return Description::new(Kind::Questions, title).with(format!("{count} questions"));
    }
    match first.get("schema").and_then(Value::as_str) {
        Some(schema) => Description::new(Kind::Artefact, format!("{count} artefacts {schema}")),
        None => Description::new(Kind::Unknown, "a list of something else")
            .with(format!("{count} elements")),
    }
}

/// How many annotations there are of each category.
fn categories(annotations: &Value, names: Option<&Value>) -> Vec<String> {
    let name = |id: &Value| {
        let entries = names.and_then(Value::as_array).into_iter().flatten();
        let entry = entries.clone().find(|entry| entry.get("id") == Some(id));
        entry.and_then(|entry| entry.get("name")?.as_str()).map(|name| format!(" ({name})"))
    };
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for annotation in annotations.as_array().into_iter().flatten() {
        let id = annotation.get("category_id").unwrap_or(&Value::Null);
        *counts.entry(format!("{id}{}", name(id).unwrap_or_default())).or_default() += 1;
    }
    let count = format!("{} annotations", length(Some(annotations)));
    let lines = counts.iter().take(MAX_CATEGORIES);
    let lines = lines.map(|(id, count)| format!("category_id {id}: {count}"));
    std::iter::once(count).chain(lines).collect()
}

fn of_frames(description: Description, frames: &serde_json::Map<String, Value>) -> Description {
    let objects: usize = frames.values().map(|frame| length(Some(frame))).sum();
    let odd = frames.keys().find(|key| file::frame_number(key).is_none());
    let description = description.with(format!("{} frames, {objects} objects", frames.len()));
    match odd {
        Some(odd) => {
            description.lacks(format!("the frame key {odd:?} has no number, such as 000012.jpg"))
        }
        None => description,
    }
}

fn kitti(path: &Path) -> Description {
    let Ok(text) = file::read_text(path) else {
        return Description::new(Kind::Unknown, "a file that is no text");
    };
    let keys = text.lines().filter_map(|line| line.split([':', ' ']).next());
    let keys: Vec<&str> = keys.filter(|key| !key.is_empty()).collect();
    let is_it = |key: &&str| key.starts_with("Tr") || key.starts_with("P_rect") || *key == "P2";
    if !keys.iter().any(is_it) {
        return Description::new(Kind::Unknown, "a text of another kind");
    }
    let description = Description::new(Kind::KittiCalibration, "a KITTI calibration file");
    description.with(format!("the keys {}", keys.join(" ")))
}
