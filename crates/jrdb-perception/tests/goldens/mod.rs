//! Reference outputs that are not in the repository, and the engines to repeat them on.
#![allow(dead_code, reason = "every test file uses a part")]
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]
#![allow(clippy::print_stdout, reason = "tests say what they found and what they skip")]

use std::path::{Path, PathBuf};

use jrdb_perception::{Engine, OrtEngine, OrtLibrary, RtenEngine, Sessions};
use jrdb_types::Image;
use serde_json::Value;

/// A folder of the goldens, or a word that there is none.
pub(crate) fn folder(name: &str) -> Option<PathBuf> {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared");
    let shared = std::env::var_os("JRDB_SHARED").map_or_else(|| beside.into(), PathBuf::from);
    let folder = shared.join("goldens").join(name);
    if !folder.is_dir() {
        println!("skipped: no shared data");
        return None;
    }
    Some(folder)
}

pub(crate) fn text(folder: &Path, file: &str) -> String {
    std::fs::read_to_string(folder.join(file)).unwrap()
}

pub(crate) fn json(folder: &Path, file: &str) -> Value {
    serde_json::from_str(&text(folder, file)).unwrap()
}

pub(crate) fn png(path: &Path) -> Image {
    jrdb_dataset::decode_image(&std::fs::read(path).unwrap()).unwrap()
}

/// An engine of either kind.
#[derive(Debug, Clone)]
pub(crate) enum Kind {
    Rten,
    Ort(OrtLibrary),
}

impl Kind {
    pub(crate) fn open(&self, path: &Path) -> Box<dyn Engine> {
        match self {
            Self::Rten => Box::new(RtenEngine::from_file(path).unwrap()),
            Self::Ort(library) => {
                let sessions = Sessions::PerCall { threads: 1 };
                Box::new(OrtEngine::from_file(library, path, sessions).unwrap())
            }
        }
    }

    pub(crate) fn name(&self) -> &'static str {
        match self {
            Self::Rten => "rten",
            Self::Ort(_) => "onnxruntime",
        }
    }
}

pub(crate) fn ids(value: &Value) -> Vec<u32> {
    value.as_array().unwrap().iter().map(|id| id.as_u64().unwrap() as u32).collect()
}

pub(crate) fn floats(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

/// The greatest difference to the sampled values of a golden tensor, and whether the shape is its own.
pub(crate) fn worst(golden: &Value, shape: &[usize], data: &[f32]) -> f64 {
    let expected: Vec<u64> =
        golden["shape"].as_array().unwrap().iter().map(|n| n.as_u64().unwrap()).collect();
    let found: Vec<u64> = shape.iter().map(|n| *n as u64).collect();
    assert_eq!(found[found.len() - expected.len()..], expected);
    let at = ids(&golden["sample_index"]);
    let values = floats(&golden["sample_value"]);
    let differences = at.iter().zip(values).map(|(i, v)| (f64::from(data[*i as usize]) - v).abs());
    differences.fold(0.0, f64::max)
}
