//! Artefacts of earlier versions, brought to the present one.

use jrdb_types::{
    Answer, Artefact, ArtefactError, Comparison, Detections, Entities, Payload, Query, Questions,
    Rig, SceneGraph, Scores,
};
use serde_json::{Value, json};

/// What became of an artefact.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Migrated {
    /// It is of the present version.
    Present,
    /// It was brought to the present version: the new text.
    Changed(String),
}

/// Why an artefact cannot be brought to the present version.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MigrateError {
    /// The text is not an artefact.
    #[error("expected an artefact: JSON with schema, schema_version and data")]
    NoArtefact(#[source] serde_json::Error),
    /// No artefact has this name.
    #[error("expected one of {}, found {found:?}", known().join(", "))]
    Unknown {
        /// The name in the text.
        found: String,
    },
    /// The artefact is of a version that this program does not know yet.
    #[error(
        "expected {schema} version {present} or earlier, found version {found}: use the program that wrote it, or a newer one"
    )]
    Newer {
        /// Name of the artefact.
        schema: &'static str,
        /// Version that this program writes.
        present: u32,
        /// Version in the text.
        found: u64,
    },
    /// An earlier version lacks what the present one needs.
    #[error(
        "{schema} version {found} lacks what version {present} needs: make it again with `{command}`"
    )]
    Lacks {
        /// Name of the artefact.
        schema: &'static str,
        /// Version in the text.
        found: u64,
        /// Version that this program writes.
        present: u32,
        /// The command that makes it.
        command: String,
    },
    /// The artefact is not what its version promises.
    #[error("not a well-formed artefact of its version")]
    Malformed(#[source] ArtefactError),
}

/// A step from one version to the next; nothing when the earlier one lacks what the next needs.
type Step = fn(&Value) -> Option<Value>;

/// A kind of artefact.
struct Kind {
    schema: &'static str,
    present: u32,
    /// Steps by the version that they start from.
    steps: &'static [(u64, Step)],
    check: fn(&str) -> Result<(), ArtefactError>,
    /// The command that makes it, with the question of its data for `{}`.
    command: &'static str,
}

fn kind<T: Payload>(steps: &'static [(u64, Step)], command: &'static str) -> Kind {
    let check = |text: &str| Artefact::<T>::from_json(text).map(|_| ());
    Kind { schema: T::SCHEMA, present: T::VERSION, steps, check, command }
}

fn kinds() -> [Kind; 9] {
    [
        kind::<Rig>(&[(1, tree_of_frames)], "jrdb rig jrdb CALIBRATION --out rig.json"),
        kind::<Detections>(&[], "jrdb perceive --out detections.json"),
        kind::<Entities>(&[], "jrdb project --detections detections.json --dataset ROOT"),
        kind::<SceneGraph>(&[(1, unchanged)], "jrdb graph --entities entities.json"),
        kind::<Query>(&[(2, without_dropped_words), (3, unchanged)], "jrdb parse {}"),
        kind::<Answer>(&[(3, unchanged)], "jrdb search --graph scene_graph.json --text {}"),
        kind::<Questions>(&[], "jrdb synth --out SCENE"),
        // Version 1 had no judgements, and they need the boxes.
        kind::<Scores>(&[], "jrdb evaluate --answers answer.json --questions questions.json"),
        kind::<Comparison>(&[], "jrdb compare A B"),
    ]
}

fn known() -> Vec<&'static str> {
    kinds().iter().map(|kind| kind.schema).collect()
}

/// Brings an artefact to the present version.
///
/// # Errors
/// [`MigrateError`]; [`MigrateError::Lacks`] names the command that makes the artefact again.
pub fn migrate(text: &str) -> Result<Migrated, MigrateError> {
    let mut artefact: Value = serde_json::from_str(text).map_err(MigrateError::NoArtefact)?;
    let name = artefact["schema"].as_str().unwrap_or_default().to_owned();
    let kinds = kinds();
    let kind = kinds.iter().find(|kind| kind.schema == name);
    let kind = kind.ok_or(MigrateError::Unknown { found: name })?;
    let (schema, present) = (kind.schema, kind.present);
    let found = artefact["schema_version"].as_u64().unwrap_or_default();
    if found > u64::from(present) {
        return Err(MigrateError::Newer { schema, present, found });
    }
    for version in found..u64::from(present) {
        let step = kind.steps.iter().find(|(from, _)| *from == version);
        let data = step.and_then(|(_, step)| step(&artefact["data"]));
        let Some(data) = data else {
            let command = command(kind, text);
            return Err(MigrateError::Lacks { schema, found, present, command });
        };
        artefact["data"] = data;
        artefact["schema_version"] = json!(version + 1);
    }
    let mut written = serde_json::to_string_pretty(&artefact).unwrap_or_default();
    written.push('\n');
    (kind.check)(&written).map_err(MigrateError::Malformed)?;
    Ok(if found == u64::from(present) { Migrated::Present } else { Migrated::Changed(written) })
}

