//! The `jrdb` command from the outside: what it prints, its exit codes, and what bad input does.
#![allow(clippy::panic, clippy::unwrap_used, reason = "a failing helper should panic")]

mod tree;

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

struct Ran {
    code: i32,
    out: String,
    err: String,
}

fn jrdb(arguments: &[&str]) -> Ran {
    let output: Output = Command::new(env!("CARGO_BIN_EXE_jrdb")).args(arguments).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    Ran { code: output.status.code().unwrap(), out: text(output.stdout), err: text(output.stderr) }
}

/// A dataset of its own for one test.
struct Scene {
    folder: TempDir,
}

impl Scene {
    fn new() -> Self {
        let folder = TempDir::new().unwrap();
        tree::write(folder.path());
        Self { folder }
    }

    fn path(&self, inside: &str) -> PathBuf {
        self.folder.path().join(inside)
    }

    /// The file's path below the dataset's root, with what `change` makes of its bytes.
    fn change(&self, inside: &str, change: impl Fn(&[u8]) -> Vec<u8>) {
        let path = self.path(inside);
        std::fs::write(&path, change(&std::fs::read(&path).unwrap())).unwrap();
    }

    fn root(&self) -> &str {
        self.folder.path().to_str().unwrap()
    }

    fn ask(&self, query: &str) -> Ran {
        jrdb(&["run", "--scene", self.root(), "--query", query])
    }
}

const UPPER: &str = "pointclouds/upper_velodyne/two-people/000000.pcd";
const LOWER: &str = "pointclouds/lower_velodyne/two-people/000000.pcd";
const IMAGE: &str = "images/image_stitched/two-people/000000.png";
const LABELS: &str = "labels/labels_2d_stitched/two-people.json";

fn cut(bytes: &[u8]) -> Vec<u8> {
    bytes[..bytes.len() * 2 / 3].to_vec()
}

#[track_caller]
fn contains(text: &str, words: &[&str]) {
    for word in words {
        assert!(text.contains(word), "{word:?} is not in:\n{text}");
    }
}

#[test]
fn a_question_is_answered_with_its_reason() {
    let ran = Scene::new().ask("Who is to my left?");
    assert_eq!(ran.code, 0, "{}", ran.err);
    let ran = Scene::new().ask("Find the female at moderate distance left relative to me");
    assert_eq!((ran.code, ran.err.as_str()), (0, ""));
    contains(&ran.out, &["answer  #2", "gender female", "left of the robot (left, +90°)"]);
}

#[test]
fn a_question_may_be_written_in_the_notation() {
    let ran = Scene::new().ask("find person[female, direction=left]");
    assert_eq!((ran.code, ran.err.as_str()), (0, ""));
    contains(&ran.out, &["answer  #2"]);
    let ran = Scene::new().ask("find person[femal]");
    assert_eq!(ran.code, 2);
    contains(&ran.err, &["find person[femal]", "^^^^^", "expected a condition, found \"femal\""]);
}

#[test]
fn a_text_of_which_nothing_is_understood_is_bad_input() {
    for text in ["", " \t\u{7}", "où est la gare", "人はどこですか", "qwe rty"] {
        let ran = Scene::new().ask(text);
        assert_eq!((ran.code, ran.out.as_str()), (2, ""), "{text:?}");
        contains(&ran.err, &["expected a question about people or things", "understood nothing"]);
        assert_eq!(jrdb(&["parse", text]).code, 2, "{text:?}");
    }
    let ran = Scene::new().ask("Find the female with the theremin");
    assert_eq!(ran.code, 0);
    contains(&ran.out, &["theremin", "answer"]);
}

#[test]
fn parse_shows_the_meaning_and_underlines_what_is_open() {
    let ran = jrdb(&["parse", "the woman left of the man"]);
    let meaning = "find person[female, at direction=left: person[male]]\n";
    assert_eq!((ran.code, ran.out.as_str()), (0, meaning));
    contains(&ran.err, &["own left"]);
    let ran = jrdb(&["parse", "--explain", "the woman left of the man"]);
    contains(&ran.out, &["the woman left of the man", "          ^^^^", meaning.trim()]);
    let ran = jrdb(&["parse", "--viewpoint", "robot", "the woman left of the man"]);
    let meaning = "find person[female, seen direction=left: person[male]]\n";
    assert_eq!((ran.out.as_str(), ran.err.as_str()), (meaning, ""));
}

