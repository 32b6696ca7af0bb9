//! The settings in the folder of a Florence-2 model: sizes, ids, preprocessing, decoding.

use serde::Deserialize;

use crate::detector::PerceptionError;
use crate::generation::DecodeConfig;
use crate::image::PictureConfig;
use crate::json::parse_json;

/// Sizes and rules of one model, from the files beside its weights.
#[derive(Debug, Clone, PartialEq)]
pub struct Florence2Config {
    /// Width of the text model.
    pub hidden: usize,
    /// Attention heads of the text decoder.
    pub heads: usize,
    /// How pictures are prepared.
    pub picture: PictureConfig,
    /// How answers are searched for.
    pub decode: DecodeConfig,
    /// The token that answers begin with.
    pub start_token: u32,
    /// Phrases without a specific referent; phrase grounding skips them.
    pub no_phrases: Vec<String>,
}

/// Pronouns, articles and words for the picture itself.
const NO_PHRASES: [&str; 62] = [
    "it",
    "I",
    "me",
    "mine",
    "you",
    "your",
    "yours",
    "he",
    "him",
    "his",
    "she",
    "her",
    "hers",
    "they",
    "them",
    "their",
    "theirs",
    "one",
    "oneself",
    "we",
    "us",
    "our",
    "ours",
    "its",
    "myself",
    "yourself",
    "himself",
    "herself",
    "itself",
    "ourselves",
    "yourselves",
    "themselves",
    "this",
    "that",
    "these",
    "those",
    "who",
    "whom",
    "whose",
    "which",
    "what",
    "all",
    "another",
    "any",
    "anybody",
    "anyone",
    "anything",
    "each",
    "everybody",
    "everyone",
    "everything",
    "some",
    "somebody",
    "someone",
    "something",
    "the image",
    "image",
    "the",
    "a",
    "an",
    "a group",
    "other objects",
];

#[derive(Deserialize)]
struct ModelFile {
    text_config: TextFile,
}

#[derive(Deserialize)]
struct TextFile {
    d_model: usize,
    decoder_attention_heads: usize,
}

#[derive(Deserialize)]
struct GenerationFile {
    #[serde(default = "two")]
    decoder_start_token_id: u32,
}

#[derive(Deserialize, Default)]
struct ProcessorFile {
    #[serde(default)]
    post_processor_config: PostFile,
}

#[derive(Deserialize, Default)]
struct PostFile {
    #[serde(default)]
    phrase_grounding: GroundingFile,
}

#[derive(Deserialize, Default)]
struct GroundingFile {
    banned_grounding_tokens: Option<Vec<String>>,
}

fn two() -> u32 {
    2
}

impl Florence2Config {
    /// Reads the texts of `config.json`, `generation_config.json`, `preprocessor_config.json` and,
    /// where there is one, `processor_config.json`.
    ///
    /// # Errors
    /// [`PerceptionError::File`] if one of them does not have the content that its name promises.
    pub fn from_json(
        config: &str,
        generation: &str,
        preprocessor: &str,
        processor: Option<&str>,
    ) -> Result<Self, PerceptionError> {
        let model: ModelFile = parse_json("config.json", config)?;
        let decode: DecodeConfig = parse_json("generation_config.json", generation)?;
        let start: GenerationFile = parse_json("generation_config.json", generation)?;
        let processor: ProcessorFile = match processor {
            Some(text) => parse_json("processor_config.json", text)?,
            None => ProcessorFile::default(),
        };
        let listed = processor.post_processor_config.phrase_grounding.banned_grounding_tokens;
        Ok(Self {
            hidden: model.text_config.d_model,
            heads: model.text_config.decoder_attention_heads,
            picture: PictureConfig::from_json(preprocessor)?,
            decode,
            start_token: start.decoder_start_token_id,
            no_phrases: listed.unwrap_or_else(|| NO_PHRASES.map(Into::into).into()),
        })
    }
}
