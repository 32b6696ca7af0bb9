//! What a run leaves in its `--out` folder.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use jrdb_dataset::PngCompression;
use jrdb_draw::{Caption, FrameView, draw_panorama, draw_top_view};
use jrdb_pipeline::PipelineConfig;
use jrdb_types::{Artefact, FrameId, Image, Payload, Scores};
use rayon::prelude::*;
use serde_json::{Value, json};

use crate::Error;
use crate::questions::Answered;
use crate::result::FrameOutput;

/// How the output folder is divided: one level per sequence, frame and question, each left out where
/// there is only one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layout {
    by_sequence: bool,
    by_frame: bool,
    by_question: bool,
}

impl Layout {
    /// The layout for these frames with at most `questions` questions each.
    #[must_use]
    pub fn of(frames: &[&FrameId], questions: usize) -> Self {
        let sequences = frames.iter().any(|frame| frame.sequence != frames[0].sequence);
        let numbers = frames.windows(2).any(|pair| pair[0].sequence == pair[1].sequence);
        Self { by_sequence: sequences, by_frame: numbers, by_question: questions > 1 }
    }

    fn frame(self, root: &Path, frame: &FrameId) -> PathBuf {
        let sequence =
            if self.by_sequence { root.join(&frame.sequence) } else { root.to_path_buf() };
        if self.by_frame { sequence.join(format!("{:06}", frame.frame)) } else { sequence }
    }

    fn question(self, frame: &Path, number: usize) -> PathBuf {
        if self.by_question { frame.join(format!("q{number:02}")) } else { frame.to_path_buf() }
    }
}

/// Writes answers, pictures and artefacts.
pub struct Writer {
    root: PathBuf,
    layout: Layout,
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
    pub fn new(root: &Path, layout: Layout, config: Arc<PipelineConfig>, written: Written) -> Self {
        Self { root: root.into(), layout, config, written }
    }

    /// Writes what one frame came to: `answer.json`, `panorama.png` and `top_view.png` per question, and
    /// the stages' artefacts when they are asked for.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub fn frame(&self, output: &FrameOutput) -> Result<(), Error> {
        let scene = &output.scene;
        let folder = self.layout.frame(&self.root, scene.id());
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
            pictures(&folder, &view, None)?;
        }
        // Pictures take most of the time of a run, and each stands alone.
        output.answered.par_iter().enumerate().try_for_each(|(index, answered)| {
            let folder = self.layout.question(&folder, index + 1);
            self.question(&folder, &view, answered)
        })
    }

    fn question(
        &self,
        folder: &Path,
        view: &FrameView<'_>,
        answered: &Answered,
    ) -> Result<(), Error> {
        let (question, answer) = (&answered.question.text, &answered.answer);
        if matches!(self.written, Written::Artefacts(_)) {
            let config = json!(self.config.parser);
            write_artefact(&folder.join("query.json"), config, &*answered.query)?;
        }
        let worded = jrdb_render::with_words(answer.clone());
        write_artefact(&folder.join("answer.json"), json!(self.config.search), &worded)?;
        pictures(folder, view, Some(Caption { question, answer }))
    }

    /// Writes the answer to a question about a recording: `recording_01.json` and so on.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn recording(&self, index: usize, answered: &Answered) -> Result<(), Error> {
        let path = self.root.join(format!("recording_{:02}.json", index + 1));
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

fn pictures(
    folder: &Path,
    view: &FrameView<'_>,
    caption: Option<Caption<'_>>,
) -> Result<(), Error> {
    let png = |image: &Image| jrdb_dataset::encode_png(image, PngCompression::Quick);
    write(&folder.join("panorama.png"), &png(&draw_panorama(view, caption)))?;
    write(&folder.join("top_view.png"), &png(&draw_top_view(view, caption)))
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

/// Writes a file, with the folders it needs.
///
/// # Errors
/// When the file cannot be written.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let fail = |source| Error::file("write", path, source);
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(fail)?;
    }
    std::fs::write(path, bytes).map_err(fail)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn id(sequence: &str, frame: u32) -> FrameId {
        FrameId { sequence: sequence.into(), frame }
    }

    #[test]
    fn one_of_everything_needs_no_folders() {
        let cafe = id("cafe", 3);
        let layout = Layout::of(&[&cafe], 1);
        let folder = layout.frame(Path::new("out"), &cafe);
        assert_eq!(layout.question(&folder, 1), Path::new("out"));
    }

    #[test]
    fn several_of_everything_have_a_folder_each() {
        let frames = [id("cafe", 0), id("cafe", 1), id("plaza", 0)];
        let layout = Layout::of(&frames.iter().collect::<Vec<_>>(), 2);
        let folder = layout.frame(Path::new("out"), &frames[1]);
        assert_eq!(layout.question(&folder, 2), Path::new("out/cafe/000001/q02"));
    }
}
