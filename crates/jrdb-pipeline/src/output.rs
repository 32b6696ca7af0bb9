//! What a run leaves in its `--out` folder.

use std::path::{Path, PathBuf};

use jrdb_dataset::PngCompression;
use jrdb_types::{Artefact, FrameId, Image, Payload, Scores};
use rayon::prelude::*;
use serde_json::{Value, json};

use crate::draw::{draw_panorama, draw_top_view};
use crate::frame::{Asked, FrameInput, FrameOutput};
use crate::perceive::Perceiver;
use crate::run::RunOptions;
use crate::{Error, PipelineConfig};

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
    with_artifacts: bool,
    config: PipelineConfig,
    perception: Value,
}

impl Writer {
    /// A writer below `root`.
    #[must_use]
    pub fn new(root: &Path, layout: Layout, options: &RunOptions, perceiver: &Perceiver) -> Self {
        Self {
            root: root.into(),
            layout,
            with_artifacts: options.artifacts,
            config: options.config.clone(),
            perception: perceiver.config().clone(),
        }
    }

    /// Writes what one frame came to: `answer.json`, `panorama.png` and `top_view.png` per question, and
    /// the stages' artefacts when they are asked for.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub fn frame(&self, input: &FrameInput, output: &FrameOutput) -> Result<(), Error> {
        let folder = self.layout.frame(&self.root, &output.detections.frame);
        if self.with_artifacts {
            let stage = json!(self.config.projection);
            write_artefact(
                &folder.join("detections.json"),
                self.perception.clone(),
                &output.detections,
            )?;
            write_artefact(&folder.join("entities.json"), stage, &output.entities)?;
            write_artefact(
                &folder.join("scene_graph.json"),
                json!(self.config.graph),
                &output.graph,
            )?;
        }
        if output.asked.is_empty() {
            self.pictures(&folder, input, output, None)?;
        }
        // Pictures take most of the time of a run, and each stands alone.
        output.asked.par_iter().enumerate().try_for_each(|(index, asked)| {
            let folder = self.layout.question(&folder, index + 1);
            self.question(&folder, input, output, asked)
        })
    }

    fn question(
        &self,
        folder: &Path,
        input: &FrameInput,
        output: &FrameOutput,
        asked: &Asked,
    ) -> Result<(), Error> {
        if self.with_artifacts {
            let config = json!(self.config.parser);
            write_artefact(&folder.join("query.json"), config, &asked.query)?;
        }
        let answer = jrdb_render::with_words(asked.answer.clone());
        write_artefact(&folder.join("answer.json"), json!(self.config.search), &answer)?;
        self.pictures(folder, input, output, Some(asked))
    }

    fn pictures(
        &self,
        folder: &Path,
        input: &FrameInput,
        output: &FrameOutput,
        asked: Option<&Asked>,
    ) -> Result<(), Error> {
        let panorama = draw_panorama(input, output, asked);
        let top_view = draw_top_view(input, output, asked);
        let png = |image: &Image| jrdb_dataset::encode_png(image, PngCompression::Quick);
        write(&folder.join("panorama.png"), &png(&panorama))?;
        write(&folder.join("top_view.png"), &png(&top_view))
    }

    /// Writes the answer to a question about a recording: `recording_01.json` and so on.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn recording(&self, index: usize, asked: &Asked) -> Result<(), Error> {
        let path = self.root.join(format!("recording_{:02}.json", index + 1));
        let answer = jrdb_render::with_words(asked.answer.clone());
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

fn write(path: &Path, bytes: &[u8]) -> Result<(), Error> {
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
