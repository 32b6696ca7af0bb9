//! Rigs of any robot: our own rig files, and the calibration files of JRDB, KITTI and nuScenes.

mod foreign;
mod jrdb;
mod kitti;
mod matrix;
mod nuscenes;
mod pinhole;
mod plausible;

use std::path::Path;

use jrdb_types::artefact::Payload;
use jrdb_types::{ArtefactError, Camera, LensModel, Lidar, Rig, Transform};
use serde::de::{DeserializeOwned, Error as _};
use serde_json::{Map, Value};

pub use foreign::{ForeignCamera, camera_file};
pub use jrdb::{jrdb_cameras, jrdb_refined};
pub use kitti::kitti;
pub use nuscenes::{Calibrations, nuscenes};
pub(crate) use plausible::check;
pub use plausible::doubts;

use crate::{Error, file, json, picture_size};

/// Reads a rig file: a `jrdb.rig` artefact as `.json`, `.yaml` or `.yml`.
///
/// A file written by hand needs `schema`, `schema_version` and `data`; what a program adds besides is not looked
/// at. Whether its rotations are rotations and its frames form a tree is checked where the tree is resolved, in
/// `jrdb-projection`.
///
/// ```yaml
/// schema: jrdb.rig
/// schema_version: 2
/// data:
///   base: base_link
///   transforms:
///     - { parent: base_link, child: top_lidar, translation_m: [0.1, 0, 0.4], rotation: { rpy_rad: [0, 0, 0.02] } }
///     - { parent: base_link, child: front, rotation: { quaternion_wxyz: [0.5, -0.5, 0.5, -0.5] } }
///   cameras:
///     - name: front
///       frame: front
///       lens: { model: pinhole, width_px: 1280, height_px: 720, fx: 640, fy: 640, cx: 640, cy: 360 }
///   lidars:
///     - { name: top_lidar, frame: top_lidar }
/// ```
///
/// # Errors
/// [`Error::Read`]; [`Error::Json`] or [`Error::Yaml`] where the text is neither; [`Error::Content`] for a file with
/// another ending; [`Error::Artefact`] for another artefact, another version of it, or data that are no rig: then
/// with the place of the first thing that is wrong, as `data.cameras[0].lens.fx`. [`Error::Content`], too, for numbers that are
/// of another unit: angles beyond 2 π, mounts beyond 10 m, focal lengths below 10 px; and for a camera calibration of ROS, Kalibr or
/// OpenCV.
pub fn read(path: &Path) -> Result<Rig, Error> {
    const EXPECTED: &str = "a jrdb.rig artefact";
    let value: Value = match file::extension(path).as_str() {
        "json" => json::read(path, EXPECTED)?,
        "yaml" | "yml" => file::read_yaml(path, EXPECTED)?,
        _ => {
            let name = path.file_name().unwrap_or_default();
            return Err(Error::content(path, "a .json, .yaml or .yml file", format!("{name:?}")));
        }
    };
    if let Some(kind) = foreign::kind(&value) {
        return Err(Error::content(path, EXPECTED, kind));
    }
    let rig = from_value(value).map_err(|source| Error::Artefact { path: path.into(), source })?;
    for (i, camera) in rig.cameras.iter().enumerate() {
        let (image, place) = (camera.lens.image(), format!("data.cameras[{i}].lens"));
        let keys = [&*format!("{place}.width_px"), &*format!("{place}.height_px")];
        picture_size::check([image.width_px, image.height_px], keys, path)?;
    }
    check(&rig, path)?;
    Ok(rig)
}

/// The rig in an artefact of which the name and the version are checked first.
fn from_value(mut artefact: Value) -> Result<Rig, ArtefactError> {
    let malformed = |message| {
        let source = serde_json::Error::custom(message);
        ArtefactError::Malformed { schema: Rig::SCHEMA, source }
    };
    let absent = |key: &str, kind: &str| malformed(format!("expected {kind} as `{key}`"));
    let schema = artefact["schema"].as_str().ok_or_else(|| absent("schema", "a text"))?;
    if schema != Rig::SCHEMA {
        return Err(ArtefactError::WrongSchema { expected: Rig::SCHEMA, found: schema.into() });
    }
    let version = &artefact["schema_version"];
    let found = version.as_u64().ok_or_else(|| absent("schema_version", "a whole number"))?;
    if found != u64::from(Rig::VERSION) {
        let (schema, expected) = (Rig::SCHEMA, Rig::VERSION);
        return Err(ArtefactError::WrongVersion { schema, expected, found });
    }
    let data = artefact["data"].take();
    serde_json::from_value(data.clone())
        .map_err(|error| malformed(fault(&data).unwrap_or_else(|| format!("data: {error}"))))
}

/// The place of the first thing that is wrong with a rig's data, and what is.
fn fault(data: &Value) -> Option<String> {
    fault_in_list::<Transform>(data, "transforms")
        .or_else(|| {
            let mut cameras = data.get("cameras")?.as_array()?.iter().enumerate();
            cameras.find_map(|(i, camera)| {
                let place = format!("data.cameras[{i}].lens");
                fault_in::<LensModel>(&place, camera.get("lens")?, Some("model"))
            })
        })
        .or_else(|| fault_in_list::<Camera>(data, "cameras"))
        .or_else(|| fault_in_list::<Lidar>(data, "lidars"))
        .or_else(|| fault_in::<Rig>("data", data, None))
}

fn fault_in_list<T: DeserializeOwned>(data: &Value, key: &str) -> Option<String> {
    let mut elements = data.get(key)?.as_array()?.iter().enumerate();
    elements.find_map(|(i, element)| fault_in::<T>(&format!("data.{key}[{i}]"), element, None))
}

