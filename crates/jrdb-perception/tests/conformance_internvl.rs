//! InternVL3.5 against the reference implementation, on a tiny model of the same architecture.
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]
#![allow(clippy::print_stdout, reason = "tests say what they found and what they skip")]

mod goldens;
mod onnxruntime;

use std::path::Path;

use goldens::{Kind, floats, ids, json, png, text, worst};
use jrdb_perception::Tensor;
use jrdb_perception::generation::Tokens;
use jrdb_perception::prompts::{phrase_question, yes_no};
use jrdb_perception::vlm::{AttributeConfig, Family, InternVlConfig, Vlm, VlmAttributes, VlmParts};
use serde_json::Value;

const FOLDER: &str = "internvl35_tiny";

fn kinds() -> Vec<Kind> {
    std::iter::once(Kind::Rten).chain(onnxruntime::find().map(Kind::Ort)).collect()
}

fn config(folder: &Path) -> InternVlConfig {
    InternVlConfig::from_json(
        &text(folder, "config.json"),
        &text(folder, "generation_config.json"),
        &text(folder, "preprocessor_config.json"),
    )
    .unwrap()
}

fn model(folder: &Path, config: &InternVlConfig, kind: &Kind) -> Vlm {
    let graph = |name: &str| kind.open(&folder.join("onnx").join(format!("{name}.onnx")));
    let tokens = Tokens::from_json(&text(folder, "tokenizer.json")).unwrap();
    Vlm::new(VlmParts {
        text: config.text.clone(),
        tokens,
        vision_encoder: graph("vision_encoder"),
        embed_tokens: graph("embed_tokens"),
        decoder: graph("decoder_model_merged"),
    })
    .unwrap()
}

/// Ids in which a run of image tokens is told by its length.
fn expanded(compact: &Value, image_token: u32) -> Vec<u32> {
    let one = |entry: &Value| match entry.as_array() {
        Some(run) => vec![image_token; run[1].as_u64().unwrap() as usize],
        None => vec![entry.as_u64().unwrap() as u32],
    };
    compact.as_array().unwrap().iter().flat_map(one).collect()
}

#[test]
fn conformance_internvl_answers_and_scores() {
    let Some(folder) = goldens::folder(FOLDER) else { return };
    let golden = json(&folder, "golden_generate.json");
    let end = golden["eos_token_id"].as_u64().unwrap() as u32;
    let image_token = golden["image_token_id"].as_u64().unwrap() as u32;
    for kind in kinds() {
        let mut config = config(&folder);
        let model = model(&folder, &config, &kind);
        let (mut equal, mut chosen, mut asked, mut all) = (0, 0, 0, 0);
        let (mut step, mut label, mut features): (f64, f64, f64) = (0.0, 0.0, 0.0);
        for case in golden["cases"].as_array().unwrap() {
            let image = png(&folder.join(format!("{}.png", case["image"].as_str().unwrap())));
            let most = case["max_patches"].as_u64().unwrap() as usize;
            config.tiles = [1, most];
            let pixels = config.prepare(&image);
            let question = case["chat_prompt"].as_str().unwrap();
            let question = question.split("<IMG_CONTEXT>\n").nth(1).unwrap();
            let question = question.split("<|im_end|>").next().unwrap();
            let prompt = config.prompt(question, pixels.shape()[0]);
            let prompt = model.tokens().encode(&prompt).unwrap();
            assert_eq!(prompt, expanded(&case["prompt_ids_compact"], image_token));
            let seen = model.see(&[("pixel_values", &pixels)]).unwrap();
            let shape = ids(&case["image_features"]["shape"]);
            let shape: Vec<usize> = shape.iter().map(|n| *n as usize).collect();
            features = features.max(worst(&case["image_features"], &shape, &seen));

            let read = model.read(&prompt, &seen, None).unwrap();
            let scores = case["label_scores"].as_object().unwrap();
            let labels: Vec<Vec<String>> = scores.keys().map(|name| vec![name.clone()]).collect();
            let found = model.score(&read, &labels, end).unwrap();
            let sums: Vec<f64> = found.iter().map(|one| one[0].log_likelihood).collect();
            for (sum, expected) in sums.iter().zip(scores.values()) {
                label = label.max((sum - expected["sum"].as_f64().unwrap()).abs());
            }
            let best = (0..sums.len()).max_by(|a, b| sums[*a].total_cmp(&sums[*b])).unwrap();
            if most == 1 {
                asked += 1;
                chosen +=
                    usize::from(labels[best][0] == case["best_label_by_sum"].as_str().unwrap());
            }

            let written = model.write(read, 12).unwrap();
            all += 1;
            equal += usize::from(written.ids == ids(&case["generated_ids"]));
            let logs = floats(&case["step_logprob"]);
            let pairs = written.log_probs.iter().zip(logs);
            step = pairs.fold(step, |far, (a, b)| far.max((a - b).abs()));
            assert_eq!(
                model.tokens().decode_words(&written.ids).unwrap(),
                case["text"].as_str().unwrap()
            );
        }
        println!(
            "{}: {equal} of {all} answers equal, {chosen} of {asked} labels chosen alike, features within {features:.1e}, \
             steps within {step:.1e}, label log-likelihoods within {label:.1e}",
            kind.name()
        );
        assert_eq!((equal, chosen, all, asked), (all, asked, 20, 16));
        assert!(features < 1e-4 && step < 1e-3 && label < 1e-3);
    }
}