#[test]
fn a_question_about_time_is_asked_once_of_the_whole_recording() {
    let (scene, out) = (Scene::new(), tempfile::tempdir().unwrap());
    let question = "Find female persons who are during 0 to 0.07 seconds";
    let folder = out.path().to_str().unwrap();
    let ran = jrdb(&["run", "--scene", scene.root(), "--query", question, "--out", folder]);
    assert_eq!((ran.code, ran.err.as_str()), (0, ""));
    contains(&ran.out, &["two-people, all frames", "answer  #2", "in 2 of 2 frames"]);
    assert_eq!(ran.out.matches(question).count(), 1);
    let answer = std::fs::read_to_string(&tree::files(out.path(), "answer.json")[0]).unwrap();
    let answer: serde_json::Value = serde_json::from_str(&answer).unwrap();
    let frames: Vec<_> = answer["data"]["slots"][0]["seen"]
        .as_array()
        .unwrap()
        .iter()
        .map(|s| s["frame"].clone())
        .collect();
    assert_eq!(frames, [0, 1]);
}

#[test]
fn an_answer_says_why_not_and_what_would_change_it() {
    let scene = Scene::new();
    let question = ["run", "--scene", scene.root(), "--query", "Find the female on my left"];
    let more = ["--frames", "0..1", "--why-not", "1", "--sensitivity", "--explain"];
    let ran = jrdb(&[&question[..], &more].concat());
    assert_eq!((ran.code, ran.err.as_str()), (0, ""));
    contains(&ran.out, &["✓ gender female", "why not #1? ", "gender female: male"]);
    contains(&ran.out, &["would leave: #2, left of the robot, at "]);
}

#[test]
fn json_is_all_that_is_on_standard_output() {
    let scene = Scene::new();
    let ran =
        jrdb(&["run", "--scene", scene.root(), "--query", "Find all persons", "--format", "json"]);
    let document: serde_json::Value = serde_json::from_str(&ran.out).unwrap();
    assert_eq!(document["answers"].as_array().unwrap().len(), 2);
    assert_eq!(document["answers"][0]["schema"], "jrdb.answer");
    assert!(!ran.out.contains(scene.root()), "no host paths in artefacts");
}

