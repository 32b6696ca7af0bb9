//! People on a real, labelled panorama.
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]
#![allow(clippy::print_stdout, reason = "tests say what they found and what they skip")]

mod onnxruntime;
mod scene;

use std::time::Instant;

use jrdb_perception::{Engine, OrtEngine, RtenEngine, SsdLite, SsdLiteConfig};
use jrdb_types::Detection;

use scene::{Scene, difference};

/// The scene and the model.
fn given() -> Option<(Scene, Vec<u8>)> {
    let given = Scene::read().zip(scene::model("ssdlite-mbv2-300-person.f16.onnx"));
    if given.is_none() {
        println!("skipped: no shared data");
    }
    given
}

fn detect(scene: &Scene, engine: Box<dyn Engine>, config: SsdLiteConfig) -> Vec<Detection> {
    scene.see(&SsdLite::new(engine, config))
}

struct Quality {
    ap50: f64,
    right: usize,
    wrong: usize,
}

fn quality(scene: &Scene, make: impl Fn() -> Box<dyn Engine>) -> (Quality, Vec<Detection>) {
    let every = SsdLiteConfig { min_score: 0.05, ..SsdLiteConfig::default() };
    let ap50 = scene.ap50(&detect(scene, make(), every));
    let detections = detect(scene, make(), SsdLiteConfig::default());
    let judged = scene.judge(&detections);
    let right = judged.iter().filter(|right| **right).count();
    (Quality { ap50, right, wrong: judged.len() - right }, detections)
}

fn check(scene: &Scene, make: impl Fn() -> Box<dyn Engine> + Sync) -> Vec<Detection> {
    let (Quality { ap50, right, wrong }, detections) = quality(scene, &make);
    let (name, people) = (make().name().to_owned(), scene.people.len());
    println!("{name}: AP50 {ap50:.3}, {right} of {people} people found, {wrong} false");
    assert!(ap50 >= 0.5 && right >= 9 && wrong <= 2);

    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let engine = make();
    let start = Instant::now();
    let again = pool.install(|| detect(scene, engine, SsdLiteConfig::default()));
    println!("{name}: {} ms per panorama with one thread", start.elapsed().as_millis());
    assert_eq!(again, detections, "one thread and several see the same");
    detections
}

#[test]
fn conformance_ssdlite_on_the_real_frame() {
    let Some((scene, model)) = given() else { return };
    let rten = check(&scene, || Box::new(RtenEngine::from_onnx(&model).unwrap()));
    let Some(library) = onnxruntime::find() else { return };
    let ort = check(&scene, || Box::new(OrtEngine::from_onnx(&library, &model, 1).unwrap()));
    let (pixels, score) = difference(&rten, &ort);
    println!("largest difference between the engines: {pixels:.1e} px, {score:.1e} in score");
    assert!(pixels < 1e-3 && score < 1e-4);
}

#[test]
fn conformance_ssdlite_wherever_the_seam_and_the_tiles_begin() {
    let Some((mut scene, model)) = given() else { return };
    let library = onnxruntime::find();
    for turn in 1..=2 {
        scene.turn(467); // a tile's width and a half, and no multiple of any stride
        let (Quality { ap50, right, wrong }, _) = quality(&scene, || match &library {
            Some(library) => Box::new(OrtEngine::from_onnx(library, &model, 1).unwrap()),
            None => Box::new(RtenEngine::from_onnx(&model).unwrap()),
        });
        println!("turned {turn} times: AP50 {ap50:.3}, {right} people found, {wrong} false");
        assert!(ap50 >= 0.45 && right >= 8 && wrong <= 3);
    }
}