#[test]
fn conformance_internvl_tiles() {
    let Some(folder) = goldens::folder(FOLDER) else { return };
    let golden = json(&folder, "golden_preprocess.json");
    let (mut far, mut tilings): (f64, usize) = (0.0, 0);
    let mut check = |config: &InternVlConfig, name: &str, expected: &Value| {
        let Tensor::F32 { shape, data } = config.prepare(&png(&folder.join(format!("{name}.png"))))
        else {
            panic!("pixels are numbers")
        };
        assert_eq!(shape[0] as u64, expected["num_tiles_incl_thumbnail"].as_u64().unwrap());
        far = far.max(worst(&expected["pixel_values"], &shape, &data));
        tilings += 1;
    };
    for (name, expected) in golden.as_object().unwrap() {
        for (most, tiling) in expected["tilings"].as_object().unwrap() {
            let tiles = [1, most.parse().unwrap()];
            check(&InternVlConfig { tiles, ..config(&folder) }, name, tiling);
        }
        let mut large = InternVlConfig { tiles: [1, 12], ..config(&folder) };
        (large.picture.size.width, large.picture.size.height) = (448, 448);
        check(&large, name, &expected["tile448_max12"]);
    }
    println!("{tilings} tilings, pixels within {far:.1e}");
    assert!(far < 1e-5);
}

/// The framework's own numbers, made by `tools/export/yes_no_golden.py`.
const YES_NO: &str = include_str!("data/internvl_yes_no.json");

#[test]
fn conformance_internvl_yes_no() {
    let Some(folder) = goldens::folder(FOLDER) else { return };
    let cases: Vec<Value> = serde_json::from_str(YES_NO).unwrap();
    for kind in kinds() {
        let config = config(&folder);
        let (image_token, model) = (config.text.image_token, model(&folder, &config, &kind));
        let family = Family::InternVl(config.clone());
        let asked = VlmAttributes::new(model, family, AttributeConfig::default()).unwrap();
        let tokens = Tokens::from_json(&text(&folder, "tokenizer.json")).unwrap();
        let mut far: f64 = 0.0;
        for of_picture in cases.chunk_by(|a, b| a["image"] == b["image"]) {
            let name = of_picture[0]["image"].as_str().unwrap();
            let question = |case: &Value| {
                let [phrase, category] = ["phrase", "category"].map(|key| case[key].as_str());
                phrase_question(phrase.unwrap(), category.unwrap())
            };
            let questions: Vec<String> = of_picture.iter().map(question).collect();
            let picture = png(&folder.join(format!("{name}.png")));
            let scores = asked.weigh_yes_no(&picture, &questions).unwrap();
            for ((case, score), question) in of_picture.iter().zip(&scores).zip(&questions) {
                let prompt = tokens.encode(&config.prompt(question, 1)).unwrap();
                assert_eq!(prompt, expanded(&case["prompt"], image_token));
                for (spelling, score) in yes_no().concat().iter().zip(score.concat()) {
                    let expected = case["log_likelihoods"][spelling].as_f64().unwrap();
                    far = far.max((score.log_likelihood - expected).abs());
                }
            }
        }
        println!("{}: log-likelihoods of yes and no within {far:.1e}", kind.name());
        assert!(cases.len() >= 16 && far < 1e-3);
    }
}
