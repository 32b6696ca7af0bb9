//! SSDLite and NanoDet together on a real, labelled panorama.
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]
#![allow(clippy::print_stdout, reason = "tests say what they found and what they skip")]

mod onnxruntime;
mod scene;

use std::collections::BTreeMap;
use std::time::Instant;

use jrdb_perception::{
    Appearance, AppearanceConfig, AttributeModel, Engine, FaceFinder, FaceModels, FaceReader,
    NanoDet, NanoDetConfig, OrtEngine, OrtLibrary, PairConfig, PairDetector, RtenEngine, SsdLite,
    SsdLiteConfig,
};
use jrdb_types::detection::PERSON;
use jrdb_types::vocab::Facing;
use jrdb_types::{Belief, Detection};

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
    // rten takes several times as long.
    let turns = if library.is_some() { 8 } else { 2 };
    for turn in 1..=turns {
        scene.turn(467); // a tile's width and a half, and no multiple of any stride
        let Quality { ap50, right, wrong } = quality(&scene, &models, library.as_ref());
        println!("turned {turn} times: AP50 {ap50:.3}, {right} people found, {wrong} false");
        assert!(ap50 >= 0.54 && right >= 9 && wrong <= 3);
        sum += ap50;
    }
    println!("mean AP50 {:.3}", sum / f64::from(turns));
    assert!(sum / f64::from(turns) >= 0.57);
}

/// Attributes by the models that look at faces, demographics included.
fn appearance(library: Option<&OrtLibrary>) -> Option<Appearance> {
    let load = |file: &str| Some(engine(library, &scene::model(file)?));
    let faces = FaceModels {
        finder: Some(FaceFinder::new(load("centerface-480.onnx")?)),
        gender: Some(FaceReader::new(load("gender-v1.onnx")?)),
        age: Some(FaceReader::new(load("age-v1.onnx")?)),
    };
    Some(Appearance::new(faces, AppearanceConfig::default()))
}

/// The largest difference of two beliefs about the same.
fn belief_difference<T: Ord + Copy>(a: &Belief<T>, b: &Belief<T>) -> f64 {
    assert!(a.0.keys().eq(b.0.keys()));
    a.0.iter().map(|(value, p)| (p - b.probability(*value)).abs()).fold(0.0, f64::max)
}

#[test]
fn conformance_light_describes_labelled_people_alike_on_both_engines() {
    let Some((scene, _)) = given() else { return };
    let (Some(rten), library) = (appearance(None), onnxruntime::find()) else { return };
    let ort = library.as_ref().and_then(|library| appearance(Some(library)));
    let mut worst = 0.0_f64;
    for bbox in &scene.people {
        let person = scene::person_at(*bbox);
        let found = rten.describe(&scene.image, &person).unwrap();
        println!("{bbox:?} {}", serde_json::to_string(&found).unwrap());
        let Some(other) = ort.as_ref().map(|ort| ort.describe(&scene.image, &person).unwrap())
        else {
            continue;
        };
        assert_eq!((&found.facing, found.upper_color()), (&other.facing, other.upper_color()));
        worst = worst.max(belief_difference(&found.gender(), &other.gender()));
        worst = worst.max(belief_difference(&found.age(), &other.age()));
    }
    println!("largest difference between the engines: {worst:.1e} in probability");
    assert!(worst < 1e-4);
    let facing = |x: f64| {
        let bbox = scene.people.iter().find(|bbox| bbox.x == x).unwrap();
        rten.describe(&scene.image, &scene::person_at(*bbox)).unwrap().facing.best()
    };
    // As one sees in the picture: two look at the robot, one half and one wholly to our right, one to our left.
    assert_eq!(facing(651.0), Some(Facing::Towards));
    assert_eq!(facing(2452.0), Some(Facing::Towards));
    assert_eq!(facing(950.0), Some(Facing::TowardsRight));
    assert_eq!(facing(2962.0), Some(Facing::Right));
    assert_eq!(facing(3359.0), Some(Facing::TowardsLeft));
}
