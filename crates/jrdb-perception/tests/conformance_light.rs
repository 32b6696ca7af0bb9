//! SSDLite and NanoDet together on a real, labelled panorama.
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]
#![allow(clippy::print_stdout, reason = "tests say what they found and what they skip")]

mod onnxruntime;
mod scene;

use std::collections::BTreeMap;
use std::time::Instant;

use jrdb_perception::{
    Engine, NanoDet, NanoDetConfig, OrtEngine, OrtLibrary, PairConfig, PairDetector, RtenEngine,
    SsdLite, SsdLiteConfig,
};
use jrdb_types::Detection;
use jrdb_types::detection::PERSON;

use scene::{Scene, difference};

struct Models {
    ssdlite: Vec<u8>,
    nanodet: Vec<u8>,
}

fn given() -> Option<(Scene, Models)> {
    let ssdlite = scene::model("ssdlite-mbv2-300-person.f16.onnx");
    let models = ssdlite.zip(scene::model("nanodet-g-416-coco.f16.onnx"));
    let given = Scene::read().zip(models.map(|(ssdlite, nanodet)| Models { ssdlite, nanodet }));
    if given.is_none() {
        println!("skipped: no shared data");
    }
    given
}

fn engine(library: Option<&OrtLibrary>, model: &[u8]) -> Box<dyn Engine> {
    match library {
        Some(library) => Box::new(OrtEngine::from_onnx(library, model, 1).unwrap()),
        None => Box::new(RtenEngine::from_onnx(model).unwrap()),
    }
}

/// The detector as the pipeline makes it, with another least confidence of people.
fn light(
    models: &Models,
    library: Option<&OrtLibrary>,
    min_score: f64,
) -> PairDetector<SsdLite, NanoDet> {
    const LEAST: f64 = 0.05;
    let people = SsdLiteConfig { min_score: LEAST, ..SsdLiteConfig::default() };
    let things = NanoDetConfig { min_score: LEAST, ..NanoDetConfig::default() };
    PairDetector::new(
        SsdLite::new(engine(library, &models.ssdlite), people),
        NanoDet::new(engine(library, &models.nanodet), things),
        PairConfig { min_score, ..PairConfig::default() },
    )
}

struct Quality {
    ap50: f64,
    right: usize,
    wrong: usize,
}

fn quality(scene: &Scene, models: &Models, library: Option<&OrtLibrary>) -> Quality {
    let every = scene.people_by(&light(models, library, 0.0));
    let sure: Vec<Detection> =
        every.iter().filter(|d| d.score >= PairConfig::default().min_score).cloned().collect();
    let judged = scene.judge(&sure);
    let right = judged.iter().filter(|right| **right).count();
    Quality { ap50: scene.ap50(&every), right, wrong: judged.len() - right }
}

fn counts(detections: &[Detection]) -> BTreeMap<&str, usize> {
    let mut counts = BTreeMap::new();
    detections.iter().for_each(|d| *counts.entry(d.category.as_str()).or_default() += 1);
    counts
}

#[test]
fn conformance_light_sees_people_and_objects_on_the_real_frame() {
    let Some((scene, models)) = given() else { return };
    let library = onnxruntime::find();
    let Quality { ap50, right, wrong } = quality(&scene, &models, library.as_ref());
    println!("AP50 {ap50:.3}, {right} of {} people found, {wrong} false", scene.people.len());
    assert!(ap50 >= 0.57 && right >= 10 && wrong <= 2);

    let detector = light(&models, library.as_ref(), PairConfig::default().min_score);
    let start = Instant::now();
    let seen = scene.see(&detector);
    println!("{} ms, {:?}", start.elapsed().as_millis(), counts(&seen));
    for object in ["chair", "laptop", "cup"] {
        assert!(counts(&seen).contains_key(object), "{object}");
    }
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    assert_eq!(one_thread.install(|| scene.see(&detector)), seen);
}

#[test]
fn conformance_light_on_both_engines() {
    let Some((scene, models)) = given() else { return };
    let Some(library) = onnxruntime::find() else { return };
    let [rten, ort] =
        [None, Some(&library)].map(|library| scene.see(&light(&models, library, 0.5)));
    let ids = |seen: &[Detection]| seen.iter().map(|d| d.id.clone()).collect::<Vec<_>>();
    assert_eq!(ids(&rten), ids(&ort));
    let (pixels, score) = difference(&rten, &ort);
    println!("largest difference between the engines: {pixels:.1e} px, {score:.1e} in score");
    assert!(pixels < 1e-2 && score < 1e-3);
    assert!(rten.iter().any(|d| d.category == PERSON));
}

#[test]
fn conformance_light_wherever_the_seam_and_the_tiles_begin() {
    let Some((mut scene, models)) = given() else { return };
    let library = onnxruntime::find();
    let mut sum = 0.0;
    for turn in 1..=8 {
        scene.turn(467); // a tile's width and a half, and no multiple of any stride
        let Quality { ap50, right, wrong } = quality(&scene, &models, library.as_ref());
        println!("turned {turn} times: AP50 {ap50:.3}, {right} people found, {wrong} false");
        assert!(ap50 >= 0.54 && right >= 9 && wrong <= 3);
        sum += ap50;
    }
    println!("mean AP50 {:.3}", sum / 8.0);
    assert!(sum / 8.0 >= 0.57);
}
