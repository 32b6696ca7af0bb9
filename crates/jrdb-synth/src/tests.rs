//! Whole worlds: the same every time, true to their labels, and answered by the real pipeline.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use jrdb_dataset::Dataset;
use jrdb_graph::GraphConfig;
use jrdb_projection::{ProjectionConfig, Scan};
use jrdb_search::SearchConfig;
use jrdb_types::detection::PERSON;
use jrdb_types::vocab::Occlusion;
use jrdb_types::{Action, Detection, DistanceWord, FrameId, Question};
use proptest::prelude::*;

use super::*;

/// The scenes that come with the repository.
fn bundled() -> Vec<(PathBuf, SynthConfig)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata/scenes");
    let mut folders: Vec<PathBuf> =
        std::fs::read_dir(root).unwrap().map(|entry| entry.unwrap().path()).collect();
    folders.sort();
    let read = |folder: PathBuf| {
        let text = std::fs::read_to_string(folder.join("scene.json")).unwrap();
        (folder, serde_json::from_str(&text).unwrap())
    };
    folders.into_iter().map(read).collect()
}

fn frames(config: &SynthConfig) -> Vec<Frame> {
    let world = generate(config);
    (0..config.frames).map(|index| world.frame(index)).collect()
}

fn people(frame: &Frame) -> Vec<&Detection> {
    let things = frame.labels.detections.detections.iter();
    things.filter(|thing| thing.category == PERSON).collect()
}

fn is_visible(person: &Detection) -> bool {
    person.occlusion <= Some(Occlusion::MostlyVisible)
}

/// Relative paths of all files below a folder, sorted.
fn files(root: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![root.to_path_buf()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                found.push(path.strip_prefix(root).unwrap().to_path_buf());
            }
        }
    }
    found.sort();
    found
}

#[test]
fn the_same_configuration_gives_the_same_bytes() {
    let [one, two] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let config = SynthConfig { seed: 11, people: 5, frames: 2, ..SynthConfig::default() };
    write(&generate(&config), one.path()).unwrap();
    write(&generate(&config), two.path()).unwrap();
    assert_eq!(files(one.path()), files(two.path()));
    assert_eq!(files(one.path()).len(), 2 + 3 * 2 + 3 + 3);
    for file in files(one.path()) {
        let [a, b] = [&one, &two].map(|root| std::fs::read(root.path().join(&file)).unwrap());
        assert!(a == b, "{file:?}");
    }
    assert_ne!(generate(&config), generate(&SynthConfig { seed: 12, ..config.clone() }));
}

#[test]
fn the_bundled_scenes_are_what_their_configurations_give() {
    assert!(bundled().len() >= 3);
    for (folder, config) in bundled() {
        let fresh = tempfile::tempdir().unwrap();
        write(&generate(&config), fresh.path()).unwrap();
        for file in files(fresh.path()) {
            let [kept, new] = [folder.as_path(), fresh.path()]
                .map(|root| std::fs::read(root.join(&file)).unwrap_or_default());
            assert!(kept == new, "{:?} is stale: jrdb synth writes it anew", folder.join(&file));
        }
    }
}

#[test]
fn a_box_is_where_its_person_is_drawn() {
    for (folder, config) in bundled() {
        for frame in frames(&config) {
            let period = frame.image.width as f64;
            let subjects = generate(&config).cast.people.len();
            for person in people(&frame) {
                // People come first among the subjects, in the order of their numbers.
                assert!(person.id.number as usize <= subjects);
                let own = (0..frame.instances.len())
                    .filter(|&pixel| u32::from(frame.instances[pixel]) == person.id.number);
                let (mut inside, mut outside) = (0, 0);
                for pixel in own {
                    let (u, v) = (pixel % frame.image.width, pixel / frame.image.width);
                    let across = (u as f64 + 0.5 - person.bbox.x).rem_euclid(period);
                    let down = v as f64 + 0.5 - person.bbox.y;
                    let is_inside = across < person.bbox.w && (0.0..person.bbox.h).contains(&down);
                    *(if is_inside { &mut inside } else { &mut outside }) += 1;
                }
                assert_eq!(outside, 0, "{folder:?} {}", person.id);
                let share = f64::from(inside) / person.bbox.area_px2();
                let wanted = if is_visible(person) { 0.2 } else { 0.0 };
                assert!((wanted..0.9).contains(&share), "{folder:?} {} {share}", person.id);
            }
        }
    }
}