/// The place of what is wrong with an object: of the key at fault, if it is one.
///
/// A key is at fault when an object of it alone, but for the tag that tells the object's kind, is refused for
/// another reason than the absence of others.
fn fault_in<T: DeserializeOwned>(place: &str, value: &Value, tag: Option<&str>) -> Option<String> {
    let error = serde_json::from_value::<T>(value.clone()).err()?;
    let alone = |key: &str| {
        let entries = value.as_object()?.iter();
        let these = entries.filter(|(name, _)| *name == key || Some(name.as_str()) == tag);
        let object: Map<_, _> = these.map(|(name, value)| (name.clone(), value.clone())).collect();
        let error = serde_json::from_value::<T>(object.into()).err()?.to_string();
        (!error.starts_with("missing field")).then(|| format!("{place}.{key}: {error}"))
    };
    let keys = value.as_object().into_iter().flatten().map(|(key, _)| key.as_str());
    let at_key = tag.into_iter().chain(keys).find_map(alone);
    Some(at_key.unwrap_or_else(|| format!("{place}: {error}")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn good() -> Value {
        json!({"schema": "jrdb.rig", "schema_version": 2, "remark": "by hand", "data": {
            "base": "base_link",
            "transforms": [{"parent": "base_link", "child": "top", "rotation": {"rpy_rad": [0, 0, 0.1]}}],
            "cameras": [
                {"name": "ring", "frame": "base_link", "lens":
                    {"model": "equirectangular", "width_px": 3840, "height_px": 1920}},
                {"name": "front", "frame": "top", "lens": {"model": "pinhole", "width_px": 4, "height_px": 3,
                    "fx": 2, "fy": 2, "cx": 2, "cy": 1.5, "distortion": "none"}},
            ],
            "lidars": [{"name": "top", "frame": "top"}]
        }})
    }

    fn error(value: Value) -> String {
        match from_value(value) {
            Err(ArtefactError::Malformed { source, .. }) => source.to_string(),
            other => other.map(|_| ()).unwrap_err().to_string(),
        }
    }

    #[test]
    fn the_envelope_needs_no_producer() {
        let rig = from_value(good()).unwrap();
        assert_eq!((rig.base.as_str(), rig.cameras.len()), ("base_link", 2));
    }

    #[test]
    fn name_version_and_data_are_three_different_errors() {
        let with = |key: &str, value: Value| {
            let mut artefact = good();
            artefact[key] = value;
            from_value(artefact).unwrap_err().to_string()
        };
        let schema = with("schema", "jrdb.query".into());
        assert_eq!(schema, r#"expected a "jrdb.rig" artefact, found "jrdb.query""#);
        let version = with("schema_version", 1.into());
        assert_eq!(version, "expected jrdb.rig version 2, found version 1");
        assert_eq!(with("data", Value::Null), "not a well-formed jrdb.rig artefact");
        assert_eq!(error(json!([])), "expected a text as `schema`");
        assert_eq!(
            error(json!({"schema": "jrdb.rig"})),
            "expected a whole number as `schema_version`"
        );
    }

    /// Every place with another value, and the start of the error that this gives.
    fn check(cases: &[(&str, Value, &str)]) {
        for (pointer, value, expected) in cases {
            let mut artefact = good();
            *artefact.pointer_mut(pointer).unwrap() = value.clone();
            let found = error(artefact);
            assert!(found.starts_with(expected), "{pointer}: {found}");
        }
    }

    #[test]
    fn a_fault_of_a_camera_is_told_with_its_place() {
        let cases = [
            (
                "/data/cameras/1/lens/fx",
                json!("wide"),
                "data.cameras[1].lens.fx: invalid type: string \"wide\", expected f64",
            ),
            (
                "/data/cameras/1/lens/distortion",
                json!({"brown": 1}),
                "data.cameras[1].lens.distortion: unknown variant `brown`",
            ),
            (
                "/data/cameras/0/lens/model",
                json!("fishbowl"),
                "data.cameras[0].lens.model: unknown variant `fishbowl`",
            ),
            (
                "/data/cameras/0/lens/width_px",
                json!(-1),
                "data.cameras[0].lens.width_px: invalid value: integer `-1`",
            ),
            (
                "/data/cameras/0/lens",
                json!({"model": "equirectangular", "width": 1}),
                "data.cameras[0].lens.width: unknown field `width`",
            ),
            (
                "/data/cameras/0/lens",
                json!({"model": "equirectangular", "width_px": 1}),
                "data.cameras[0].lens: missing field `height_px`",
            ),
            (
                "/data/cameras/0/lens",
                json!({"width_px": 1}),
                "data.cameras[0].lens: missing field `model`",
            ),
            (
                "/data/cameras/0/frame",
                json!(7),
                "data.cameras[0].frame: invalid type: integer `7`, expected a string",
            ),
        ];
        check(&cases);
    }

    #[test]
    fn a_fault_elsewhere_is_told_with_its_place() {
        let cases = [
            (
                "/data/transforms/0/rotation",
                json!({"rpy_rad": [0, 0]}),
                "data.transforms[0].rotation: invalid length 2",
            ),
            (
                "/data/transforms/0",
                json!({"parent": "base"}),
                "data.transforms[0]: missing field `child`",
            ),
            ("/data/lidars/0/name", json!(null), "data.lidars[0].name: invalid type: null"),
            ("/data/lidars", json!("none"), "data.lidars: invalid type: string \"none\""),
            ("/data/base", json!([]), "data.base: invalid type: sequence"),
            ("/data", json!([1]), "data: invalid type: integer `1`"),
        ];
        check(&cases);
    }
}
