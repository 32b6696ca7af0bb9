//! Counts of parameters against a count by Python's `onnx` package, which loads every tensor and
//! compares all of its bytes.
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]

use std::fs::File;
use std::path::{Path, PathBuf};

use jrdb_perception::{Parameters, count_parameters};

/// A folder, its graphs with the parameters of each, and the parameters of all together.
type Facts = (&'static str, &'static [(&'static str, u64)], u64);

/// In the research data.
const SHARED: [Facts; 4] = [
    (
        "models",
        &[
            ("age-v1.onnx", 2_689_617),
            ("blazepose-heavy.f16.onnx", 13_751_071),
            ("blazepose-lite.f16.onnx", 1_363_087),
            ("centerface-480.onnx", 1_820_142),
            ("gender-v1.onnx", 131_538),
            ("nanodet-g-416-coco.f16.onnx", 3_786_068),
            ("ssdlite-mbv2-300-person.f16.onnx", 3_021_094),
        ],
        26_562_617,
    ),
    (
        "goldens/florence2_tiny/onnx",
        &[
            ("decoder_model.onnx", 258_816),
            ("decoder_model_merged.onnx", 258_816),
            ("decoder_with_past_model.onnx", 242_176),
            ("embed_tokens.onnx", 92_544),
            ("encoder_model.onnx", 132_736),
            ("vision_encoder.onnx", 174_928),
        ],
        568_784,
    ),
    (
        "goldens/internvl35_tiny/onnx",
        &[
            ("decoder_model_merged.onnx", 100_552),
            ("embed_tokens.onnx", 26_432),
            ("vision_encoder.onnx", 50_016),
        ],
        150_568,
    ),
    ("goldens/mm_grounding_dino_tiny/onnx", &[("model.onnx", 501_515)], 501_515),
];

/// In the repository.
const DEMO: [Facts; 2] = [
    (
        "demo/florence2/onnx",
        &[
            ("decoder_model.onnx", 378_144),
            ("decoder_with_past_model.onnx", 340_896),
            ("embed_tokens.onnx", 128_736),
            ("encoder_model.onnx", 99_744),
            ("vision_encoder.onnx", 457_184),
        ],
        935_072,
    ),
    (
        "demo/internvl35/onnx",
        &[
            ("decoder_model_merged.onnx", 103_752),
            ("embed_tokens.onnx", 29_632),
            ("vision_encoder.onnx", 392_352),
        ],
        496_104,
    ),
];

fn count(path: &Path) -> Parameters {
    let file = File::open(path).unwrap();
    let bytes = file.metadata().unwrap().len();
    count_parameters(file, bytes).unwrap()
}

fn check(root: &Path, (folder, graphs, together): Facts) {
    let counted = graphs.iter().map(|(name, expected)| {
        let parameters = count(&root.join(folder).join(name));
        assert_eq!(parameters.count(), *expected, "{folder}/{name}");
        parameters
    });
    let counted: Vec<Parameters> = counted.collect();
    assert_eq!(Parameters::union(&counted).count(), together, "{folder}");
}

#[test]
fn conformance_parameters_of_the_shared_models() {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared");
    let shared = std::env::var_os("JRDB_SHARED").map_or_else(|| beside.into(), PathBuf::from);
    if !shared.join("models").is_dir() {
        println!("skipped: no shared data");
        return;
    }
    SHARED.iter().for_each(|facts| check(&shared, *facts));
}

#[test]
fn parameters_of_the_demo_are_those_of_an_independent_count() {
    let models = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../models"));
    DEMO.iter().for_each(|facts| check(models, *facts));
}