#[test]
fn the_cloud_shows_visible_people_where_their_labels_are() {
    let mut checked = 0;
    for (folder, config) in bundled() {
        for frame in frames(&config) {
            let entities = located(&frame.labels.detections, &frame.clouds);
            for person in people(&frame).into_iter().filter(|person| is_visible(person)) {
                let label = person.box3d.unwrap();
                let range_m = label.center[0].hypot(label.center[1]);
                if range_m > 6.0 {
                    continue;
                }
                checked += 1;
                let points = frame.labels.num_points[&person.id];
                assert!(points >= 40, "{folder:?} {} has {points} points", person.id);
                let entity = entities.entities.iter().find(|e| e.id == person.id).unwrap();
                let found = entity.position.unwrap().center;
                let off = (found[0] - label.center[0]).hypot(found[1] - label.center[1]);
                assert!(off < 0.2, "{folder:?} {} is {off} m off", person.id);
            }
        }
    }
    assert!(checked > 20, "{checked}");
}

/// Everything placed by the default localiser, from the boxes in the image only.
fn located(labels: &jrdb_types::Detections, clouds: &[PointCloud]) -> jrdb_types::Entities {
    let mut detections = labels.clone();
    detections.detections.iter_mut().for_each(|thing| thing.box3d = None);
    let rig = calibration().rig();
    jrdb_projection::project(&detections, &Scan::new(clouds, &rig), &ProjectionConfig::default())
        .unwrap()
}

/// Whether the pipeline, from the files of a scene and with its defaults, gives the known answer.
fn is_answered(root: &Path, question: &Question) -> bool {
    let dataset = Dataset::open(root).unwrap();
    let FrameId { sequence, frame } = &question.frame;
    let (clouds, issues) = dataset.clouds(sequence, *frame, &dataset.rig().unwrap().lidars);
    assert_eq!(issues, []);
    let image = dataset.rig().unwrap().cameras[0].lens.image();
    let labels = dataset.labels(sequence).unwrap().detections(&question.frame, image);
    let graph = jrdb_graph::build(&located(&labels, &clouds), &GraphConfig::default());
    let query = jrdb_parser::parse(&question.text);
    let answer = jrdb_search::search(&graph, &query, &SearchConfig::default());
    let truth = question.truth.as_ref().unwrap();
    answer.selection == truth.ids && answer.number() == truth.count
}

#[test]
fn the_real_pipeline_answers_every_question_of_the_bundled_scenes() {
    for (folder, _) in bundled() {
        let questions = jrdb_dataset::read_questions(&folder.join(QUESTIONS_FILE)).unwrap();
        for question in questions.questions {
            assert!(is_answered(&folder, &question), "{folder:?}: {}", question.text);
        }
    }
}

#[test]
fn the_bundled_scenes_cover_what_a_newcomer_should_see() {
    let mut all_categories = BTreeSet::new();
    for (folder, config) in bundled() {
        for frame in frames(&config) {
            let people = people(&frame);
            let does = |action| {
                people.iter().any(|person| person.attributes.action().best() == Some(action))
            };
            assert!(does(Action::Sitting) && does(Action::Walking), "{folder:?}");
            let period = frame.image.width as f64;
            assert!(people.iter().any(|p| p.bbox.x + p.bbox.w > period), "nobody on the seam");
            assert!(people.iter().any(|p| !p.interactions.is_empty()), "no pair");
            let visible = people.iter().filter(|person| is_visible(person)).count();
            assert!(5 * visible >= 3 * people.len(), "{folder:?} shows {visible}");
            assert!(frame.questions.len() >= 12, "{folder:?}");
            let of =
                |category: &str| frame.questions.iter().filter(|q| q.category == category).count();
            assert_eq!(of("count"), 2);
            all_categories.extend(frame.questions.iter().map(|question| question.category.clone()));
        }
    }
    for category in [
        "human",
        "age",
        "gender-age",
        "gender-age-race",
        "gender-age-race-distance",
        "gender-age-race-distance-SR/robot",
        "gender-age-race-HHG",
        "gender-age-race-HHI",
        "action",
        "gender-action",
        "count",
        "paper",
    ] {
        assert!(all_categories.contains(category), "no question of {category}");
    }
}

#[test]
fn near_and_far_are_both_there() {
    for setting in [Setting::Plaza, Setting::Cafe, Setting::Corridor] {
        let config = SynthConfig { seed: 3, people: 12, setting, ..SynthConfig::default() };
        let frame = &frames(&config)[0];
        let entities = located(&frame.labels.detections, &frame.clouds);
        let distances: BTreeSet<DistanceWord> = entities
            .entities
            .iter()
            .filter(|entity| entity.category == PERSON)
            .filter_map(|entity| entity.from_robot?.distance)
            .collect();
        for word in [DistanceWord::Close, DistanceWord::Moderate, DistanceWord::Far] {
            assert!(distances.contains(&word), "{setting:?} {distances:?}");
        }
    }
}

