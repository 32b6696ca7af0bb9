//! Text to token ids and back.

use std::fmt;

use jrdb_types::contained;

use crate::detector::PerceptionError;
use crate::engine::Cause;

/// A model's tokenizer, from its `tokenizer.json`.
pub struct Tokens(tokenizers::Tokenizer);

impl fmt::Debug for Tokens {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Tokens").field("size", &self.0.get_vocab_size(true)).finish()
    }
}

impl Tokens {
    /// Reads a `tokenizer.json`.
    ///
    /// # Errors
    /// [`PerceptionError::Tokens`] if the text is not a tokenizer.
    pub fn from_json(text: &str) -> Result<Self, PerceptionError> {
        let read = || {
            let mut tokenizer = tokenizers::Tokenizer::from_bytes(text)?;
            // A file keeps the settings of the batches that it was trained on; texts here stand alone.
            tokenizer.with_padding(None);
            tokenizer.with_truncation(None)?;
            Ok(tokenizer)
        };
        guarded(read).map(Self)
    }

    /// The ids of a text, between the marks that the tokenizer puts around a whole input.
    ///
    /// # Errors
    /// [`PerceptionError::Tokens`] if the vocabulary cannot spell it.
    pub fn encode_input(&self, text: &str) -> Result<Vec<u32>, PerceptionError> {
        self.encode_with(text, AROUND)
    }

    /// The ids of a text and nothing else.
    ///
    /// # Errors
    /// [`PerceptionError::Tokens`] if the vocabulary cannot spell it.
    pub fn encode(&self, text: &str) -> Result<Vec<u32>, PerceptionError> {
        self.encode_with(text, !AROUND)
    }

    fn encode_with(&self, text: &str, around: bool) -> Result<Vec<u32>, PerceptionError> {
        let encoding = guarded(|| self.0.encode(text, around))?;
        Ok(encoding.get_ids().to_vec())
    }

    /// The text of ids, special tokens included.
    ///
    /// # Errors
    /// [`PerceptionError::Tokens`] if the decoder refuses them.
    pub fn decode(&self, ids: &[u32]) -> Result<String, PerceptionError> {
        guarded(|| self.0.decode(ids, !SKIP_SPECIAL))
    }

    /// The text of ids without special tokens.
    ///
    /// # Errors
    /// [`PerceptionError::Tokens`] if the decoder refuses them.
    pub fn decode_words(&self, ids: &[u32]) -> Result<String, PerceptionError> {
        guarded(|| self.0.decode(ids, SKIP_SPECIAL))
    }

    /// The id of one token.
    ///
    /// # Errors
    /// [`PerceptionError::Token`] if the vocabulary does not have it.
    pub fn id(&self, token: &str) -> Result<u32, PerceptionError> {
        self.0.token_to_id(token).ok_or_else(|| PerceptionError::Token { token: token.into() })
    }
}

/// Names for the tokenizer's flags.
const AROUND: bool = true;
const SKIP_SPECIAL: bool = true;

/// What the tokenizer returns; a panic of it is an error, too.
fn guarded<T>(work: impl FnOnce() -> Result<T, Cause>) -> Result<T, PerceptionError> {
    let worked = contained("the tokenizer", work);
    worked.map_err(|panic| PerceptionError::Tokens(panic.into()))?.map_err(PerceptionError::Tokens)
}
