//! Perception that can be asked whether a phrase is true of a detection: "striped shirt", "wearing glasses".

use jrdb_types::{Detection, FrameId, Vocabulary};

use crate::detector::PerceptionError;
use crate::view::View;

/// A detection that phrases are asked about, and where it was seen.
#[derive(Debug, Clone, Copy)]
pub struct Subject<'a> {
    /// The frame.
    pub frame: &'a FrameId,
    /// The camera's view of the frame.
    pub view: View<'a>,
    /// The person or object.
    pub detection: &'a Detection,
}

/// Judges whether phrases are true of a detection.
pub trait PhraseModel: Send + Sync {
    /// For each phrase the probability, in `[0, 1]`, that it is true of the subject; `None` where the model cannot
    /// tell. A picture is encoded once for all phrases.
    ///
    /// # Errors
    /// When the image or the model cannot be used.
    fn weigh(
        &self,
        subject: &Subject<'_>,
        phrases: &[&str],
    ) -> Result<Vec<Option<f64>>, PerceptionError>;

    /// The phrases that it can judge. Every other phrase gets `None`.
    fn phrases(&self) -> Vocabulary<String>;

    /// What answers, in a word or two, for traces.
    fn source(&self) -> String;
}
