//! Vision-language models that read a picture and a question and write an answer: InternVL3.5 and
//! Qwen2.5-VL.
//!
//! Both are three graphs, bound by tensor name: `vision_encoder` computes image tokens,
//! `embed_tokens` word tokens, and `decoder_model_merged` predicts the next token from both.

mod attribute;
mod causal;
mod family;
mod internvl;
mod memory;
mod model;
mod phrase;
mod qwen25vl;
mod score;
mod text_model;

pub use attribute::{AnswerMode, AttributeConfig, VlmAttributes};
pub use causal::{Cache, Position};
pub use family::{Family, Shown};
pub use internvl::{InternVlConfig, grid, tiles_of};
pub use model::{PromptState, Vlm, VlmParts};
pub use qwen25vl::{Patches, Qwen25VlConfig};
pub use score::LabelScore;
pub use text_model::TextModel;
