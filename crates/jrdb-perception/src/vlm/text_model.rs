//! Sizes and ids of the text half of a model.

use serde::Deserialize;

use crate::detector::PerceptionError;
use crate::generation::DecodeConfig;
use crate::json::parse_json;

/// Sizes and ids of a text model.
#[derive(Debug, Clone, PartialEq)]
pub struct TextModel {
    /// Heads of its caches.
    pub cache_heads: usize,
    /// Width of a head of its caches.
    pub cache_width: usize,
    /// Whether tokens have places in rows and columns of the picture (Qwen2.5-VL) or only in the
    /// text.
    pub is_spatial: bool,
    /// The token that image tokens stand for.
    pub image_token: u32,
    /// How answers end.
    pub decode: DecodeConfig,
}

/// The fields of a model's text configuration that matter.
#[derive(Debug, Deserialize)]
pub(super) struct TextFile {
    num_key_value_heads: usize,
    num_attention_heads: usize,
    hidden_size: usize,
    head_dim: Option<usize>,
}

impl TextModel {
    /// From a text configuration and the text of a `generation_config.json`.
    pub(super) fn new(
        file: &TextFile,
        image_token: u32,
        is_spatial: bool,
        generation: &str,
    ) -> Result<Self, PerceptionError> {
        let shared_width = file.hidden_size / file.num_attention_heads.max(1);
        Ok(Self {
            cache_heads: file.num_key_value_heads,
            cache_width: file.head_dim.unwrap_or(shared_width),
            is_spatial,
            image_token,
            decode: parse_json("generation_config.json", generation)?,
        })
    }
}