/// The command that makes an artefact again, with its own question.
fn command(kind: &Kind, text: &str) -> String {
    let artefact: Value = serde_json::from_str(text).unwrap_or_default();
    let data = &artefact["data"];
    let question = data["text"].as_str().or_else(|| data["question"].as_str());
    kind.command.replace("{}", &format!("{:?}", question.unwrap_or("QUESTION")))
}

/// Version 2 of a query dropped the words that were not understood; version 3 keeps them as conditions.
fn without_dropped_words(data: &Value) -> Option<Value> {
    const DROPPED: [&str; 3] = ["unknown_word", "misplaced_word", "not_in_graph"];
    let issues = data["issues"].as_array().map(Vec::as_slice).unwrap_or_default();
    let is_dropped = |issue: &Value| issue["kind"].as_str().is_some_and(|k| DROPPED.contains(&k));
    (!issues.iter().any(is_dropped)).then(|| data.clone())
}

/// Fields were added only.
fn unchanged(data: &Value) -> Option<Value> {
    Some(data.clone())
}

/// Version 1 of a rig had one panorama around the base's origin and LiDARs with an offset that is subtracted; version 2
/// is a tree of frames.
fn tree_of_frames(rig: &Value) -> Option<Value> {
    let mut lens = rig.get("panorama")?.clone();
    lens["model"] = json!("cylindrical");
    let forward = json!([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]);
    let mut transforms =
        vec![json!({ "parent": "base", "child": "panorama", "rotation": { "matrix": forward } })];
    let mut lidars = Vec::new();
    for lidar in rig.get("lidars")?.as_array()? {
        let (name, yaw_rad) = (lidar.get("name")?.as_str()?, lidar.get("yaw_rad")?.as_f64()?);
        let offset: Vec<f64> =
            lidar.get("offset_m")?.as_array()?.iter().map_while(Value::as_f64).collect();
        let [x, y, z] = offset[..] else { return None };
        let (sin, cos) = yaw_rad.sin_cos();
        let translation_m = [0.0 - (cos * x - sin * y), 0.0 - (sin * x + cos * y), 0.0 - z];
        transforms.push(json!({
            "parent": "base", "child": name, "translation_m": translation_m,
            "rotation": { "rpy_rad": [0.0, 0.0, yaw_rad] },
        }));
        lidars.push(json!({ "name": name, "frame": name }));
    }
    let camera = json!({ "name": "panorama", "frame": "panorama", "lens": lens });
    Some(json!({ "base": "base", "transforms": transforms, "cameras": [camera], "lidars": lidars }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn artefact(schema: &str, version: u32, data: &Value) -> String {
        let producer = json!({ "name": "jrdb", "version": "0.1.0" });
        json!({
            "schema": schema, "schema_version": version, "producer": producer, "config": {}, "data": data,
        })
        .to_string()
    }

    #[test]
    fn a_rig_of_version_1_becomes_a_tree() {
        let panorama =
            json!({ "width_px": 3760, "height_px": 480, "focal_px": 482.9, "horizon_px": 209.4 });
        let lidar = json!({ "name": "upper", "offset_m": [0.0, 0.0, -0.3], "yaw_rad": 0.085 });
        let rig = json!({ "panorama": panorama, "lidars": [lidar] });
        let Migrated::Changed(text) = migrate(&artefact("jrdb.rig", 1, &rig)).unwrap() else {
            unreachable!("version 1 is not the present one");
        };
        let rig = Artefact::<Rig>::from_json(&text).unwrap().data;
        assert_eq!(rig.transforms[1].translation_m, [0.0, 0.0, 0.3]);
        assert!(rig.cameras[0].lens.image().wraps);
        assert_eq!(migrate(&text).unwrap(), Migrated::Present);
    }

    #[test]
    fn a_query_that_dropped_words_is_read_again_and_others_are_kept() {
        let query = |issues: Value| {
            let target = json!({ "category": "person", "conditions": [] });
            let data =
                json!({ "text": "the nurse", "task": "find", "target": target, "issues": issues });
            migrate(&artefact("jrdb.query", 2, &data))
        };
        assert!(matches!(query(json!([])).unwrap(), Migrated::Changed(_)));
        let dropped = json!([{ "kind": "unknown_word", "message": "nurse" }]);
        let error = query(dropped).unwrap_err().to_string();
        assert!(error.ends_with("make it again with `jrdb parse \"the nurse\"`"), "{error}");
    }

    #[test]
    fn what_lacks_numbers_names_the_command_that_makes_it() {
        let error = |schema: &str, version, data: Value| {
            migrate(&artefact(schema, version, &data)).unwrap_err().to_string()
        };
        let query = error("jrdb.query", 1, json!({ "text": "who is near me?" }));
        assert!(query.ends_with("make it again with `jrdb parse \"who is near me?\"`"), "{query}");
        assert!(error("jrdb.entities", 1, json!({})).contains("jrdb project"));
        assert!(error("jrdb.scores", 1, json!({})).contains("again with `jrdb evaluate --answers"));
        assert!(error("jrdb.answer", 99, json!({})).contains("or earlier, found version 99"));
        assert!(error("jrdb.dreams", 1, json!({})).contains("found \"jrdb.dreams\""));
        assert!(migrate("{").is_err() && migrate("[]").is_err());
    }
}
