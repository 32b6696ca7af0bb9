//! What a run leaves in its `--out` folder.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use jrdb_dataset::PngCompression;
use jrdb_draw::{Caption, FrameView, draw_panorama, draw_top_view};
use jrdb_models::sha256_hex;
use jrdb_pipeline::PipelineConfig;
use jrdb_types::{Artefact, Detections, FrameId, Image, Payload, Question, Scores};
use rayon::prelude::*;
use serde_json::{Value, json};

use crate::Error;
use crate::inputs::Inputs;
use crate::questions::Answered;
use crate::result::FrameOutput;

/// File of the digests of a frame's inputs; it is written last, so a frame that has it is complete.
const INPUTS_FILE: &str = "inputs.json";
/// Hexadecimal digits of a question's digest in the name of its folder: two of a million questions
/// agree in one of a hundred thousand cases.
const DIGEST_DIGITS: usize = 14;
/// Longest id of a question that becomes part of its folder's name.
const ID_MAX: usize = 64;

/// Where the files of a frame are: `SEQUENCE/000012`.
fn frame_folder(root: &Path, frame: &FrameId) -> PathBuf {
    root.join(&frame.sequence).join(format!("{:06}", frame.frame))
}

/// Name of the folder of a question's files: it depends on the question alone.
fn question_folder(question: &Question) -> String {
    if let Some(id) = question.id.as_ref().filter(|id| is_file_name(id)) {
        return format!("q-{id}");
    }
    let slots =
        if question.slots.is_empty() { String::new() } else { json!(question.slots).to_string() };
    let digest = sha256_hex(format!("{}\n{slots}", question.text).as_bytes());
    format!("q{}", &digest[..DIGEST_DIGITS])
}

/// Whether an id can be part of a file's name on every system.
fn is_file_name(id: &str) -> bool {
    let is_plain =
        |byte: u8| byte.is_ascii_lowercase() || byte.is_ascii_digit() || b"-_".contains(&byte);
    (1..=ID_MAX).contains(&id.len()) && id.bytes().all(is_plain)
}

/// The folders of a frame's questions. A question that is asked again has a number behind its name.
fn question_folders<'q>(questions: impl Iterator<Item = &'q Question>) -> Vec<String> {
    let mut seen = BTreeMap::new();
    let name = |question: &Question| {
        let name = question_folder(question);
        let count = seen.entry(name.clone()).and_modify(|count| *count += 1).or_insert(1_usize);
        if *count == 1 { name } else { format!("{name}-{count}") }
    };
    questions.map(name).collect()
}

/// Writes answers, pictures and artefacts.
pub struct Writer {
    root: PathBuf,
    config: Arc<PipelineConfig>,
    written: Written,
}

/// What is written of a frame.
#[derive(Debug, Clone, PartialEq)]
pub enum Written {
    /// Answers and pictures.
    Answers,
    /// Every stage's artefact, too; the value is perception's configuration.
    Artefacts(Value),
}

impl Writer {
    /// A writer below `root`.
    #[must_use]
    pub fn new(root: &Path, config: Arc<PipelineConfig>, written: Written) -> Self {
        Self { root: root.into(), config, written }
    }

    /// Whether an earlier run into this folder completed a frame with the same inputs.
    #[must_use]
    pub fn has(&self, frame: &FrameId, inputs: &Inputs) -> bool {
        let path = frame_folder(&self.root, frame).join(INPUTS_FILE);
        let text = std::fs::read_to_string(path).unwrap_or_default();
        serde_json::from_str::<Inputs>(&text).is_ok_and(|there| there == *inputs)
    }

    /// The detections that an earlier run has written of a frame.
    #[must_use]
    pub fn detections(&self, frame: &FrameId) -> Option<Detections> {
        let folder = frame_folder(&self.root, frame);
        read_artefact(&folder.join("detections.json")).ok()
    }

