//! Florence-2 (Xiao et al. 2024): a picture and a task in, words with locations out.
//!
//! The graphs are those of the community's ONNX exports, bound by tensor name: `vision_encoder`,
//! `embed_tokens`, `encoder_model`, and `decoder_model` with `decoder_with_past_model`, or
//! `decoder_model_merged` for both.

mod answer;
mod config;
mod decoded_box;
mod decoder;
mod detector;
mod location;
mod model;
mod task;

pub use answer::{Answer, Grammar, Labelled};
pub use config::Florence2Config;
pub use decoded_box::DecodedBox;
pub use decoder::DecoderParts;
pub use detector::{FlorenceDetector, FlorenceDetectorConfig};
pub use location::LocationBox;
pub use model::{Florence2, Florence2Parts, Reply};
pub use task::Task;
