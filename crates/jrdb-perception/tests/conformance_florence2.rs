//! Florence-2 against the reference implementation, on a tiny model of the same architecture.
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]
#![allow(clippy::print_stdout, reason = "tests say what they found and what they skip")]

mod goldens;
mod onnxruntime;

use std::path::Path;

use goldens::{Kind, floats, ids, json, png, text, worst};
use jrdb_perception::Tensor;
use jrdb_perception::florence2::{
    Answer, DecoderParts, Florence2, Florence2Config, Florence2Parts, Grammar, Labelled,
    LocationBox, Reply, Task,
};
use jrdb_perception::generation::{DecodeConfig, EndTokens, Tokens};
use serde_json::{Value, json};

const FOLDER: &str = "florence2_tiny";

fn kinds() -> Vec<Kind> {
    std::iter::once(Kind::Rten).chain(onnxruntime::find().map(Kind::Ort)).collect()
}

fn model(folder: &Path, kind: &Kind, is_merged: bool) -> Florence2 {
    let graph = |name: &str| kind.open(&folder.join("onnx").join(format!("{name}.onnx")));
    let config = Florence2Config::from_json(
        &text(folder, "config.json"),
        &text(folder, "generation_config.json"),
        &text(folder, "preprocessor_config.json"),
        Some(&text(folder, "processor_config.json")),
    );
    let decoder = if is_merged {
        DecoderParts::Merged(graph("decoder_model_merged"))
    } else {
        let (first, next) = (graph("decoder_model"), graph("decoder_with_past_model"));
        DecoderParts::Split { first, next }
    };
    Florence2::new(Florence2Parts {
        config: config.unwrap(),
        tokens: Tokens::from_json(&text(folder, "tokenizer.json")).unwrap(),
        vision_encoder: graph("vision_encoder"),
        embed_tokens: graph("embed_tokens"),
        encoder: graph("encoder_model"),
        decoder,
    })
    .unwrap()
}

fn decode_config(mode: &Value) -> DecodeConfig {
    let config: DecodeConfig = serde_json::from_value(mode.clone()).unwrap();
    DecodeConfig { eos_token_id: EndTokens::One(2), ..config }
}

/// An answer as the reference writes it: coordinates cut to whole pixels.
fn as_reference(answer: &Answer, grammar: Grammar) -> Value {
    fn labels<T>(found: &[Labelled<T>]) -> Vec<String> {
        found.iter().map(|one| one.label.clone()).collect()
    }
    let cut = |places: &[f64]| places.iter().map(|px| *px as i64).collect::<Vec<_>>();
    match answer {
        Answer::Text(text) => json!(text),
        Answer::Quads(found) => {
            let places: Vec<_> = found.iter().map(|one| cut(&one.place)).collect();
            json!({ "quad_boxes": places, "labels": labels(found) })
        }
        Answer::Boxes(found) => {
            let places: Vec<_> = found.iter().map(|one| cut(&one.place)).collect();
            if grammar == Grammar::BoxesOrPolygons {
                return json!({ "bboxes": places, "bboxes_labels": labels(found),
                    "polygons": [], "polygons_labels": [] });
            }
            json!({ "bboxes": places, "labels": labels(found) })
        }
        Answer::Polygons(found) => {
            let polygons = |one: &Labelled<Vec<Vec<f64>>>| -> Vec<Vec<i64>> {
                one.place.iter().map(|polygon| cut(polygon)).collect()
            };
            let places: Vec<_> = found.iter().map(polygons).collect();
            if grammar == Grammar::BoxesOrPolygons {
                return json!({ "bboxes": [], "bboxes_labels": [],
                    "polygons": places, "polygons_labels": labels(found) });
            }
            json!({ "polygons": places, "labels": labels(found) })
        }
    }
}

#[test]
fn conformance_florence2_generations() {
    let Some(folder) = goldens::folder(FOLDER) else { return };
    let golden = json(&folder, "golden_generate.json");
    let modes = golden["modes"].as_object().unwrap();
    for kind in kinds() {
        for is_merged in [false, true] {
            let model = model(&folder, &kind, is_merged);
            let (mut equal, mut all, mut reproduced, mut trained) = (0, 0, 0, 0);
            let mut far: f64 = 0.0;
            for case in golden["cases"].as_array().unwrap() {
                let tag = case["prompt"].as_str().unwrap();
                let task = Task::from_tag(tag).unwrap();
                assert_eq!(task.prompt(), case["constructed_prompt"].as_str().unwrap());
                let prompt = model.tokens().encode_input(&task.prompt()).unwrap();
                assert_eq!(prompt, ids(&case["prompt_ids"]));
                let image = png(&folder.join(format!("{}.png", case["image"].as_str().unwrap())));
                let size_px = [image.width as f64, image.height as f64];
                let seen = model.see(&model.config().picture.prepare(&image)).unwrap();
                for (name, mode) in modes {
                    let (config, expected) = (decode_config(mode), &case["modes"][name]);
                    let sequence = model.answer(&seen, &prompt, &config).unwrap();
                    let text = model.tokens().decode(&sequence.ids).unwrap();
                    let reply = Reply { sequence, text };
                    let mut wanted = ids(&expected["ids"]);
                    while wanted.last() == Some(&1) {
                        wanted.pop();
                    }
                    all += 1;
                    equal += usize::from(reply.sequence.ids == wanted);
                    if let Some(score) = expected["sequence_score"].as_f64() {
                        far = far.max((reply.sequence.score - score).abs());
                    } else {
                        let logs = floats(&expected["step_logprob"]);
                        let pairs = reply.sequence.log_probs.iter().zip(logs);
                        far = pairs.fold(far, |far, (a, b)| far.max((a - b).abs()));
                    }
                    let answer = model.read(&reply, &task, size_px);
                    let parsed = &expected["parsed"].as_object().unwrap().values().next().unwrap();
                    assert_eq!(&&as_reference(&answer, task.grammar()), parsed, "{tag} {name}");
                    if let ("greedy_plain", Some(answer)) =
                        (name.as_str(), case["trained_answer"].as_str())
                    {
                        trained += 1;
                        reproduced += usize::from(reply.text.contains(answer));
                    }
                }
            }
            let layout = if is_merged { "merged" } else { "split" };
            println!(
                "{} {layout}: {equal} of {all} generations equal, log-probabilities within {far:.1e}, {reproduced} of {trained} trained answers",
                kind.name()
            );
            assert_eq!((equal, reproduced), (all, trained));
            assert_eq!((all, trained), (80, 14));
            assert!(far < 1e-3);
        }
    }
}

