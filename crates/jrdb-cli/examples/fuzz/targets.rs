//! What is fuzzed: every reader of files of the outside world, with sound inputs to start from.

use std::io::Cursor;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use jrdb_cli::{Run, RunOptions, migrate, source::Source};
use jrdb_dataset::cloud::{BinLayout, Format};
use jrdb_dataset::{Dataset, OfficialCalibration, PngCompression, pcd};
use jrdb_parser::ParserConfig;
use jrdb_perception::exchange::{Exchange, replay};
use jrdb_perception::generation::Tokens;
use jrdb_perception::prompts::Topic;
use jrdb_perception::{RtenEngine, count_parameters};
use jrdb_synth::SynthConfig;
use jrdb_types::{
    Answer, Artefact, Detections, Entities, FrameId, Image, ImageGeometry, Payload, Query, Rig,
    SceneGraph,
};
use serde_json::Value;

use crate::mutate::Structure;

/// Reads an input; whether it was accepted.
type Read = Box<dyn Fn(&[u8], &Path) -> bool>;

/// A reader, and inputs that it accepts.
pub(crate) struct Target {
    pub(crate) name: &'static str,
    pub(crate) structure: Structure,
    pub(crate) seeds: Vec<Vec<u8>>,
    /// The second argument is a folder of its own.
    pub(crate) read: Read,
}

fn target(
    name: &'static str,
    structure: Structure,
    seeds: Vec<Vec<u8>>,
    read: impl Fn(&[u8], &Path) -> bool + 'static,
) -> Target {
    Target { name, structure, seeds, read: Box::new(read) }
}

/// All targets. Seeds are made in `folder`.
pub(crate) fn all(folder: &Path) -> Result<Vec<Target>> {
    let scene = folder.join("scene");
    let config = SynthConfig { people: 3, sequence: "fuzz_0".into(), ..SynthConfig::default() };
    jrdb_synth::write(&jrdb_synth::generate(&config), &scene)?;
    let mut targets = pictures()?;
    targets.extend(clouds(&scene)?);
    targets.extend(files(&scene)?);
    targets.extend(artefacts(&scene)?);
    targets.extend(words()?);
    Ok(targets)
}

fn read(path: &Path) -> Result<Vec<u8>> {
    std::fs::read(path).with_context(|| format!("cannot read {}", path.display()))
}

fn workspace(inside: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(inside)
}

fn pictures() -> Result<Vec<Target>> {
    let image = Image::filled(40, 24, [90, 120, 30]);
    let pngs = vec![
        jrdb_dataset::encode_png(&image, PngCompression::Quick),
        jrdb_dataset::encode_png(&image, PngCompression::Small),
    ];
    let jpegs = ["gradient.jpg", "gradient_progressive.jpg", "gradient_grey.jpg"];
    let jpegs = jpegs.map(|name| read(&workspace("crates/jrdb-dataset/testdata").join(name)));
    let decode = |bytes: &[u8], _: &Path| jrdb_dataset::decode_image(bytes).is_ok();
    Ok(vec![
        target("png", Structure::Png, pngs, decode),
        target("jpeg", Structure::Jpeg, jpegs.into_iter().collect::<Result<_>>()?, decode),
    ])
}

