//! The demo's own models: token by token what the training framework says, and right about people they were never trained on.
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]
#![allow(clippy::print_stdout, reason = "tests say what they found and what they skip")]

use std::path::{Path, PathBuf};

use jrdb_cli::evaluation::{described_table, found_table, on_panoramas, on_tiles};
use jrdb_models::PerceptionOptions;
use jrdb_models::backbone::{AttributeFiles, Backbone, Graphs, florence2};
use jrdb_models::loader::{EngineChoice, EngineOptions, Loader};
use jrdb_perception::florence2::Task;
use jrdb_perception::prompts::{Topic, questions};
use jrdb_synth::{Practice, practice};
use rayon::prelude::*;
use serde_json::Value;

/// The first seed of scenes that no model was trained on.
const UNSEEN: u64 = 5_000_000;

fn models() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models")
}

fn engine(choice: EngineChoice) -> EngineOptions {
    EngineOptions { choice, models: models(), ..EngineOptions::default() }
}

fn loaders() -> Vec<Loader> {
    let made = [EngineChoice::Rten, EngineChoice::Ort].map(|choice| Loader::new(&engine(choice)));
    if made[1].is_err() {
        println!("skipped: no onnxruntime");
    }
    made.into_iter().flatten().collect()
}

fn golden(file: &str) -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/demo").join(file);
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn ids(value: &Value) -> Vec<u32> {
    value.as_array().unwrap().iter().map(|id| id.as_u64().unwrap() as u32).collect()
}

#[test]
fn the_detector_says_what_the_training_framework_says() {
    let golden = golden("florence2.json");
    let expected: Vec<Vec<u32>> = golden["tiles"].as_array().unwrap().iter().map(ids).collect();
    let scenes: Vec<Practice> = (UNSEEN..UNSEEN + 6).into_par_iter().map(practice).collect();
    let graphs = Graphs { folder: "demo/florence2".into(), variant: String::new() };
    for loader in loaders() {
        let model = florence2(&graphs, &models(), &loader).unwrap();
        let prompt = model.tokens().encode_input(&Task::ObjectDetection.prompt()).unwrap();
        assert_eq!(prompt, ids(&golden["prompt_ids"]));
        let pictures = scenes.iter().flat_map(|scene| {
            let starts = scene.clone().tiles();
            starts.into_iter().map(|x_px| scene.tile(x_px)).collect::<Vec<_>>()
        });
        let pictures: Vec<_> = pictures.collect();
        let said: Vec<Vec<u32>> = pictures
            .par_iter()
            .map(|picture| model.ask(picture, &Task::ObjectDetection).unwrap().sequence.ids)
            .collect();
        let equal = said.iter().zip(&expected).filter(|(a, b)| a == b).count();
        println!("{}: {equal} of {} tiles equal", loader.note(), said.len());
        assert_eq!(equal, said.len());
    }
}

#[test]
fn the_describer_says_what_the_training_framework_says() {
    let golden = golden("internvl35.json");
    let expected = golden["crops"].as_array().unwrap();
    let crops = (UNSEEN..).flat_map(|seed| {
        let mut scene = practice(seed);
        scene.tiles();
        scene.crops(0.0).into_iter().map(|(_, picture)| picture)
    });
    let crops: Vec<_> = crops.take(expected.len()).collect();
    let backbone = Backbone::named("demo", &models()).unwrap();
    let Some(AttributeFiles::Internvl { graphs, .. }) = &backbone.attributes else { panic!() };
    for loader in loaders() {
        let (vlm, family) = jrdb_models::backbone::internvl(graphs, &models(), &loader).unwrap();
        let answers = |(picture, expected): (&jrdb_types::Image, &Value)| {
            let shown = family.show(&vlm, picture).unwrap();
            let said = questions(&Topic::ALL).into_iter().map(|question| {
                let topic = serde_json::to_value(question.topic).unwrap();
                let topic = topic.as_str().unwrap();
                let prompt = vlm.tokens().encode(&family.prompt(&question.text, &shown)).unwrap();
                assert_eq!(prompt, ids(&golden["prompt_ids"][topic]), "{topic}");
                let read = vlm.read(&prompt, &shown.features, None).unwrap();
                vlm.write(read, 8).unwrap().ids == ids(&expected[topic])
            });
            said.filter(|is_equal| *is_equal).count()
        };
        let equal: usize = crops.par_iter().zip(expected).map(answers).sum();
        println!("{}: {equal} of {} answers equal", loader.note(), 5 * crops.len());
        assert_eq!(equal, 5 * crops.len());
    }
}

#[test]
fn people_of_unseen_scenes_are_found_and_described() {
    let engine = engine(EngineChoice::Auto);
    let backbone = Backbone::named("demo", &models()).unwrap();
    let options = PerceptionOptions { engine, ..PerceptionOptions::default() };
    let whole = backbone.open("demo", &options).unwrap().models;
    let single = backbone.one_tile().open("demo", &options).unwrap().models;
    let scenes: Vec<Practice> = (UNSEEN..UNSEEN + 12).into_par_iter().map(practice).collect();
    let tiles = on_tiles(&scenes, &single).unwrap();
    println!("{}", found_table("120 tiles", &tiles));
    let (panoramas, described) = on_panoramas(&scenes, &whole).unwrap();
    println!("{}", found_table("12 panoramas", &panoramas));
    println!("{}", described_table(&described));
    assert!(tiles.all.ap50 >= 0.87 && tiles.clear.ap50 >= 0.92);
    assert!(panoramas.all.ap50 >= 0.87);
    assert!(described.all.mean() >= 0.92);
}
