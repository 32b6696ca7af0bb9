//! The traits of perception: detectors, attribute models and grounders, and their error.

use jrdb_types::{Attribute, Attributes, Detection, Detections, FrameId, Image, Issue, Vocabulary};

#[cfg(feature = "vlm")]
use crate::engine::Engine;
use crate::engine::{Cause, EngineError, Tensor};
use crate::view::View;

/// Detects people and objects in an image.
pub trait Detector: Send + Sync {
    /// The detections in the image, numbered from left to right.
    ///
    /// # Errors
    /// When the image, the settings or the model cannot be used.
    fn detect(&self, image: &Image, frame: &FrameId) -> Result<Detections, PerceptionError>;

    /// The classes that it can detect.
    fn categories(&self) -> Vocabulary<String>;

    /// Every setting that shapes the detections, for the artefact's `config`.
    fn config(&self) -> serde_json::Value;
}

/// Locates what a whole sentence refers to, by the model alone: the paper's baseline without
/// geometry.
pub trait Grounder: Send + Sync {
    /// What each sentence refers to. The image is encoded once for all of them.
    ///
    /// # Errors
    /// When the image, a sentence or the model cannot be used.
    fn ground(
        &self,
        frame: &FrameId,
        view: &View<'_>,
        sentences: &[&str],
    ) -> Result<Vec<Grounding>, PerceptionError>;
}

/// The boxes that a sentence refers to, numbered from left to right, or why they are not known.
pub type Grounding = Result<Detections, Issue>;

/// Describes a detection.
pub trait AttributeModel: Send + Sync {
    /// The attributes of one detection; a belief is empty if the model cannot estimate the
    /// attribute.
    ///
    /// # Errors
    /// When the image or the model cannot be used.
    fn describe(&self, image: &Image, detection: &Detection)
    -> Result<Attributes, PerceptionError>;

    /// The attributes that it can estimate.
    fn attributes(&self) -> Vec<Attribute>;
}

/// Why an image could not be perceived.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PerceptionError {
    /// The image has no pixels, or its number of bytes does not match its size.
    #[error("expected 3 bytes for each of {width} x {height} pixels, at least one, found {bytes}")]
    Image {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
        /// Bytes found.
        bytes: usize,
    },
    /// A setting is outside its range.
    #[error("expected {setting} {expected}, found {found}")]
    Setting {
        /// Name of the setting.
        setting: &'static str,
        /// Its range, in words.
        expected: &'static str,
        /// Its value.
        found: f64,
    },
    /// The model's output does not have the form that its decoder knows.
    #[error("expected output {name:?} to be {expected}, found {found}")]
    Output {
        /// Name of the tensor.
        name: &'static str,
        /// Type and shape wanted.
        expected: String,
        /// Type and shape found.
        found: String,
    },
    /// A JSON file beside a model does not have the content that its name promises.
    #[error("expected a model's {file}")]
    File {
        /// Its usual name.
        file: &'static str,
        /// The error of the JSON reader.
        #[source]
        source: serde_json::Error,
    },
    /// A line of an exchange file is not an exchange.
    #[error("expected an exchange with a request in line {number}")]
    Line {
        /// Its number, from 1.
        number: usize,
        /// The error of the JSON reader.
        #[source]
        source: serde_json::Error,
    },
    /// A tokenizer cannot be read, or cannot spell a text.
    #[error("the tokenizer could not be used")]
    Tokens(#[source] Cause),
    /// The vocabulary lacks a token that the model needs.
    #[error("expected the token {token:?} in the vocabulary, found none")]
    Token {
        /// The token.
        token: String,
    },
    /// An unknown task.
    #[error("expected a task of Florence-2 such as <OD>, found {found:?}")]
    Task {
        /// The text.
        found: String,
    },
    /// A graph lacks expected tensors.
    #[error("expected a graph with {expected}, found {known:?}")]
    Graph {
        /// The expected tensors.
        expected: &'static str,
        /// The tensors of the graph.
        known: Vec<String>,
    },
    /// A source of detections other than a model cannot be used for a frame.
    #[error("{0}")]
    Source(String),
    /// The engine could not load or run the model.
    #[error("the model could not be used")]
    Engine(#[from] EngineError),
}

/// Checks that the image has pixels, and that its number of bytes matches its size.
pub(crate) fn check_image(image: &Image) -> Result<(), PerceptionError> {
    let Image { width, height, rgb } = image;
    let expected = width.checked_mul(*height).and_then(|pixels| pixels.checked_mul(3));
    let fits = |side: &usize| u32::try_from(*side).is_ok();
    if rgb.is_empty() || expected != Some(rgb.len()) || !fits(width) || !fits(height) {
        let (width, height) = (*width, *height);
        return Err(PerceptionError::Image { width, height, bytes: rgb.len() });
    }
    Ok(())
}

/// Checks that a graph has these tensors; `expected` describes them for the error.
#[cfg(feature = "vlm")]
pub(crate) fn check_graph(
    graph: &dyn Engine,
    expected: &'static str,
    inputs: &[&str],
    outputs: &[&str],
) -> Result<(), PerceptionError> {
    let has = |known: &[String], name: &&str| known.iter().any(|one| one == name);
    let all = inputs.iter().all(|name| has(graph.inputs(), name))
        && outputs.iter().all(|name| has(graph.outputs(), name));
    if all {
        return Ok(());
    }
    Err(PerceptionError::Graph { expected, known: [graph.inputs(), graph.outputs()].concat() })
}

/// One output of shape `[1, count, N]` as `count` rows of `N` numbers.
pub(crate) fn rows<'a, const N: usize>(
    name: &'static str,
    outputs: &'a [Tensor],
    index: usize,
    count: usize,
) -> Result<&'a [[f32; N]], PerceptionError> {
    let wrong = |found: String| {
        let expected = format!("f32 {:?}", [1, count, N]);
        PerceptionError::Output { name, expected, found }
    };
    match outputs.get(index) {
        Some(Tensor::F32 { shape, data }) if shape[..] == [1, count, N] => {
            Ok(data.as_chunks::<N>().0)
        }
        Some(other) => Err(wrong(other.describe())),
        None => Err(wrong("nothing".into())),
    }
}
