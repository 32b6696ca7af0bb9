//! MM-Grounding-DINO against the reference implementation, on a tiny model of the same architecture.
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]
#![allow(clippy::print_stdout, reason = "tests say what they found and what they skip")]

mod goldens;
mod onnxruntime;

use goldens::{Kind, floats, ids, json, png, text, worst};
use jrdb_perception::Tensor;
use jrdb_perception::generation::Tokens;
use jrdb_perception::grounding_dino::{CanvasConfig, Grounded, GroundingConfig, GroundingDino};
use serde_json::Value;

const FOLDER: &str = "mm_grounding_dino_tiny";

/// Whether labels, scores and boxes are the reference's.
fn is_told(found: &[Grounded], post: &Value) -> bool {
    let labels: Vec<&str> = post["text_labels"]
        .as_array()
        .unwrap()
        .iter()
        .map(|label| label.as_str().unwrap())
        .collect();
    let boxes: Vec<Vec<f64>> = post["boxes"].as_array().unwrap().iter().map(floats).collect();
    let near = |(a, b): (&f64, &f64)| (a - b).abs() < 0.02;
    let same_box =
        |(one, corners): (&Grounded, &Vec<f64>)| one.corners.iter().zip(corners).all(near);
    let scores = floats(&post["scores"]);
    found.iter().map(|one| one.tokens.as_str()).eq(labels)
        && found.iter().zip(&scores).all(|(a, b)| (a.score - b).abs() < 1e-4)
        && found.len() == boxes.len()
        && found.iter().zip(&boxes).all(same_box)
}

#[test]
fn conformance_grounding_dino_boxes_and_phrases() {
    let Some(folder) = goldens::folder(FOLDER) else { return };
    let golden = json(&folder, "golden.json");
    let canvas = CanvasConfig::from_json(&text(&folder, "preprocessor_config.json")).unwrap();
    let kinds = std::iter::once(Kind::Rten).chain(onnxruntime::find().map(Kind::Ort));
    for kind in kinds {
        let tokens = Tokens::from_json(&text(&folder, "tokenizer.json")).unwrap();
        let engine = kind.open(&folder.join("onnx/model.onnx"));
        let model = GroundingDino::new(engine, tokens, canvas.clone()).unwrap();
        let (mut right, mut pixels, mut logits, mut boxes) = (0, 0.0_f64, 0.0_f64, 0.0_f64);
        let cases = golden["cases"].as_array().unwrap();
        for case in cases {
            let image = png(&folder.join(format!("{}.png", case["image"].as_str().unwrap())));
            let prompt = model.spell(case["prompt"].as_str().unwrap()).unwrap();
            assert_eq!(prompt, ids(&case["input_ids"]));
            let prepared = canvas.prepare(&image);
            let Tensor::F32 { shape, data } = &prepared.pixels else {
                panic!("pixels are numbers")
            };
            pixels = pixels.max(worst(&case["pixel_values"], shape, data));
            assert_eq!(prepared.size_px.map(|n| n as u32).to_vec(), ids(&case["resized_wh"]));

            let output = model.look(&image, &prompt).unwrap();
            let rows = output.logits.chunks(output.columns).flat_map(|row| &row[..prompt.len()]);
            let finite: Vec<f32> = rows.copied().collect();
            logits = logits.max(worst(
                &case["logits_finite"],
                &[output.boxes.len(), prompt.len()],
                &finite,
            ));
            let flat = output.boxes.as_flattened();
            boxes = boxes.max(worst(&case["pred_boxes"], &[output.boxes.len(), 4], flat));

            let config = GroundingConfig {
                threshold: case["threshold"].as_f64().unwrap(),
                text_threshold: case["text_threshold"].as_f64().unwrap(),
            };
            let size_px = [image.width as f64, image.height as f64];
            let found = model.grounded(&output, &prompt, size_px, &config).unwrap();
            right += usize::from(is_told(&found, &case["post"]));
        }
        println!(
            "{}: {right} of {} cases, pixels within {pixels:.1e}, logits within {logits:.1e}, boxes within {boxes:.1e}",
            kind.name(),
            cases.len()
        );
        assert_eq!((right, cases.len()), (15, 15));
        assert!(pixels < 1e-5 && logits < 1e-3 && boxes < 1e-4);
    }
}

#[test]
fn conformance_grounding_dino_sizes() {
    let Some(folder) = goldens::folder(FOLDER) else { return };
    let golden = json(&folder, "golden.json");
    let sizes = golden["resize_wh"].as_object().unwrap();
    for (name, expected) in sizes {
        let (width, height) = name.split_once('x').unwrap();
        let size = [width.parse().unwrap(), height.parse().unwrap()];
        let found = CanvasConfig::resized(size, 800, 1333).map(|n| n as u32);
        assert_eq!(found.to_vec(), ids(&expected["800/1333"]), "{name}");
    }
    println!("{} of {0} sizes", sizes.len());
}
