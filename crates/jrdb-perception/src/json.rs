//! The JSON files beside a model.

use serde::de::DeserializeOwned;

use crate::detector::PerceptionError;

/// Reads one of the JSON files beside a model.
pub(crate) fn parse_json<T: DeserializeOwned>(
    file: &'static str,
    text: &str,
) -> Result<T, PerceptionError> {
    serde_json::from_str(text).map_err(|source| PerceptionError::File { file, source })
}