#[test]
fn whoever_stops_reading_has_read_enough() {
    let scene = Scene::new();
    let mut command = Command::new(env!("CARGO_BIN_EXE_jrdb"));
    command.args(["run", "--scene", scene.root(), "--query", "Find all persons"]);
    let mut child = command.stdout(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    assert!(child.wait().unwrap().success());
}

#[test]
fn the_stages_one_by_one_give_what_the_run_gives_trouble_included() {
    let scene = Scene::new();
    scene.change(LOWER, cut);
    scene.change(IMAGE, cut);
    let out = scene.path("run");
    let query = "Find the male";
    let frames = ["--frames", "0..1"];
    let run = ["run", "--scene", scene.root(), "--query", query, "--artifacts", "--out"];
    assert_eq!(jrdb(&[&run[..], &[out.to_str().unwrap()], &frames].concat()).code, 0);
    let file = |name: &str| scene.path(name).to_str().unwrap().to_string();
    let [detections, entities, graph, question, answer] =
        ["d.json", "e.json", "g.json", "q.json", "a.json"].map(file);
    let steps: [&[&str]; 5] = [
        &["perceive", "--scene", scene.root(), "--frames", "0..1", "--out", &detections],
        &["project", "--dataset", scene.root(), "--detections", &detections, "--out", &entities],
        &["graph", "--entities", &entities, "--out", &graph],
        &["parse", query, "--out", &question],
        &["search", "--graph", &graph, "--query", &question, "--out", &answer],
    ];
    for step in steps {
        let ran = jrdb(step);
        assert_eq!(ran.code, 0, "{step:?}: {}", ran.err);
    }
    let names =
        ["detections.json", "entities.json", "scene_graph.json", "query.json", "answer.json"];
    for (name, alone) in names.iter().zip([&detections, &entities, &graph, &question, &answer]) {
        let together = std::fs::read_to_string(&tree::files(&out, name)[0]).unwrap();
        assert_eq!(std::fs::read_to_string(alone).unwrap(), together, "{name}");
    }
}

#[test]
fn a_broken_cloud_is_named_and_the_other_one_goes_on() {
    let scene = Scene::new();
    scene.change(UPPER, cut);
    let ran = scene.ask("Find the female");
    assert_eq!(ran.code, 0);
    contains(&ran.out, &["note: ", UPPER, "expected", "2 of them placed", "answer  #2"]);
    assert!(
        !ran.out.contains(scene.root()),
        "paths are told from the dataset's root:\n{}",
        ran.out
    );
}

#[test]
fn a_cloud_that_claims_four_billion_points_is_refused() {
    let scene = Scene::new();
    scene.change(LOWER, |bytes| {
        let text = String::from_utf8_lossy(bytes).into_owned();
        let header = text.split("DATA").next().unwrap().replace("\nPOINTS ", "\nPOINTS 4000000");
        [header.as_bytes(), b"DATA binary\n"].concat()
    });
    let ran = scene.ask("Find the female");
    assert_eq!(ran.code, 0);
    contains(&ran.out, &[LOWER, "answer  #2"]);
}

#[test]
fn people_without_points_are_reported_and_kept() {
    let scene = Scene::new();
    std::fs::remove_file(scene.path(UPPER)).unwrap();
    std::fs::remove_file(scene.path(LOWER)).unwrap();
    let ran = scene.ask("Find the female");
    assert_eq!(ran.code, 0);
    contains(&ran.out, &["#1 #2: no lidar point in the box", "0 of them placed", "answer  #2"]);
}

#[test]
fn a_broken_picture_does_not_stop_the_labels() {
    let whole = std::fs::read(Scene::new().path(IMAGE)).unwrap();
    for broken in [cut(&whole), b"not a picture".to_vec(), Vec::new()] {
        let scene = Scene::new();
        scene.change(IMAGE, |_| broken.clone());
        let out = scene.path("out");
        let ran = jrdb(&[
            "run",
            "--scene",
            scene.root(),
            "--query",
            "Find the male",
            "--out",
            out.to_str().unwrap(),
        ]);
        assert_eq!(ran.code, 0, "{}", ran.err);
        contains(&ran.out, &[IMAGE, "answer  #1"]);
        assert_eq!(tree::files(&out, "panorama.png").len(), 2);
    }
}

#[test]
fn broken_labels_fail_their_frames_and_say_where() {
    for (text, expected) in
        [("{\"labels\": {", "two-people.json"), ("[]", "labels"), ("\u{1}", "two-people.json")]
    {
        let scene = Scene::new();
        scene.change(LABELS, |_| text.as_bytes().to_vec());
        let ran = scene.ask("Find the male");
        assert_eq!(ran.code, 1, "{}", ran.out);
        contains(&ran.err, &["two-people/000000", expected]);
    }
}

#[test]
fn one_label_that_is_no_label_costs_only_itself_and_its_box_is_taken_from_the_other_file() {
    let scene = Scene::new();
    scene.change(LABELS, |bytes| {
        std::str::from_utf8(bytes)
            .unwrap()
            .replacen("\"pedestrian:1\"", "\"nobody\"", 1)
            .into_bytes()
    });
    let ran = scene.ask("Find all persons");
    assert_eq!(ran.code, 0);
    contains(
        &ran.out,
        &["note: labels_2d_stitched: expected an id", "\"nobody\"", "answer  #1 #2"],
    );
}

#[test]
fn a_broken_calibration_is_bad_input() {
    for (file, text) in [
        ("calibration/defaults.yaml", "calibrated: ["),
        ("calibration/defaults.yaml", "image: {width: 400, height: 60}"),
        ("calibration/cameras.yaml", "cameras: {}"),
    ] {
        let scene = Scene::new();
        scene.change(file, |_| text.as_bytes().to_vec());
        let ran = scene.ask("Find the male");
        assert_eq!(ran.code, 2, "{file}: {}", ran.out);
        contains(&ran.err, &["error: ", file]);
    }
}

#[test]
fn bad_usage_is_told_apart_from_failed_work() {
    let scene = Scene::new();
    let missing = scene.path("nowhere").to_str().unwrap().to_string();
    let cases: [(&[&str], &str); 11] = [
        (&["run"], "expected --scene DIR"),
        (&["run", "--scene", &missing], "nowhere"),
        (&["run", "--scene", scene.root(), "--frames", "3..3"], "expected A..B with A < B"),
        (&["run", "--scene", scene.root(), "--frames", "7..9"], "expected frames 7..9"),
        (
            &["run", "--scene", scene.root(), "--perception", "eyes"],
            "or one of demo, florence2-internvl, light, ssdlite, paper",
        ),
        (
            &["run", "--scene", scene.root(), "--perception", "my eyes"],
            "expected labels, file:PATH",
        ),
        (&["run", "--scene", scene.root(), "--perception", "replay:no.jsonl"], "no.jsonl"),
        (
            &["run", "--scene", scene.root(), "--perception", "ssdlite", "--models", &missing],
            "ssdlite-mbv2",
        ),
        (&["run", "--scene", scene.root(), "--perception", "file:no.json"], "no.json"),
        (&["run", "--scene", scene.root(), "--questions", "no.json"], "no.json"),
        (&["graph", "--entities", "no.json"], "no.json"),
    ];
    for (arguments, expected) in cases {
        let ran = jrdb(arguments);
        assert_eq!(ran.code, 2, "{arguments:?}: {}", ran.out);
        contains(&ran.err, &[expected]);
    }
}

#[test]
fn a_model_that_is_no_model_is_named() {
    let scene = Scene::new();
    let models = scene.path("models");
    std::fs::create_dir(&models).unwrap();
    std::fs::write(models.join("ssdlite-mbv2-300-person.f16.onnx"), b"no model").unwrap();
    let models = models.to_str().unwrap();
    let ran = jrdb(&[
        "run",
        "--scene",
        scene.root(),
        "--perception",
        "ssdlite",
        "--engine",
        "rten",
        "--models",
        models,
    ]);
    assert_eq!(ran.code, 2);
    contains(&ran.err, &["ssdlite-mbv2-300-person.f16.onnx"]);
}

#[test]
fn the_wrong_artefact_is_refused_by_name() {
    let scene = Scene::new();
    let query = scene.path("q.json");
    jrdb(&["parse", "Find the male", "--out", query.to_str().unwrap()]);
    let ran = jrdb(&["graph", "--entities", query.to_str().unwrap()]);
    assert_eq!(ran.code, 2);
    contains(&ran.err, &[r#"expected a "jrdb.entities" artefact, found "jrdb.query""#]);
}

#[test]
fn unknown_words_are_underlined() {
    let ran = Scene::new().ask("Find the femlae persons");
    assert_eq!(ran.code, 0);
    contains(&ran.out, &["           ^^^^^^", r#"did you mean "female"?"#]);
}

#[test]
fn detections_of_other_programs_are_read() {
    let scene = Scene::new();
    let results = scene.path("results.json");
    let text = r#"[{"image_id": 0, "category_id": 1, "bbox": [194, 10, 12, 31], "score": 0.9}]"#;
    std::fs::write(&results, text).unwrap();
    let perception = format!("file:{}", results.display());
    let ran = jrdb(&[
        "run",
        "--scene",
        scene.root(),
        "--perception",
        &perception,
        "--query",
        "Find the person in front of me",
    ]);
    assert_eq!(ran.code, 0, "{}", ran.err);
    contains(&ran.out, &["answer  #1", "the file has nothing for two-people/000001"]);
}

#[test]
fn an_output_folder_that_cannot_be_made_is_failed_work() {
    let scene = Scene::new();
    let file = scene.path("file");
    std::fs::write(&file, b"").unwrap();
    let out: &Path = &file.join("out");
    let ran = jrdb(&[
        "run",
        "--scene",
        scene.root(),
        "--query",
        "Find the male",
        "--out",
        out.to_str().unwrap(),
    ]);
    assert_eq!(ran.code, 1, "{}", ran.out);
    contains(&ran.err, &["cannot write"]);
}

/// A robot with frames, sensors and file formats of its own, in the same place as the dataset's.
const OWN_RIG: &str = "
schema: jrdb.rig
schema_version: 2
data:
  base: base_link
  transforms:
    - { parent: mast, child: camera, rotation: { quaternion_wxyz: [0.5, -0.5, 0.5, -0.5] } }
    - { parent: base_link, child: mast }
    - { parent: mast, child: top, translation_m: [0, 0, 0.25] }
  cameras:
    - name: ring
      frame: camera
      lens: { model: cylindrical, width_px: 400, height_px: 60, focal_px: 51.5, horizon_px: 26.0 }
  lidars:
    - { name: top_lidar, frame: top }
";

/// The upper LiDAR's first sweep as rows of four little-endian floats.
fn as_bin(scene: &Scene) -> Vec<u8> {
    let cloud = jrdb_dataset::cloud::read(
        &scene.path(UPPER),
        "upper_velodyne",
        jrdb_dataset::cloud::Fields::All,
    )
    .unwrap();
    let rows = cloud.x.iter().zip(&cloud.y).zip(&cloud.z);
    rows.flat_map(|((x, y), z)| [*x, *y, *z, 0.0].map(f32::to_le_bytes)).flatten().collect()
}

#[test]
fn a_robot_of_ones_own_is_described_by_its_rig_file() {
    let scene = Scene::new();
    let sweep = scene.path("pointclouds/top_lidar/two-people/000000.bin");
    std::fs::create_dir_all(sweep.parent().unwrap()).unwrap();
    std::fs::write(&sweep, as_bin(&scene)).unwrap();
    let question = "who is to the left of the robot";
    let places = |extra: &[&str]| {
        let frame = ["--frames", "0..1", "--query", question];
        let ran = jrdb(&[&["run", "--scene", scene.root()], extra, &frame].concat());
        assert_eq!(ran.code, 0, "{}", ran.err);
        ran.out
    };
    // Without the lower LiDAR both robots see the same.
    std::fs::remove_dir_all(scene.path("pointclouds/lower_velodyne")).unwrap();
    let official = places(&[]);
    contains(&official, &["lower_velodyne/two-people/000000.pcd: no such file", "answer  #2"]);
    let rig = scene.path("rig.yaml");
    std::fs::write(&rig, OWN_RIG).unwrap();
    let own = places(&["--rig", rig.to_str().unwrap(), "--camera", "ring"]);
    let without_notes = |text: &str| {
        text.lines()
            .filter(|line| !line.contains("note: pointclouds"))
            .collect::<Vec<_>>()
            .join("\n")
    };
    assert_eq!(without_notes(&own), without_notes(&official));
    assert!(!own.contains("no such file"), "{own}");
    std::fs::rename(&rig, scene.path("calibration/rig.yaml")).unwrap();
    assert_eq!(places(&[]), own);
}

#[test]
fn a_rig_that_is_none_is_bad_input_and_says_what_is_wrong() {
    let scene = Scene::new();
    let rig = scene.path("rig.yaml");
    let check = |change: (&str, &str)| {
        std::fs::write(&rig, OWN_RIG.replace(change.0, change.1)).unwrap();
        let ran = jrdb(&["rig", "file", rig.to_str().unwrap()]);
        assert_eq!(ran.code, if change.0 == change.1 { 0 } else { 2 }, "{}", ran.err);
        ran.err + &ran.out
    };
    contains(
        &check(("mast", "mast")),
        &["base base_link, 3 transforms", "lidar top_lidar in frame top"],
    );
    contains(
        &check(("parent: base_link, child: mast", "parent: top, child: mast")),
        &["the cycle mast in top in mast"],
    );
    contains(
        &check(("0.5, -0.5, 0.5, -0.5", "0.5, -0.5, 0.5, 0.6")),
        &["quaternion of norm 1, found 1.0"],
    );
    contains(&check(("[0, 0, 0.25]", "[0, 0, .nan]")), &["rig.yaml"]);
    contains(
        &check(("focal_px: 51.5", "focal_px: 0")),
        &["ring", "expected focal_px to be finite and over 0, found 0"],
    );
    contains(&check(("horizon_px", "horizon")), &["rig.yaml", "horizon"]);
    contains(
        &check(("schema_version: 2", "schema_version: 1")),
        &["expected jrdb.rig version 2, found version 1"],
    );
}

#[test]
fn a_robot_that_stands_sees_who_moves_with_whom() {
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../../testdata/scenes/corridor");
    let out = TempDir::new().unwrap();
    let folder = out.path().to_str().unwrap();
    let ran = jrdb(&[
        "run",
        "--scene",
        scene,
        "--robot-stands",
        "--query",
        "people",
        "--out",
        folder,
        "--artifacts",
    ]);
    assert_eq!(ran.code, 0, "{}", ran.err);
    let text = std::fs::read_to_string(&tree::files(out.path(), "entities.json")[0]).unwrap();
    let entities: serde_json::Value = serde_json::from_str(&text).unwrap();
    let relations = entities["data"]["relations"].as_array().unwrap();
    let together = relations.iter().filter(|pair| {
        pair["words"].as_array().is_some_and(|words| words.contains(&"same_direction".into()))
    });
    let pairs: Vec<String> =
        together.map(|p| format!("{} {}", p["subject"], p["object"])).collect();
    assert!(pairs.contains(&r#""pedestrian:2" "pedestrian:3""#.into()), "{pairs:?}");
    assert!(
        !pairs.iter().any(|pair| pair.contains("pedestrian:8")),
        "pedestrian:8 stands: {pairs:?}"
    );
}

#[test]
fn a_recording_plays_what_was_recorded_and_broken_lines_are_told() {
    let scene = Scene::new();
    let out = scene.path("exchange");
    let out = out.to_str().unwrap();
    let ran = jrdb(&["exchange", "--scene", scene.root(), "--perception", "labels", "--out", out]);
    assert_eq!(ran.code, 0, "{}", ran.err);
    contains(&ran.out, &["exchange.jsonl", "without a reply"]);
    let file = format!("{out}/exchange.jsonl");
    let replay = format!("replay:{file}");
    let question = ["--query", "How many people are there?", "--format", "json"];
    let ask = |perception: &str| {
        let run = ["run", "--scene", scene.root(), "--perception", perception];
        jrdb(&[&run[..], &question[..]].concat())
    };
    let number = |ran: &Ran| {
        let value: serde_json::Value = serde_json::from_str(&ran.out).unwrap();
        value["answers"][0]["data"]["reply"]["number"].as_u64().unwrap()
    };
    assert!(number(&ask("labels")) > 0);
    assert_eq!(number(&ask(&replay)), number(&ask("labels")));
    std::fs::write(&file, "{\"reply\": {}}\n").unwrap();
    let broken = ask(&replay);
    assert_eq!(broken.code, 2);
    contains(&broken.err, &["exchange.jsonl", "line 1"]);
}

#[test]
fn the_demo_says_that_it_knows_drawings_only() {
    let scene = Scene::new();
    let models = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models");
    let run = ["run", "--scene", scene.root(), "--perception", "demo", "--models", models];
    let ran =
        jrdb(&[&run[..], &["--engine", "rten", "--query", "Who is there?", "--profile"]].concat());
    assert_eq!(ran.code, 0, "{}", ran.err);
    contains(&ran.out, &["trained on drawings and know nothing else"]);
    contains(&ran.err, &["florence2/vision_encoder", "internvl35/decoder_model_merged", "calls/s"]);
    let nowhere =
        jrdb(&["run", "--scene", scene.root(), "--perception", "demo", "--models", "nowhere"]);
    assert_eq!(nowhere.code, 2);
    contains(&nowhere.err, &["nowhere/demo/florence2"]);
}

#[test]
fn a_graph_under_another_graph_s_name_is_told_before_any_frame() {
    let scene = Scene::new();
    let demo = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models/demo/florence2");
    let models = scene.path("models");
    let folder = models.join("demo/florence2");
    std::fs::create_dir_all(folder.join("onnx")).unwrap();
    for file in ["config", "generation_config", "preprocessor_config", "tokenizer"] {
        let file = format!("{file}.json");
        std::fs::copy(demo.join(&file), folder.join(&file)).unwrap();
    }
    for graph in ["vision_encoder", "embed_tokens", "encoder_model", "decoder_model_merged"] {
        let to = folder.join(format!("onnx/{graph}.onnx"));
        std::fs::copy(demo.join("onnx/embed_tokens.onnx"), to).unwrap();
    }
    let models = models.to_str().unwrap();
    let ran = jrdb(&["run", "--scene", scene.root(), "--perception", "demo", "--models", models]);
    assert_eq!(ran.code, 2);
    contains(&ran.err, &["demo/florence2", r#"found ["input_ids", "inputs_embeds"]"#]);
}

#[test]
fn a_baseline_is_answered_by_the_detector_alone() {
    let scene = Scene::new();
    let models = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models");
    let run = ["run", "--scene", scene.root(), "--baseline", "--query", "Find the persons"];
    let alone =
        ["--perception", "demo", "--models", models, "--engine", "rten", "--format", "json"];
    let ran = jrdb(&[&run[..], &alone[..]].concat());
    assert_eq!(ran.code, 0, "{}", ran.err);
    let value: serde_json::Value = serde_json::from_str(&ran.out).unwrap();
    let answer = &value["answers"][0]["data"];
    assert!(!answer["selection"].as_array().unwrap().is_empty());
    assert!(answer["trace"].as_array().unwrap().is_empty());
    let labels = jrdb(&run);
    assert_eq!(labels.code, 2);
    contains(&labels.err, &["expected a detector that takes sentences"]);
}

#[test]
fn what_people_wear_on_the_head_comes_from_a_detections_file_and_can_be_asked() {
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata/scenes/plaza");
    let (root, file) = (scene.display().to_string(), scene.join("detections.json"));
    let text = std::fs::read_to_string(&file).unwrap();
    let capped = text.matches(r#""cap": 1.0"#).count();
    assert!(capped > 0, "somebody on the plaza wears a cap");
    let source = format!("file:{}", file.display());
    let count = "How many people with a cap are there?";
    let ran = jrdb(&["run", "--scene", &root, "--perception", &source, "--query", count]);
    contains(&ran.out, &[&format!("answer  {capped}: #")]);
    let nobody = "Is there nobody with a helmet?";
    let ran = jrdb(&["run", "--scene", &root, "--perception", &source, "--query", nobody]);
    contains(&ran.out, &["answer  yes"]);
}

#[test]
fn several_sequences_of_a_tree_are_answered_and_an_unknown_one_is_told_the_known() {
    let scene = Scene::new();
    for folder in
        ["images/image_stitched", "pointclouds/upper_velodyne", "pointclouds/lower_velodyne"]
    {
        let [from, to] = ["two-people", "again"].map(|name| scene.path(folder).join(name));
        std::fs::create_dir(&to).unwrap();
        for file in tree::files(&from, "") {
            std::fs::copy(&file, to.join(file.file_name().unwrap())).unwrap();
        }
    }
    for folder in ["labels_2d_stitched", "labels_3d", "labels_2d_activity_social_stitched"] {
        let labels = scene.path("labels").join(folder);
        std::fs::copy(labels.join("two-people.json"), labels.join("again.json")).unwrap();
    }
    let run = ["run", "--dataset", scene.root(), "--query", "Find the male", "--frames", "0..1"];
    let ran = jrdb(&[&run[..], &["--sequence", "two-people", "--sequence", "again"]].concat());
    assert_eq!(ran.code, 0, "{}", ran.err);
    contains(&ran.out, &["two-people/000000", "again/000000"]);
    let ran = jrdb(&[&run[..], &["--sequence", "two"]].concat());
    assert_eq!(ran.code, 2);
    contains(&ran.err, &["of sequence \"two\", found the sequences", "two-people"]);
    let ran = jrdb(&[&run[..], &["--sequence", "../image_stitched/two-people"]].concat());
    assert_eq!(ran.code, 2);
    contains(&ran.err, &["expected a sequence name"]);
}

#[test]
fn a_tree_without_labels_says_what_to_do() {
    let scene = Scene::new();
    std::fs::remove_dir_all(scene.path("labels")).unwrap();
    let ran = scene.ask("Find the male");
    assert_eq!(ran.code, 2);
    contains(&ran.err, &["expected labels of two-people", "--perception"]);
}

#[test]
fn a_name_that_is_no_folder_is_refused_by_synth_and_a_full_disk_is_failed_work() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("a/b/out");
    let synth = ["synth", "--people", "1", "--out", out.to_str().unwrap()];
    for name in ["..", ".", "", "../../escaped", "/escaped", "a\nb", "a\\b"] {
        let ran = jrdb(&[&synth[..], &["--sequence", name]].concat());
        assert_eq!(ran.code, 2, "{name:?}");
        contains(&ran.err, &["expected a sequence name"]);
    }
    assert!(!folder.path().join("a").exists());
    std::fs::write(folder.path().join("a"), b"").unwrap();
    let ran = jrdb(&synth);
    assert_eq!(ran.code, 1, "{}", ran.err);
    contains(&ran.err, &["cannot write"]);
}

/// Runs `jrdb` with a text on its standard input.
fn jrdb_reading(arguments: &[&str], text: &str) -> Ran {
    use std::io::Write as _;
    let mut command = Command::new(env!("CARGO_BIN_EXE_jrdb"));
    command.args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    child.stdin.take().unwrap().write_all(text.as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    Ran { code: output.status.code().unwrap(), out: text(output.stdout), err: text(output.stderr) }
}

#[test]
fn each_line_of_standard_input_is_a_question() {
    let scene = Scene::new();
    let out = scene.path("run");
    let run = ["run", "--scene", scene.root(), "--query", "Find the male", "--artifacts", "--out"];
    assert_eq!(jrdb(&[&run[..], &[out.to_str().unwrap()]].concat()).code, 0);
    let graph = tree::files(&out, "scene_graph.json")[0].to_str().unwrap().to_owned();
    let search = ["search", "--graph", &graph, "--text", "-", "--format", "json"];
    let ran = jrdb_reading(&search, "Find the male\r\n\nFind the female\n");
    assert_eq!(ran.code, 0, "{}", ran.err);
    assert_eq!(ran.out.matches("\"jrdb.answer\"").count(), 2);
    let ran = jrdb_reading(&["parse", "-"], "Find the male\nFind the female\n");
    assert_eq!(ran.code, 2);
    contains(&ran.err, &["expected one question, found 2 lines"]);
}

#[test]
fn unanswered_questions_are_missed_and_answers_to_nothing_are_no_result() {
    let plaza = concat!(env!("CARGO_MANIFEST_DIR"), "/../../testdata/scenes/plaza");
    let folder = TempDir::new().unwrap();
    let out = folder.path().to_str().unwrap();
    let query = "How many people are there?";
    assert_eq!(jrdb(&["run", "--scene", plaza, "--query", query, "--out", out]).code, 0);
    let answer = tree::files(folder.path(), "answer.json")[0].clone();
    let answers = answer.to_str().unwrap();
    let file = folder.path().join("questions.json");
    let listed = std::fs::read_to_string(Path::new(plaza).join("questions.json")).unwrap();
    let listed: serde_json::Value = serde_json::from_str(&listed).unwrap();
    let question = |text: &str| {
        let mut one = listed[0].clone();
        one["question"]["question"] = text.into();
        one.to_string()
    };
    let ask = |texts: &[&str]| {
        let all: Vec<String> = texts.iter().map(|text| question(text)).collect();
        std::fs::write(&file, format!("[{}]", all.join(","))).unwrap();
        let evaluate = ["evaluate", "--questions", file.to_str().unwrap(), "--answers", answers];
        (jrdb(&evaluate), jrdb(&[&evaluate[..], &["--answers", answers]].concat()))
    };
    let (ran, twice) = ask(&[query, "Who is it?", "Where is it?"]);
    assert_eq!(ran.code, 0, "{}", ran.err);
    contains(&ran.err, &["2 of 3 questions have no answer and count as missed", "Where is it?"]);
    assert_eq!(twice.code, 2);
    contains(&twice.err, &["expected one answer to \"How many people are there?\""]);
    let (ran, _) = ask(&["Who is it?"]);
    assert_eq!(ran.code, 1);
    contains(&ran.err, &["expected answers to questions of", "found none"]);
}

#[test]
fn an_artefact_of_an_earlier_version_is_brought_to_the_present_one() {
    let folder = TempDir::new().unwrap();
    let (old, new) = (folder.path().join("old.json"), folder.path().join("new.json"));
    let rig = r#"{"schema": "jrdb.rig", "schema_version": 1, "producer": {"name": "jrdb", "version": "0"}, "config": null,
        "data": {"panorama": {"width_px": 400, "height_px": 60, "focal_px": 51.5, "horizon_px": 26.0},
        "lidars": [{"name": "upper_velodyne", "offset_m": [0, 0, -0.25], "yaw_rad": 0.0}]}}"#;
    std::fs::write(&old, rig).unwrap();
    let [old, new] = [&old, &new].map(|path| path.to_str().unwrap());
    let ran = jrdb(&["migrate", old, "--out", new]);
    assert_eq!(ran.code, 0, "{}", ran.err);
    assert_eq!(jrdb(&["rig", "file", new]).code, 0);
    let scene = Scene::new();
    let ran = jrdb(&["run", "--scene", scene.root(), "--rig", new, "--query", "Find the male"]);
    assert_eq!(ran.code, 0, "{}", ran.err);
    contains(&ran.out, &["answer  #1"]);
}

#[test]
fn a_picture_whose_decoder_panics_costs_itself_only() {
    let scene = Scene::new();
    scene.change(IMAGE, |png| {
        // A palette of 4 bytes after the header: image-png 0.18.1 panics on it.
        let (head, rest) = png.split_at(33);
        [head, &[0, 0, 0, 4], b"PLTE", &[1, 2, 3, 4, 0, 0, 0, 0], rest].concat()
    });
    let out = scene.path("out");
    let query = ["run", "--scene", scene.root(), "--query", "Find the male", "--out"];
    let ran = jrdb(&[&query[..], &[out.to_str().unwrap()]].concat());
    assert_eq!(ran.code, 0, "{}", ran.err);
    contains(&ran.out, &[IMAGE, "found 4 bytes in PLTE", "two-people/000001", "answer  #1"]);
}

#[test]
fn info_describes_what_there_is_and_names_the_next_command() {
    let scene = Scene::new();
    let about = |path: &str| {
        let ran = jrdb(&["info", path]);
        assert_eq!(ran.code, 0, "{}", ran.err);
        ran.out
    };
    let tree = about(scene.root());
    contains(&tree, &["a dataset in JRDB's form", "sequence two-people:", "jrdb run --scene"]);
    contains(&about(scene.path(UPPER).to_str().unwrap()), &["a point cloud", "points", "z from"]);
    let json = jrdb(&["info", scene.root(), "--format", "json"]).out;
    contains(&json, &["\"kind\": \"dataset\"", "\"next\": \"jrdb run"]);
    assert_eq!(jrdb(&["info", "nowhere"]).code, 2);
}

#[test]
fn the_columns_of_a_cloud_without_a_header_can_be_stated() {
    let scene = Scene::new();
    let rows = as_bin(&scene);
    let reversed = rows.chunks(16).flat_map(|row| {
        let [x, y, z] = [0, 4, 8].map(|at| row[at..at + 4].to_vec());
        [z, y, x].concat()
    });
    let bin = scene.path(UPPER).with_extension("bin");
    std::fs::write(bin, reversed.collect::<Vec<u8>>()).unwrap();
    let whole = scene.ask("who is closest to me");
    std::fs::remove_file(scene.path(UPPER)).unwrap();
    let stated = ["--cloud-columns", "z,y,x", "--query", "who is closest to me"];
    let ran = jrdb(&[&["run", "--scene", scene.root()], &stated[..]].concat());
    assert_eq!((ran.code, ran.out), (0, whole.out), "{}", ran.err);
    let bad = jrdb(&["run", "--scene", scene.root(), "--cloud-columns", "x,y"]);
    assert!(bad.code == 2 && bad.err.contains("expected columns such as"), "{}", bad.err);
}
