//! A person's attributes by asking a vision-language model about a crop.

use jrdb_types::{Attribute, Attributes, Detection, Image, Vocabulary};
use serde::{Deserialize, Serialize};

use super::family::Family;
use super::memory::Memory;
use super::model::{PromptState, Vlm};
use super::score::{free_answer, probabilities, shared_beginning};
use crate::detector::{AttributeModel, PerceptionError, check_image};
use crate::image::{Wrap, crop};
use crate::prompts::{Question, Topic, put, questions};

/// How answers are obtained.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AnswerMode {
    /// The model writes freely; the label in its answer has probability 1.
    Paper,
    /// Every word of the vocabulary is scored as an answer, which yields probabilities of these
    /// words only.
    #[default]
    Robust,
}

/// The questions, and how they are asked.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AttributeConfig {
    /// The topics of the questions.
    pub topics: Vec<Topic>,
    /// How answers are obtained.
    pub profile: AnswerMode,
    /// A crop is larger than its box by this part of it on each side; in `[0, 1]`. Default 0.02:
    /// boxes are rarely better.
    pub margin: f64,
    /// Divides log-likelihoods before they become probabilities; above 0. Default 1: the model's
    /// own.
    pub temperature: f64,
    /// Longest free answer, tokens. Default 24: the words of every vocabulary and a sentence around
    /// them.
    pub answer_tokens_max: usize,
    /// The phrases that the model can judge, in lower case and without the words before them that
    /// [`bare_phrase`](crate::prompts::bare_phrase) drops. Default: any.
    pub phrases: Vocabulary<String>,
    /// A probability nearer to one half than this does not decide whether a phrase is true: the
    /// model cannot tell. In `[0, 0.5]`. Default 0.1: odds of three to two.
    pub undecided: f64,
    /// Whether the picture is a panorama whose last column borders on the first.
    pub wraps: bool,
}

impl Default for AttributeConfig {
    /// All topics, weighed.
    fn default() -> Self {
        Self {
            topics: Topic::ALL.to_vec(),
            profile: AnswerMode::default(),
            margin: 0.02,
            temperature: 1.0,
            answer_tokens_max: 24,
            phrases: Vocabulary::OPEN,
            undecided: 0.1,
            wraps: true,
        }
    }
}

/// Describes people with a vision-language model, and judges phrases about people and objects.
#[derive(Debug)]
pub struct VlmAttributes {
    pub(super) vlm: Vlm,
    pub(super) family: Family,
    pub(super) config: AttributeConfig,
    questions: Vec<Question>,
    pub(super) end: u32,
    pub(super) memory: Memory,
}

impl VlmAttributes {
    /// A describer.
    ///
    /// # Errors
    /// [`PerceptionError::Token`] if the vocabulary has no end of a turn,
    /// [`PerceptionError::Setting`] if a setting is out of range.
    pub fn new(vlm: Vlm, family: Family, config: AttributeConfig) -> Result<Self, PerceptionError> {
        let wrong =
            |setting, expected, found| PerceptionError::Setting { setting, expected, found };
        if !(0.0..=1.0).contains(&config.margin) {
            return Err(wrong("margin", "in [0, 1]", config.margin));
        }
        if config.temperature.is_nan() || config.temperature <= 0.0 {
            return Err(wrong("temperature", "above 0", config.temperature));
        }
        if !(0.0..=0.5).contains(&config.undecided) {
            return Err(wrong("undecided", "in [0, 0.5]", config.undecided));
        }
        let (questions, end) = (questions(&config.topics), vlm.tokens().id("<|im_end|>")?);
        Ok(Self { vlm, family, config, questions, end, memory: Memory::default() })
    }

    /// Name of the engine that runs the model.
    #[must_use]
    pub fn engine_name(&self) -> &str {
        self.vlm.engine_name()
    }

    /// Every setting that shapes the attributes, for the artefact's `config`.
    #[must_use]
    pub fn config(&self) -> serde_json::Value {
        serde_json::json!({
            "model": self.family.name(),
            "engine": self.engine_name(),
            "settings": self.config,
        })
    }

    /// The attributes of the person who fills a picture.
    ///
    /// The picture is seen and read once for all questions.
    ///
    /// # Errors
    /// When the picture has no pixels or a graph fails.
    pub fn look(&self, picture: &Image) -> Result<Attributes, PerceptionError> {
        check_image(picture)?;
        let mut attributes = Attributes::default();
        if self.questions.is_empty() {
            return Ok(attributes);
        }
        let shown = self.family.show(&self.vlm, picture)?;
        let prompt = |question: &Question| {
            self.vlm.tokens().encode(&self.family.prompt(&question.text, &shown))
        };
        let prompts = self.questions.iter().map(prompt).collect::<Result<Vec<_>, _>>()?;
        let shared = shared_beginning(&prompts);
        let beginning = &prompts[0][..shared];
        let places = self.family.places(beginning, &shown);
        let beginning = self.vlm.read(beginning, &shown.features, places.as_deref())?;
        for (question, prompt) in self.questions.iter().zip(&prompts) {
            let read = self.vlm.read_on(&beginning, &prompt[shared..])?;
            put(&mut attributes, question.topic, &self.answer(read, question)?);
        }
        Ok(attributes)
    }

    /// Probabilities of the vocabulary's words; all 0 if the answer contains none of them.
    fn answer(&self, read: PromptState, question: &Question) -> Result<Vec<f64>, PerceptionError> {
        match self.config.profile {
            AnswerMode::Robust => {
                let scores = self.vlm.score(&read, &question.labels, self.end)?;
                Ok(probabilities(&scores, self.config.temperature))
            }
            AnswerMode::Paper => {
                let longest = self.config.answer_tokens_max;
                let said = free_answer(&self.vlm, read, question, longest)?;
                let certain = |index| if said == Some(index) { 1.0 } else { 0.0 };
                Ok((0..question.labels.len()).map(certain).collect())
            }
        }
    }
}

impl AttributeModel for VlmAttributes {
    fn describe(
        &self,
        image: &Image,
        detection: &Detection,
    ) -> Result<Attributes, PerceptionError> {
        check_image(image)?;
        match crop(image, &detection.bbox, self.config.margin, Wrap::of(self.config.wraps)) {
            Some(picture) => self.look(&picture),
            None => Ok(Attributes::default()),
        }
    }

    fn attributes(&self) -> Vec<Attribute> {
        self.config.topics.iter().filter_map(|topic| topic.attribute()).collect()
    }
}