fn clouds(scene: &Path) -> Result<Vec<Target>> {
    let path = scene.join("pointclouds/upper_velodyne/fuzz_0/000000.pcd");
    let mut cloud = pcd::parse(&read(&path)?, "upper_velodyne")?;
    for axis in [&mut cloud.x, &mut cloud.y, &mut cloud.z] {
        axis.truncate(60);
    }
    cloud.intensity.truncate(60);
    let points = || cloud.x.iter().zip(&cloud.y).zip(&cloud.z).map(|((x, y), z)| [*x, *y, *z, 1.0]);
    let floats: Vec<u8> = points().flatten().flat_map(f32::to_le_bytes).collect();
    let mut head = String::from("{'descr': '<f4', 'fortran_order': False, 'shape': (60, 4), }");
    head.push_str(&" ".repeat(117 - head.len()));
    head.push('\n');
    let length = u16::try_from(head.len()).unwrap_or_default().to_le_bytes();
    let npy = [b"\x93NUMPY\x01\x00", &length[..], head.as_bytes(), &floats].concat();
    let properties = "property float x\nproperty float y\nproperty float z\nproperty float i\n";
    let ply = |form: &str, body: &[u8]| {
        let head = format!("ply\nformat {form} 1.0\nelement vertex 60\n{properties}end_header\n");
        [head.as_bytes(), body].concat()
    };
    let rows: String = points().map(|[x, y, z, i]| format!("{x} {y} {z} {i}\n")).collect();
    let plys = vec![ply("ascii", rows.as_bytes()), ply("binary_little_endian", &floats)];
    let encodings = [pcd::Encoding::Ascii, pcd::Encoding::Binary, pcd::Encoding::BinaryCompressed];
    let pcds = encodings.map(|encoding| pcd::write(&cloud, encoding)).to_vec();
    let parse = |format: Format| move |bytes: &[u8], _: &Path| format.parse(bytes, "lidar").is_ok();
    Ok(vec![
        target("pcd", Structure::Pcd, pcds, parse(Format::Pcd)),
        target("bin", Structure::Bytes, vec![floats], parse(Format::Bin(BinLayout::Kitti))),
        target("npy", Structure::Text, vec![npy], parse(Format::Npy)),
        target("ply", Structure::Text, plys, parse(Format::Ply)),
    ])
}

/// A target whose reader takes a file of this name.
fn of_file(
    name: &'static str,
    structure: Structure,
    seeds: Vec<Vec<u8>>,
    file: &'static str,
    read: impl Fn(&Path) -> bool + 'static,
) -> Target {
    target(name, structure, seeds, move |bytes, folder| {
        let path = folder.join(file);
        let folders = path.parent().map(std::fs::create_dir_all);
        folders.is_some_and(|made| made.is_ok())
            && std::fs::write(&path, bytes).is_ok()
            && read(&path)
    })
}

const IMAGE: ImageGeometry = ImageGeometry { width_px: 3760, height_px: 480, wraps: true };
const LABELS: [(&str, &str); 3] = [
    ("labels", "labels/labels_2d_stitched/fuzz_0.json"),
    ("labels-3d", "labels/labels_3d/fuzz_0.json"),
    ("labels-social", "labels/labels_2d_activity_social_stitched/fuzz_0.json"),
];

fn files(scene: &Path) -> Result<Vec<Target>> {
    let mut targets = Vec::new();
    for (name, file) in [("cameras.yaml", "cameras.yaml"), ("defaults.yaml", "defaults.yaml")] {
        let calibration = scene.join("calibration");
        let seed = vec![read(&calibration.join(file))?];
        targets.push(target(name, Structure::Text, seed, move |bytes, folder| {
            for other in ["cameras.yaml", "defaults.yaml"] {
                let _ = std::fs::copy(calibration.join(other), folder.join(other));
            }
            let written = std::fs::write(folder.join(file), bytes);
            written.is_ok() && OfficialCalibration::read(folder).is_ok()
        }));
    }
    let rig = Dataset::open(scene)?.rig()?;
    let rig = vec![Artefact::new(Value::Null, rig).to_json().into_bytes()];
    let read_rig = |path: &Path| jrdb_dataset::rig::read(path).is_ok();
    targets.push(of_file("rig.json", Structure::Json, rig.clone(), "rig.json", read_rig));
    targets.push(of_file("rig.yaml", Structure::Json, rig, "rig.yaml", read_rig));
    for (name, file) in LABELS {
        let seed = vec![read(&scene.join(file))?];
        targets.push(of_file(name, Structure::Json, seed, file, |path| {
            let root = path.ancestors().nth(3).unwrap_or(path);
            let labels = Dataset::open(root).and_then(|dataset| dataset.labels("fuzz_0"));
            let frame = FrameId { sequence: "fuzz_0".into(), frame: 0 };
            labels.is_ok_and(|labels| labels.detections(&frame, IMAGE).frame == frame)
        }));
    }
    let detections = read(&scene.join("detections.json"))?;
    let coco = br#"[{"image_id": 0, "category_id": 1, "bbox": [10, 20, 30, 90], "score": 0.9}]"#;
    targets.push(of_file(
        "detections",
        Structure::Json,
        vec![detections, coco.to_vec()],
        "detections.json",
        |path| jrdb_dataset::read_detections(path, "fuzz_0", IMAGE).is_ok(),
    ));
    let questions = vec![read(&scene.join("questions.json"))?];
    targets.push(of_file("questions", Structure::Json, questions, "questions.json", |path| {
        jrdb_dataset::read_questions(path).is_ok()
    }));
    Ok(targets)
}

