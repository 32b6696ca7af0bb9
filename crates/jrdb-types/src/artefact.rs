//! The envelope that every artefact file has, and the three ways in which reading one can fail.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// What an artefact may carry: a stage's output with its name and version.
///
/// Raise [`Payload::VERSION`] when an old reader would fail or misread: a field renamed, removed or
/// re-typed, or its unit, frame or meaning changed. A new field with a default does not raise it.
pub trait Payload: Serialize + DeserializeOwned {
    /// Name of the artefact, `jrdb.<noun>`.
    const SCHEMA: &'static str;
    /// Version of the meaning of the fields, from 1.
    const VERSION: u32;
}

/// Which program wrote an artefact.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Producer {
    /// Program name.
    pub name: String,
    /// Program version.
    pub version: String,
}

/// A stage's output with its name, version, producer and the configuration it was made with.
///
/// ```
/// use jrdb_types::{Artefact, Query};
/// let artefact = Artefact::new(serde_json::json!({}), Query::default());
/// let text = artefact.to_json();
/// assert!(text.starts_with("{\n  \"schema\": \"jrdb.query\",\n  \"schema_version\": 4"));
/// assert_eq!(Artefact::<Query>::from_json(&text).unwrap(), artefact);
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(description = "A stage's output in its envelope."))]
pub struct Artefact<T> {
    /// [`Payload::SCHEMA`] of the data.
    pub schema: String,
    /// [`Payload::VERSION`] of the data.
    pub schema_version: u32,
    /// Which program wrote it.
    pub producer: Producer,
    /// The stage's configuration: every threshold that shaped the data. No host paths, no clock.
    pub config: serde_json::Value,
    /// The stage's output.
    pub data: T,
}

/// Why a text is not the artefact that was asked for.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ArtefactError {
    /// The text is another artefact.
    #[error("expected a {expected:?} artefact, found {found:?}")]
    WrongSchema {
        /// Name asked for.
        expected: &'static str,
        /// Name in the text.
        found: String,
    },
    /// The artefact was written for another version of the data.
    #[error("expected {schema} version {expected}, found version {found}")]
    WrongVersion {
        /// Name of the artefact.
        schema: &'static str,
        /// Version this program reads.
        expected: u32,
        /// Version in the text.
        found: u64,
    },
    /// The text is not JSON, lacks the envelope, or its data do not fit the schema.
    #[error("not a well-formed {schema} artefact")]
    Malformed {
        /// Name asked for.
        schema: &'static str,
        /// Where and why.
        #[source]
        source: serde_json::Error,
    },
}

impl<T: Payload> Artefact<T> {
    /// Wraps a stage's output.
    #[must_use]
    pub fn new(config: serde_json::Value, data: T) -> Self {
        let producer = Producer { name: "jrdb".into(), version: env!("CARGO_PKG_VERSION").into() };
        Self { schema: T::SCHEMA.into(), schema_version: T::VERSION, producer, config, data }
    }

    /// The artefact as indented JSON with a final newline; equal artefacts give equal bytes.
    ///
    /// # Panics
    /// Never for the payloads of this crate: their keys are strings.
    #[must_use]
    pub fn to_json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).expect("payload keys are strings");
        text.push('\n');
        text
    }

    /// Reads an artefact: name and version are checked before the data.
    ///
    /// # Errors
    /// [`ArtefactError::WrongSchema`], [`ArtefactError::WrongVersion`] or [`ArtefactError::Malformed`].
    pub fn from_json(text: &str) -> Result<Self, ArtefactError> {
        let malformed = |source| ArtefactError::Malformed { schema: T::SCHEMA, source };
        let header: Header = serde_json::from_str(text).map_err(malformed)?;
        if header.schema != T::SCHEMA {
            return Err(ArtefactError::WrongSchema { expected: T::SCHEMA, found: header.schema });
        }
        if header.schema_version != u64::from(T::VERSION) {
            let (expected, found) = (T::VERSION, header.schema_version);
            return Err(ArtefactError::WrongVersion { schema: T::SCHEMA, expected, found });
        }
        serde_json::from_str(text).map_err(malformed)
    }
}

#[derive(Deserialize)]
struct Header {
    schema: String,
    schema_version: u64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Query;

    fn text(schema: &str, version: u32, data: &str) -> String {
        format!(
            r#"{{"schema":"{schema}","schema_version":{version},"producer":{{"name":"x","version":"0"}},"config":{{}},"data":{data}}}"#
        )
    }

    fn error(text: &str) -> String {
        Artefact::<Query>::from_json(text).unwrap_err().to_string()
    }

    #[test]
    fn another_artefact_is_named() {
        let found = error(&text("jrdb.answer", 1, "{}"));
        assert_eq!(found, r#"expected a "jrdb.query" artefact, found "jrdb.answer""#);
    }

    #[test]
    fn another_version_is_named_before_the_data_are_read() {
        let found = error(&text("jrdb.query", 99, "[]"));
        assert_eq!(found, "expected jrdb.query version 4, found version 99");
    }

    #[test]
    fn wrong_data_are_malformed() {
        assert_eq!(error(&text("jrdb.query", 4, "[]")), "not a well-formed jrdb.query artefact");
        assert_eq!(error("{"), "not a well-formed jrdb.query artefact");
    }

    #[test]
    fn unknown_fields_are_tolerated() {
        let whole = Artefact::new(serde_json::json!({}), Query::default());
        let mut value = serde_json::to_value(&whole).unwrap();
        value["data"]["added_later"] = 7.into();
        assert_eq!(Artefact::<Query>::from_json(&value.to_string()).unwrap(), whole);
    }
}
