//! The demo's own models: token by token what the training framework says, and right about people they were never trained on.
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]
#![allow(clippy::print_stdout, reason = "tests say what they found and what they skip")]

use std::path::{Path, PathBuf};

use jrdb_cli::evaluation::{described_table, found_table, on_panoramas, on_tiles};
use jrdb_cli::phrase_accuracy::{on_phrases, phrase_table, summed_up};
use jrdb_models::PerceptionOptions;
use jrdb_models::backbone::{AttributeFiles, Backbone, Graphs, florence2};
use jrdb_models::loader::{EngineChoice, EngineOptions, Loader};
use jrdb_perception::florence2::Task;
use jrdb_perception::prompts::{Topic, phrase_question, questions};
use jrdb_perception::vlm::{AttributeConfig, LabelScore, VlmAttributes};
use jrdb_perception::{Subject, View};
use jrdb_synth::{Feature, Practice, practice, practice_with_looks};
use jrdb_types::{Detection, EntityId, FrameId, ImageGeometry};
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

#[test]
fn yes_and_no_are_as_probable_as_in_the_training_framework() {
    let golden = golden("phrases35.json");
    let phrases: Vec<&str> =
        golden["phrases"].as_array().unwrap().iter().map(|one| one.as_str().unwrap()).collect();
    assert_eq!(phrases, Feature::ALL.map(Feature::phrase));
    let questions: Vec<String> =
        phrases.iter().map(|phrase| phrase_question(phrase, "person")).collect();
    let expected = golden["yes_no"].as_array().unwrap();
    let crops = (UNSEEN..).flat_map(|seed| {
        practice_with_looks(seed).crops(0.0).into_iter().map(|(_, picture)| picture)
    });
    let crops: Vec<_> = crops.take(expected.len()).collect();
    let backbone = Backbone::named("demo", &models()).unwrap();
    let Some(AttributeFiles::Internvl { graphs, .. }) = &backbone.phrases else { panic!() };
    for loader in loaders() {
        let (vlm, family) = jrdb_models::backbone::internvl(graphs, &models(), &loader).unwrap();
        let asked = VlmAttributes::new(vlm, family, AttributeConfig::default()).unwrap();
        let far = |(picture, expected): (&jrdb_types::Image, &Value)| {
            let scores = asked.weigh_yes_no(picture, &questions).unwrap();
            let first = |labels: Vec<Vec<LabelScore>>| {
                labels.into_iter().map(|spellings| spellings[0].log_likelihood)
            };
            let told = scores.into_iter().flat_map(first);
            let wanted = expected.as_array().unwrap().iter().map(|log| log.as_f64().unwrap());
            told.zip(wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        };
        let far = crops.par_iter().zip(expected).map(far).reduce(|| 0.0, f64::max);
        println!("{}: log-likelihoods within {far:.1e}", loader.note());
        assert!(far < 1e-3);
    }
}

#[test]
fn phrases_about_people_of_unseen_scenes_are_judged() {
    let backbone = Backbone::named("demo", &models()).unwrap();
    let engine = engine(EngineChoice::Auto);
    let options = PerceptionOptions { engine, ..PerceptionOptions::default() };
    let models = backbone.open("demo", &options).unwrap().models;
    let scenes: Vec<Practice> =
        (UNSEEN..UNSEEN + 24).into_par_iter().map(practice_with_looks).collect();
    let judgings = summed_up(&on_phrases(&scenes, &models).unwrap());
    println!("{}", phrase_table(&judgings));
    let good = judgings.iter().filter(|one| one.average_precision >= 0.85).count();
    assert!(good >= 10, "{good} of {} phrases", judgings.len());
    let listed = models.phrases.as_ref().unwrap().phrases();
    let unknown = Feature::ALL.map(Feature::phrase).into_iter();
    let unknown: Vec<&str> = unknown.filter(|one| !listed.any(|known| known == one)).collect();
    assert_eq!(unknown, ["glasses", "beard"], "what the model did not learn is not guessed");
}

#[test]
fn the_demo_leaves_phrases_unknown_that_it_was_not_trained_on() {
    let backbone = Backbone::named("demo", &models()).unwrap();
    let engine = engine(EngineChoice::Auto);
    let options = PerceptionOptions { engine, ..PerceptionOptions::default() };
    let models = backbone.open("demo", &options).unwrap().models;
    let scene = practice_with_looks(UNSEEN);
    let seen = &scene.view.people[0];
    let detection = Detection::new(EntityId::new("person", 1), "person", 1.0, seen.bbox);
    let image = &scene.view.image;
    let [width_px, height_px] = [image.width, image.height].map(|side| side as u32);
    let geometry = ImageGeometry { width_px, height_px, wraps: true };
    let view = View { geometry, image: Some(image) };
    let subject = Subject { frame: &FrameId::default(), view, detection: &detection };
    let asked = models.phrases.as_ref().unwrap();
    let told = asked.weigh(&subject, &["smiling", "glasses", "red scarf", "?"]).unwrap();
    assert_eq!(told, [None; 4]);
    let umbrella = ["an umbrella", "holding an umbrella"];
    let told = asked.weigh(&subject, &umbrella).unwrap();
    assert_eq!((told[0], told.len()), (told[1], 2));
    assert_eq!(asked.weigh(&subject, &umbrella[..1]).unwrap(), told[..1]);
    let blind = Subject { view: View { image: None, ..view }, ..subject };
    assert_eq!(asked.weigh(&blind, &umbrella).unwrap(), [None, None]);
}