fn artefacts(scene: &Path) -> Result<Vec<Target>> {
    let options =
        RunOptions { sources: vec![Source::Scene(scene.into())], ..RunOptions::default() };
    let mut targets = Vec::new();
    Run::open(&options)?.execute(|result| {
        if let Ok(output) = &result.output {
            let lines = Exchange::record(output.scene.detections(), &Topic::ALL);
            targets.push(recording(&lines));
            targets.push(artefact::<Detections>("artefact-detections", output.scene.detections()));
            targets.push(artefact::<Entities>("artefact-entities", output.scene.entities()));
            targets.push(artefact::<SceneGraph>("artefact-graph", output.scene.graph()));
            if let Some(answered) = output.answered.first() {
                targets.push(artefact::<Query>("artefact-query", &answered.query));
                targets.push(artefact::<Answer>("artefact-answer", &answered.answer));
            }
        }
        std::ops::ControlFlow::Continue(())
    })?;
    let rig = Dataset::open(scene)?.rig()?;
    targets.push(artefact::<Rig>("artefact-rig", &rig));
    Ok(targets)
}

fn artefact<T: Payload + Clone>(name: &'static str, data: &T) -> Target {
    let seed = Artefact::new(Value::Null, data.clone()).to_json().into_bytes();
    target(name, Structure::Json, vec![seed], |bytes, _| {
        let text = String::from_utf8_lossy(bytes);
        let _ = migrate::migrate(&text);
        Artefact::<T>::from_json(&text).is_ok()
    })
}

fn recording(lines: &[Exchange]) -> Target {
    let lines: Vec<String> =
        lines.iter().map(|line| serde_json::to_string(line).unwrap_or_default()).collect();
    let seed = lines.join("\n").into_bytes();
    target("replay", Structure::JsonLines, vec![seed], |bytes, _| {
        let read = Exchange::read_lines(&String::from_utf8_lossy(bytes));
        let frame = FrameId { sequence: "fuzz_0".into(), frame: 0 };
        read.is_ok_and(|lines| replay(&lines, &frame, IMAGE).frame == frame)
    })
}

fn words() -> Result<Vec<Target>> {
    let sentences = std::fs::read_to_string(workspace("testdata/scenes/plaza/questions.json"))?;
    let all: Vec<Value> = serde_json::from_str(&sentences)?;
    let text =
        |one: &Value| one["question"]["question"].as_str().map(|text| text.as_bytes().to_vec());
    let mut questions: Vec<Vec<u8>> = all.iter().filter_map(text).collect();
    let notation = "find person[female, sitting, at direction=left: person[child], distance=close]";
    questions.push(notation.into());
    let tokenizer = vec![read(&workspace("models/demo/internvl35/tokenizer.json"))?];
    let graph = vec![read(&workspace("models/demo/internvl35/onnx/embed_tokens.onnx"))?];
    // With branches and constants.
    let decoder = "models/demo/internvl35/onnx/decoder_model_merged.onnx";
    let decoder = vec![read(&workspace(decoder))?];
    Ok(vec![
        target("onnx", Structure::Bytes, graph, |bytes, _| RtenEngine::from_onnx(bytes).is_ok()),
        target("parameters", Structure::Bytes, decoder, |bytes, _| {
            count_parameters(Cursor::new(bytes), bytes.len() as u64).is_ok()
        }),
        target("question", Structure::Text, questions, |bytes, _| {
            let text = String::from_utf8_lossy(bytes);
            jrdb_pipeline::read_query(&text, &ParserConfig::default()).is_ok()
        }),
        target("tokenizer", Structure::Json, tokenizer, |bytes, _| {
            let tokens = Tokens::from_json(&String::from_utf8_lossy(bytes));
            tokens.is_ok_and(|tokens| {
                let ids = tokens.encode_input("Is the person male or female?").unwrap_or_default();
                tokens.decode(&ids).is_ok()
            })
        }),
    ])
}