#[test]
fn walkers_move_between_frames_and_others_stay() {
    let config = SynthConfig { seed: 2, frames: 2, people: 9, ..SynthConfig::default() };
    let frames = frames(&config);
    assert_eq!([frames[0].id.frame, frames[1].id.frame], [0, 5]);
    for (before, after) in people(&frames[0]).into_iter().zip(people(&frames[1])) {
        let [from, to] = [before, after].map(|person| person.box3d.unwrap().center);
        let moved_m = (from[0] - to[0]).hypot(from[1] - to[1]);
        let wanted = match before.attributes.action().best() {
            Some(Action::Walking) => 1.0 / 3.0..1.4 / 3.0 + 1e-9,
            _ => 0.0..1e-9,
        };
        assert!(wanted.contains(&moved_m), "{} moved {moved_m} m", before.id);
    }
}

#[test]
fn an_unknown_field_of_a_configuration_is_refused() {
    let error = serde_json::from_str::<SynthConfig>(r#"{"seed": 1, "poeple": 3}"#).unwrap_err();
    assert!(error.to_string().contains("unknown field `poeple`"), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_world_can_be_made(
        seed in 0_u64..1_000_000,
        people in 1_usize..=12,
        frames in 1_u32..=3,
        setting in prop::sample::select(vec![Setting::Plaza, Setting::Cafe, Setting::Corridor]),
    ) {
        let config = SynthConfig { seed, people, frames, setting, ..SynthConfig::default() };
        let frame = generate(&config).frame(frames - 1);
        let found = self::people(&frame);
        prop_assert_eq!(found.len(), people);
        prop_assert!(found.iter().all(|person| person.bbox.is_proper() && person.bbox.x < 3760.0));
        prop_assert!(people < 4 || frame.questions.len() >= 12, "{} questions", frame.questions.len());
        prop_assert!(frame.clouds.iter().all(|cloud| cloud.len() > 10_000));
    }
}

/// How many of the pixels in a person's box differ between two worlds of the same people.
fn changed(plain: &World, other: &World, person: usize) -> usize {
    let [a, b] = [plain, other].map(|world| world.view(0));
    let seen = &b.people[person];
    let own = |pixel: &usize| b.instances[*pixel] == seen.instance;
    let differs = |pixel: &usize| a.image.rgb[3 * pixel..][..3] != b.image.rgb[3 * pixel..][..3];
    (0..b.instances.len()).filter(own).filter(differs).count()
}

#[test]
fn what_shows_is_drawn() {
    let config = SynthConfig { seed: 3, people: 4, ..SynthConfig::default() };
    let plain = generate(&config);
    let plain_view = plain.view(0);
    for feature in Feature::ALL {
        let looks = vec![vec![feature]; 4];
        let dressed = generate(&SynthConfig { looks, ..config.clone() });
        for (person, seen) in plain_view.people.iter().enumerate() {
            let is_new = !seen.features.contains(&feature);
            if is_new && seen.shows(feature) && plain_view.visible(seen) > 0.9 {
                let pixels = changed(&plain, &dressed, person);
                assert!(pixels > 40, "{feature:?} of {person}: {pixels}");
            }
        }
    }
}

#[test]
fn dealt_looks_are_stated_and_draw_the_same_again() {
    let config = with_looks(&SynthConfig { seed: 8, people: 12, ..SynthConfig::default() });
    let text = serde_json::to_string(&config).unwrap();
    assert!(text.contains("striped_shirt"), "{text}");
    let (view, read) = (generate(&config).view(0), serde_json::from_str(&text).unwrap());
    assert_eq!(generate(&read).view(0), view);
    for (seen, listed) in view.people.iter().zip(&config.looks) {
        assert_eq!(seen.features, *listed);
    }
    let dealt = |feature| config.looks.iter().any(|all| all.contains(&feature));
    assert!(Feature::ALL.into_iter().filter(|feature| dealt(*feature)).count() >= 10);
}

#[test]
fn without_looks_nothing_is_stated_and_nothing_changes() {
    let config = SynthConfig { seed: 5, people: 3, ..SynthConfig::default() };
    let plain = generate(&config);
    assert!(!serde_json::to_string(plain.config()).unwrap().contains("looks"));
    let none = SynthConfig { looks: vec![Vec::new(); 3], ..config };
    assert_eq!(generate(&none).view(0), plain.view(0));
}
