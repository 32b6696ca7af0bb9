//! Qwen2.5-VL's preprocessing and token places against the reference implementation.
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]
#![allow(clippy::print_stdout, reason = "tests say what they found and what they skip")]

mod goldens;

use goldens::{ids, json, png, worst};
use jrdb_perception::Tensor;
use jrdb_perception::vlm::{Position, Qwen25VlConfig};
use serde_json::Value;

/// A model's files with the numbers of the published ones that matter here.
fn config(image_token: u64, pixels: [u64; 2]) -> Qwen25VlConfig {
    let model = format!(
        r#"{{"image_token_id": {image_token}, "hidden_size": 2048, "num_attention_heads": 16, "num_key_value_heads": 2}}"#
    );
    let picture = format!(
        r#"{{"min_pixels": {}, "max_pixels": {}, "patch_size": 14, "merge_size": 2, "temporal_patch_size": 2,
            "image_mean": [0.48145466, 0.4578275, 0.40821073], "image_std": [0.26862954, 0.26130258, 0.27577711]}}"#,
        pixels[0], pixels[1]
    );
    Qwen25VlConfig::from_json(&model, r#"{"eos_token_id": [151645, 151643]}"#, &picture).unwrap()
}

fn number(value: &Value) -> u64 {
    value.as_u64().unwrap()
}

#[test]
fn conformance_qwen25vl_sizes_patches_and_places() {
    let Some(folder) = goldens::folder("qwen25vl_preprocess") else { return };
    let golden = json(&folder, "golden.json");
    let sizes = golden["smart_resize"].as_array().unwrap();
    for case in sizes {
        let config = config(50, [number(&case["min_pixels"]), number(&case["max_pixels"])]);
        let size = ids(&case["wh"]);
        let found = config.resized([size[0] as usize, size[1] as usize]);
        match case.get("resized_wh") {
            Some(expected) => {
                let found = found.unwrap();
                assert_eq!(found.map(|n| n as u32).to_vec(), ids(expected), "{case}");
                assert_eq!((found[0] / 28 * (found[1] / 28)) as u64, number(&case["image_tokens"]));
            }
            None => assert!(found.is_err(), "{case}"),
        }
    }
    let mut far: f64 = 0.0;
    let pictures = golden["pixels"].as_object().unwrap();
    for (name, expected) in pictures {
        let patches =
            config(50, [3136, 12_845_056]).prepare(&png(&folder.join(format!("{name}.png"))));
        let patches = patches.unwrap();
        let Tensor::I64 { data: grid, .. } = &patches.grid else { panic!("a grid is of integers") };
        assert_eq!(
            grid.iter().map(|n| *n as u32).collect::<Vec<_>>(),
            ids(&expected["image_grid_thw"])
        );
        let Tensor::F32 { shape, data } = &patches.pixels else { panic!("pixels are numbers") };
        far = far.max(worst(&expected["pixel_values"], shape, data));
    }
    let places = golden["mrope"].as_array().unwrap();
    for case in places {
        let config = config(number(&case["special"]["image"]), [3136, 12_845_056]);
        let grid = ids(&case["image_grid_thw"]);
        let prompt = ids(&case["input_ids"]);
        let found = config.places(&prompt, [grid[1] as usize / 2, grid[2] as usize / 2]);
        let axes = case["position_ids_t_h_w"].as_array().unwrap();
        for (axis, expected) in axes.iter().enumerate() {
            let along: Vec<u32> = found.iter().map(|place: &Position| place[axis] as u32).collect();
            assert_eq!(along, ids(expected));
        }
        let next = found.iter().flatten().max().unwrap() + 1;
        assert_eq!(next - prompt.len() as i64, case["rope_delta"].as_i64().unwrap());
    }
    println!(
        "{} of {0} sizes, {} of {1} pictures within {far:.1e}, places of {} of {2} prompts",
        sizes.len(),
        pictures.len(),
        places.len()
    );
    assert_eq!((sizes.len(), pictures.len(), places.len()), (33, 3, 3));
    assert!(far < 1e-5);
}