#[test]
fn conformance_florence2_pictures_and_features() {
    let Some(folder) = goldens::folder(FOLDER) else { return };
    let golden = json(&folder, "golden_preprocess.json");
    for kind in kinds() {
        let model = model(&folder, &kind, false);
        let (mut pixels, mut features): (f64, f64) = (0.0, 0.0);
        for (name, expected) in golden.as_object().unwrap() {
            let image = png(&folder.join(format!("{name}.png")));
            let mut picture = model.config().picture.clone();
            let prepared = picture.prepare(&image);
            let side = picture.size.width;
            pixels = pixels.max(worst(&expected["pixel_values"], &[3, side, side], &prepared));
            let Tensor::F32 { shape, data } = model.see(&prepared).unwrap() else { panic!() };
            features = features.max(worst(&expected["image_features"], &shape, &data));
            (picture.size.width, picture.size.height) = (768, 768);
            let large = picture.prepare(&image);
            pixels = pixels.max(worst(&expected["pixel_values_768"], &[3, 768, 768], &large));
        }
        println!("{}: pixels within {pixels:.1e}, features within {features:.1e}", kind.name());
        assert!(pixels < 1e-5 && features < 1e-4);
    }
}

#[test]
fn conformance_florence2_answers() {
    let Some(folder) = goldens::folder(FOLDER) else { return };
    let golden = json(&folder, "golden_parse.json");
    let generate = json(&folder, "golden_generate.json");
    let banned: Vec<String> =
        serde_json::from_value(generate["banned_grounding_tokens"].clone()).unwrap();
    let cases = golden["parse"].as_array().unwrap();
    for case in cases {
        let tag = case["task"].as_str().unwrap();
        let input = if tag.contains("REGION_TO") { "<loc_0><loc_0><loc_1><loc_1>" } else { "x" };
        let task = Task::from_tag(tag).or_else(|| Task::from_tag(&format!("{tag}{input}")));
        let grammar = task.unwrap().grammar();
        let size = floats(&case["image_size_wh"]);
        let answer = grammar.read(case["text"].as_str().unwrap(), [size[0], size[1]], &banned);
        assert_eq!(as_reference(&answer, grammar), case["parsed"], "{case}");
    }
    let quantised = golden["quantize"].as_array().unwrap();
    for case in quantised {
        let (size, corners) = (floats(&case["size_wh"]), floats(&case["box"]));
        let corners = [corners[0], corners[1], corners[2], corners[3]];
        let region = LocationBox::from_corners(corners, [size[0], size[1]]);
        assert_eq!(region.0.map(u32::from).to_vec(), ids(&case["bins"]));
    }
    println!("{} of {0} answers read, {} of {1} boxes quantised", cases.len(), quantised.len());
}

#[test]
fn conformance_florence2_log_probabilities_are_those_of_teacher_forcing() {
    let Some(folder) = goldens::folder(FOLDER) else { return };
    let model = model(&folder, &Kind::Rten, false);
    let decoder = Kind::Rten.open(&folder.join("onnx/decoder_model.onnx"));
    let embed = Kind::Rten.open(&folder.join("onnx/embed_tokens.onnx"));
    let image = png(&folder.join("a_640x480.png"));
    let reply = model.ask(&image, &Task::ObjectDetection).unwrap();
    let greedy = DecodeConfig { num_beams: 1, ..model.config().decode.clone() };
    let seen = model.see(&model.config().picture.prepare(&image)).unwrap();
    let prompt = model.spell(&Task::ObjectDetection).unwrap();
    let said = model.answer(&seen, &prompt, &greedy).unwrap();
    assert_eq!(reply.sequence.ids, said.ids);
    let given = &reply.sequence.ids[..reply.sequence.ids.len() - 1];
    let data = given.iter().map(|id| i64::from(*id)).collect();
    let all = Tensor::I64 { shape: vec![1, given.len()], data };
    let embeds = embed.run(&[("input_ids", &all)], &["inputs_embeds"]).unwrap().remove(0);
    let (hidden, mask) = model.encode(&seen, &prompt).unwrap();
    let inputs = [
        ("encoder_attention_mask", &mask),
        ("encoder_hidden_states", &hidden),
        ("inputs_embeds", &embeds),
    ];
    let Tensor::F32 { shape, data } = decoder.run(&inputs, &["logits"]).unwrap().remove(0) else {
        panic!()
    };
    for (place, row) in data.chunks(shape[2]).enumerate() {
        let sum: f64 = row.iter().map(|score| f64::from(*score).exp()).sum();
        let token = reply.sequence.ids[place + 1] as usize;
        let forced = f64::from(row[token]) - sum.ln();
        assert!((forced - said.log_probs[place]).abs() < 1e-4, "{place}");
    }
}
