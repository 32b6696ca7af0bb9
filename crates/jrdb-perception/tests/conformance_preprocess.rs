//! Pictures scaled and normalised against what Pillow and Python's transformers make of them, byte for byte.
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]
#![allow(clippy::print_stdout, reason = "says what was compared, or why nothing was")]

use std::path::{Path, PathBuf};

use jrdb_perception::resize::{Filter, Region, Resizer, resize};
use jrdb_perception::tensor::{Layout, Normalise};
use jrdb_types::Image;
use serde_json::Value;

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

/// SHA-256 (FIPS 180-4), in hexadecimal.
fn sha256(bytes: &[u8]) -> String {
    let primes = || (2_u32..).filter(|n| (2..*n).take_while(|d| d * d <= *n).all(|d| n % d != 0));
    let fraction = |root: f64| (root.fract() * 2_f64.powi(32)) as u32;
    let mut state: Vec<u32> = primes().take(8).map(|p| fraction(f64::from(p).sqrt())).collect();
    let constants: Vec<u32> = primes().take(64).map(|p| fraction(f64::from(p).cbrt())).collect();
    let mut padded = [bytes, &[0x80]].concat();
    // The length, in bits, takes the last 8 bytes.
    padded.resize((padded.len() + 8).next_multiple_of(64), 0);
    let end = padded.len() - 8;
    padded[end..].copy_from_slice(&(bytes.len() as u64 * 8).to_be_bytes());
    for block in padded.as_chunks::<64>().0 {
        let mut words: Vec<u32> =
            block.as_chunks().0.iter().map(|w| u32::from_be_bytes(*w)).collect();
        for at in 16..64 {
            let (a, b) = (words[at - 15], words[at - 2]);
            let small = a.rotate_right(7) ^ a.rotate_right(18) ^ (a >> 3);
            let large = b.rotate_right(17) ^ b.rotate_right(19) ^ (b >> 10);
            words.push(
                words[at - 16].wrapping_add(small).wrapping_add(words[at - 7]).wrapping_add(large),
            );
        }
        let mut s = state.clone();
        for (word, constant) in words.iter().zip(&constants) {
            let choice = (s[4] & s[5]) ^ (!s[4] & s[6]);
            let majority = (s[0] & s[1]) ^ (s[0] & s[2]) ^ (s[1] & s[2]);
            let large = s[4].rotate_right(6) ^ s[4].rotate_right(11) ^ s[4].rotate_right(25);
            let small = s[0].rotate_right(2) ^ s[0].rotate_right(13) ^ s[0].rotate_right(22);
            let parts = [s[7], large, choice, *constant, *word];
            let first = parts.into_iter().fold(0, u32::wrapping_add);
            s[3] = s[3].wrapping_add(first);
            s[7] = first.wrapping_add(small).wrapping_add(majority);
            s.rotate_right(1);
        }
        state.iter_mut().zip(s).for_each(|(sum, part)| *sum = sum.wrapping_add(part));
    }
    state.iter().map(|word| format!("{word:08x}")).collect()
}

#[test]
fn digests_are_those_of_the_standard() {
    let of_abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
    assert_eq!(sha256(b"abc"), of_abc);
    let of_nothing = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";
    assert_eq!(sha256(b""), of_nothing);
    let of_two_blocks = "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1";
    assert_eq!(sha256(b"abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"), of_two_blocks);
}
