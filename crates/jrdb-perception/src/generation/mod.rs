//! Text from a language model: tokens, and the search for the best sequence of them.

mod decode;
mod log_sum_exp;
mod tokens;

pub use decode::{DecodeConfig, EndTokens, Logits, Sequence, decode};
pub(crate) use log_sum_exp::log_sum_exp;
pub use tokens::Tokens;