    /// Writes what one frame came to: `answer.json`, `panorama.png` and `top_view.png` per question, the stages' artefacts
    /// when they are asked for, and last the digests of its inputs.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub fn frame(&self, output: &FrameOutput, inputs: &Inputs) -> Result<(), Error> {
        let scene = &output.scene;
        let folder = frame_folder(&self.root, scene.id());
        if let Written::Artefacts(perception) = &self.written {
            let (projection, graph) = (json!(self.config.projection), json!(self.config.graph));
            let file = |name: &str| folder.join(name);
            write_artefact(&file("detections.json"), perception.clone(), scene.detections())?;
            write_artefact(&file("entities.json"), projection, scene.entities())?;
            write_artefact(&file("scene_graph.json"), graph, scene.graph())?;
        }
        let view = FrameView {
            geometry: scene.detections().image,
            image: scene.image(),
            cloud: Some(scene.cloud()),
            entities: &scene.entities().entities,
        };
        if output.answered.is_empty() {
            pictures(&folder, &view, None, Drawn::Now)?;
        }
        // Pictures take most of the time of a run, and each stands alone.
        let folders = question_folders(output.answered.iter().map(|one| &one.question));
        let drawn = if self.has(scene.id(), inputs) { Drawn::Earlier } else { Drawn::Now };
        let questions = output.answered.par_iter().zip(&folders);
        questions
            .try_for_each(|(one, name)| self.question(&folder.join(name), &view, one, drawn))?;
        let text = serde_json::to_string_pretty(inputs).unwrap_or_default();
        write(&folder.join(INPUTS_FILE), format!("{text}\n").as_bytes())
    }

    fn question(
        &self,
        folder: &Path,
        view: &FrameView<'_>,
        answered: &Answered,
        drawn: Drawn,
    ) -> Result<(), Error> {
        let (question, answer) = (&answered.question.text, &answered.answer);
        if matches!(self.written, Written::Artefacts(_)) {
            let config = json!(self.config.parser);
            write_artefact(&folder.join("query.json"), config, &*answered.query)?;
        }
        let worded = jrdb_render::with_words(answer.clone());
        write_artefact(&folder.join("answer.json"), json!(self.config.search), &worded)?;
        pictures(folder, view, Some(Caption { question, answer }), drawn)
    }

    /// Writes the answer to a question about a recording: `SEQUENCE/recording/QUESTION/answer.json`.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn recording(&self, answered: &Answered) -> Result<(), Error> {
        let folder = self.root.join(&answered.answer.frame.sequence).join("recording");
        let path = folder.join(question_folder(&answered.question)).join("answer.json");
        let answer = jrdb_render::with_words(answered.answer.clone());
        write_artefact(&path, json!(self.config.search), &answer)
    }

    /// Writes `scores.json`.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn scores(&self, scores: &Scores) -> Result<(), Error> {
        write_artefact(&self.root.join("scores.json"), json!(self.config.metrics), scores)
    }
}

/// When a frame's pictures are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Drawn {
    /// In this run.
    Now,
    /// In an earlier run from the same inputs: those that are there stay.
    Earlier,
}

fn pictures(
    folder: &Path,
    view: &FrameView<'_>,
    caption: Option<Caption<'_>>,
    drawn: Drawn,
) -> Result<(), Error> {
    let files = ["panorama.png", "top_view.png"].map(|name| folder.join(name));
    if drawn == Drawn::Earlier && files.iter().all(|path| path.is_file()) {
        return Ok(());
    }
    let png = |image: &Image| jrdb_dataset::encode_png(image, PngCompression::Quick);
    write(&files[0], &png(&draw_panorama(view, caption)))?;
    write(&files[1], &png(&draw_top_view(view, caption)))
}

/// Writes an artefact, with the folders it needs.
///
/// # Errors
/// When the file cannot be written.
pub fn write_artefact<T: Payload + Clone>(
    path: &Path,
    config: Value,
    data: &T,
) -> Result<(), Error> {
    write(path, Artefact::new(config, data.clone()).to_json().as_bytes())
}

/// Reads an artefact's data.
///
/// # Errors
/// When the file cannot be read or is not that artefact.
pub fn read_artefact<T: Payload>(path: &Path) -> Result<T, Error> {
    let text = std::fs::read_to_string(path).map_err(|source| Error::file("read", path, source))?;
    let artefact = Artefact::from_json(&text)
        .map_err(|source| Error::Artefact { path: path.into(), source })?;
    Ok(artefact.data)
}

/// Writes a file, with the folders it needs, whole or not at all.
///
/// # Errors
/// When the file cannot be written.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    Ok(jrdb_dataset::write_file(path, bytes)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(text: &str) -> Question {
        let frame = FrameId { sequence: "cafe".into(), frame: 12 };
        Question::typed(text, frame)
    }

    #[test]
    fn a_questions_folder_depends_on_the_question_alone() {
        let [near, far] = ["who is near me?", "who is far away?"].map(asked);
        let folders = |questions: &[&Question]| question_folders(questions.iter().copied());
        let (alone, beside) = (folders(&[&near]), folders(&[&far, &near]));
        assert_eq!(alone[0], beside[1]);
        assert_ne!(beside[0], beside[1]);
        assert_eq!(alone[0].len(), 1 + DIGEST_DIGITS);
        let twice = folders(&[&near, &far, &near]);
        assert_eq!((&twice[0], &twice[2]), (&alone[0], &format!("{}-2", alone[0])));
        let in_time = Question { slots: vec![vec![0, 1]], ..near.clone() };
        assert_ne!(folders(&[&in_time]), alone);
    }

    #[test]
    fn a_frames_folder_depends_on_the_frame_alone() {
        let frame = FrameId { sequence: "cafe".into(), frame: 12 };
        assert_eq!(frame_folder(Path::new("out"), &frame), Path::new("out/cafe/000012"));
    }
}
