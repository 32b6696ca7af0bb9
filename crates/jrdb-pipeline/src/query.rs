//! Questions as people write them: in English, or in the notation of the algebra.

use jrdb_parser::{ParserConfig, notation};
use jrdb_types::issue::IssueKind;
use jrdb_types::{Issue, Query, Question};

use crate::Error;

/// Characters of a hopeless text that are shown again.
const SHOWN_MAX: usize = 80;

/// Reads a question: what has the brackets of the notation as notation, everything else as English.
///
/// # Errors
/// [`Error::Query`] for notation that does not fit together, and for a text of which nothing is understood.
pub fn read_query(text: &str, config: &ParserConfig) -> Result<Query, Error> {
    checked(text, read_or_report(text, config))
}

/// Reads a question that follows another.
pub(crate) fn read_query_after(
    text: &str,
    config: &ParserConfig,
    before: Option<&Query>,
) -> Result<Query, Error> {
    match before.filter(|_| !notation::is_notation(text)) {
        Some(before) => checked(text, jrdb_parser::parse_after(text, config, before)),
        None => read_query(text, config),
    }
}

fn checked(text: &str, query: Query) -> Result<Query, Error> {
    if notation::is_notation(text) {
        let is_wrong = |issue: &Issue| issue.kind == IssueKind::BadNotation;
        return if query.issues.iter().any(is_wrong) {
            Err(Error::Query(jrdb_parser::explain(text, &query)))
        } else {
            Ok(query)
        };
    }
    if jrdb_parser::understood(&query) {
        return Ok(query);
    }
    let shown: String = text.chars().take(SHOWN_MAX).collect();
    Err(Error::Query(format!(
        "expected a question about people or things, such as \"who is the woman next to me?\"; \
         understood nothing of {shown:?}"
    )))
}

/// Reads a question; notation that does not fit together gives an empty query with an issue.
#[must_use]
pub fn read_or_report(text: &str, config: &ParserConfig) -> Query {
    tracing::trace!(target: "jrdb::parse", text);
    if !notation::is_notation(text) {
        return jrdb_parser::parse_with(text, config);
    }
    notation::read(text).unwrap_or_else(|error| {
        let issue = Issue::at(IssueKind::BadNotation, error.span, error.to_string());
        Query { text: text.into(), issues: vec![issue], ..Query::default() }
    })
}

/// Whether a question needs more than one frame.
#[must_use]
pub fn speaks_of_time(question: &Question, query: &Query) -> bool {
    !question.slots.is_empty() || !query.slots.is_empty()
}
