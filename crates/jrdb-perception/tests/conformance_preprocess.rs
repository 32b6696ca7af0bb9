//! Pictures scaled and normalised against what Pillow and Python's transformers make of them, byte for byte.
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]
#![allow(clippy::print_stdout, reason = "says what was compared, or why nothing was")]

use std::path::{Path, PathBuf};

use jrdb_perception::image::{Filter, Layout, Normalise, Region, Resizer, resize};
use jrdb_types::Image;
use serde_json::Value;
use sha2::{Digest, Sha256};

/// The folder of a model's reference outputs; none without the research data.
fn goldens(model: &str) -> Option<PathBuf> {
    let default = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared");
    let shared = std::env::var_os("JRDB_SHARED").map_or_else(|| default.into(), PathBuf::from);
    let folder = shared.join("goldens").join(model);
    if folder.is_dir() {
        return Some(folder);
    }
    println!("skipped: no shared data");
    None
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

fn picture(folder: &Path, name: &str) -> Image {
    jrdb_dataset::read_image(&folder.join(format!("{name}.png"))).unwrap()
}

fn number(value: &Value) -> usize {
    usize::try_from(value.as_u64().unwrap()).unwrap()
}

/// Compares the bytes of a scaled picture with a digest of the reference's.
fn check_resized(image: &Image, expected: &Value, name: &str) {
    let [width, height] = [0, 1].map(|side| number(&expected["size_wh"][side]));
    let found = resize(image, width, height, Filter::Bicubic);
    assert_eq!(sha256(&found.rgb), expected["sha256_u8_hwc"], "{name} to {width} x {height}");
}

/// The whole picture as a square tensor of channels.
fn tensor(image: &Image, side: usize) -> Vec<f32> {
    let mut tensor = vec![0.0; 3 * side * side];
    let mut resizer = Resizer::new(Filter::Bicubic, side, side);
    let (region, normalise) = (Region::whole(image), Normalise::IMAGENET);
    resizer.tensor(image, region, &normalise, Layout::Chw, &mut tensor);
    tensor
}

fn digest(tensor: &[f32]) -> String {
    sha256(&tensor.iter().flat_map(|number| number.to_le_bytes()).collect::<Vec<_>>())
}

#[test]
fn conformance_florence_takes_the_same_numbers() {
    let Some(folder) = goldens("florence2_tiny") else { return };
    let golden = json(&folder.join("golden_preprocess.json"));
    for (name, expected) in golden.as_object().unwrap() {
        let image = picture(&folder, name);
        for (side, values) in [("192", "pixel_values"), ("768", "pixel_values_768")] {
            check_resized(&image, &expected["resized_u8"][side], name);
            let found = tensor(&image, side.parse().unwrap());
            assert_eq!(digest(&found), expected[values]["sha256_f32_le"], "{name} to {side}");
        }
    }
    println!("{} pictures, each to 192 and 768: equal", golden.as_object().unwrap().len());
}

/// The last tile of a tiling is the whole picture.
#[test]
fn conformance_intern_takes_the_same_numbers_of_whole_pictures() {
    let Some(folder) = goldens("internvl35_tiny") else { return };
    let golden = json(&folder.join("golden_preprocess.json"));
    let mut tilings = 0;
    for (name, expected) in golden.as_object().unwrap() {
        let image = picture(&folder, name);
        let all = expected["tilings"].as_object().unwrap().values();
        for tiling in all.chain([&expected["tile448_max12"]]) {
            check_last_tile(&image, &tiling["pixel_values"], name);
            tilings += 1;
        }
    }
    println!("{tilings} tilings: equal");
}

fn check_last_tile(image: &Image, expected: &Value, name: &str) {
    let [tiles, side] = [0, 2].map(|axis| number(&expected["shape"][axis]));
    let found = tensor(image, side);
    let first = (tiles - 1) * found.len();
    let samples = expected["sample_index"].as_array().unwrap().iter().map(number);
    for (index, value) in samples.zip(expected["sample_value"].as_array().unwrap()) {
        if let Some(at) = index.checked_sub(first) {
            assert_eq!(found[at], value.as_f64().unwrap() as f32, "{name}, {index}");
        }
    }
    if tiles == 1 {
        assert_eq!(digest(&found), expected["sha256_f32_le"], "{name} to {side}");
    }
}

#[test]
fn conformance_qwen_takes_the_same_bytes() {
    let Some(folder) = goldens("qwen25vl_preprocess") else { return };
    let golden = json(&folder.join("golden.json"));
    let pictures = golden["pixels"].as_object().unwrap();
    for (name, expected) in pictures {
        check_resized(&picture(&folder, name), &expected["resized_u8"], name);
    }
    println!("{} pictures: equal", pictures.len());
}

fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}
